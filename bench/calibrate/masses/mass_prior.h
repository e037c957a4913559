// SPDX-License-Identifier: Apache-2.0
/// @file
/// The bodies of an arm before anything is known of them but their file.
#pragma once

#include <Eigen/Core>
#include <set>
#include <string>
#include <vector>

#include "bench/calibrate/masses/body_terms.h"
#include "mjcf/plant/tree.h"

namespace tauext {

/// A body that a joint moves.
struct MovingBody {
  std::string name;        ///< as the file has it
  int joint = 0;           ///< whose body it is, by its number in ArmTree::joints
  Eigen::Vector3d origin;  ///< [m] of its frame in that of the joint, which has the same axes
  bool known = true;       ///< whether the file has a mass of it
  BodyVector file;         ///< what it has, if so
  /// What it is taken for where the recordings do not show it: as the file has it, but no thinner
  /// than 1 cm. Of one without a mass, a rod from its joint to the next, half as thick as it is
  /// long (at least a tenth of the arm's reach), of 100 kg for each cubic meter of its length.
  BodyVector prior;
};

/// Those of an arm. Frames between joints that weigh nothing are none.
/// @param massless bodies whose masses the file does not have
/// @throws std::invalid_argument for one without a name
std::vector<MovingBody> moving_bodies(const ArmTree& arm, const std::set<std::string>& massless);

}  // namespace tauext

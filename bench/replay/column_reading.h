// SPDX-License-Identifier: Apache-2.0
/// @file
/// Whether a recording fits its arm if its columns are read otherwise: another joint's, the other
/// way round, or from another zero.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "bench/replay/arm_windows.h"
#include "mjcf/plant/tree.h"

namespace tauext {

/// How the columns of a recording are to be read, joint by joint.
struct ColumnReading {
  std::vector<int> motion;      ///< whose q and qd are the joint's, from 0
  std::vector<int> torque;      ///< whose tau is
  Eigen::VectorXd motion_sign;  ///< [1] by which these are then multiplied
  Eigen::VectorXd torque_sign;  ///< [1] likewise
  Eigen::VectorXd zero;         ///< [rad] what is then added to q
  bool degrees = false;         ///< whether q and qd are in degrees
};

/// What is found.
struct FoundReading {
  std::string words;    ///< what is wrong, and the remedy; "": nothing that explains it
  bool varied = false;  ///< no constant load of each joint explains it as well
};

/// The reading that leaves ten times less of the torques unexplained than the recording's own, all
/// joints together and one of them alone; of some that do, the simplest of the best. It may be of
/// several steps: joints that are exchanged one pair after the other, signs that are turned.
/// Nothing where torques in another unit, or without gravity, explain as much.
FoundReading better_reading(const ArmTree& arm, const WindowMaker& recording);

/// Joints in words, by their numbers from 1.
std::string listed(const std::vector<int>& joints);

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Joints that follow others, by a joint's equality in MJCF or as URDF's mimic joints, taken as
/// rigid.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mjcf/mujoco/handles.h"

namespace tauext {

/// rho = T rho(free) + rho0, over all degrees of freedom of a model.
struct Ties {
  std::vector<int> free;  ///< the degrees of freedom that follow no other
  Eigen::MatrixXd T;      ///< drho/drho(free)
  Eigen::VectorXd rho0;   ///< [rad] or [m]
};

/// Of MuJoCo's disableflags a bit that it does not know itself: simulated() has made this model.
inline constexpr int kSimulated = 1 << 30;

/// The ties that the active equalities of a model make.
/// @throws std::invalid_argument for one that does not tie a joint to a joint, or not in a straight
/// line, for joints that follow each other and a joint that follows two, naming them and the remedy
Ties ties_of(const mjModel& m);

/// Whether some joint follows another.
bool has_ties(const mjModel& m);
/// Whether keep_ties holds them: then MuJoCo's own soft constraints are off.
bool has_rigid_ties(const mjModel& m);

/// Adds to the passive forces of d [N m] those that make its accelerations obey the ties. They do
/// no work. d has its positions, velocities and controls; contacts and limits are not seen.
void keep_ties(const mjModel& m, mjData& d);

}  // namespace tauext

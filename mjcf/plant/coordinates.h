// SPDX-License-Identifier: Apache-2.0
/// @file
/// The coordinates of an arm in MuJoCo, their ranges, and what they are used to.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "mjcf/mujoco/handles.h"

namespace tauext {

/// As ArmTree (tree.h), which has them, says.
struct ArmCoordinates {
  Eigen::MatrixXd drho;          ///< drho/dq, rho being MuJoCo's
  Eigen::VectorXd rho0;          ///< [rad] or [m] rho at q = 0
  std::vector<int> leaders;      ///< the joint whose position each is
  Eigen::VectorXd lower;         ///< [rad] or [m]
  Eigen::VectorXd upper;         ///< likewise
  Eigen::VectorXd usual_torque;  ///< [N m] or [N]
  Eigen::VectorXd mobility;      ///< [1/(kg m^2)] or [1/kg] of each of MuJoCo's joints

  int dof() const { return static_cast<int>(drho.cols()); }  ///< coordinates
};

/// [rad] or [m] from where to where a coordinate goes; where a range has no end, as far as a hinge
/// turns in half a turn to each side, or a slide in 0.5 m.
std::pair<double, double> finite_range(double lower, double upper, bool slides);

/// @throws std::invalid_argument as tree_of of an arm alone, for motors on tendons and for ranges
ArmCoordinates coordinates_of(const mjModel& m);

/// [1] by which what a log calls torque is to be multiplied, coordinate by coordinate, as the file
/// of the robot has it; else 1.
/// @throws std::invalid_argument as coordinates_of
Eigen::VectorXd torque_gains_of(const Model& model);

/// ArmCoordinates::usual_torque of the arm of this model; what stands around it (scenes/) does not
/// count.
/// @throws std::invalid_argument as layout_of and coordinates_of
Eigen::VectorXd usual_torque_of(const Model& model);

}  // namespace tauext

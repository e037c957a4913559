// SPDX-License-Identifier: Apache-2.0
/// @file
/// The terms of equation (3) of a robot's arm, as its estimators know it.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <tuple>

#include "bench/roster/robot.h"

namespace tauext::python {

/// An arm of any number of joints.
class Arm {
 public:
  virtual ~Arm() = default;
  /// B [kg m^2], C qd + g, C^T qd - g and F [N m] at q [rad], qd [rad/s].
  /// @throws std::invalid_argument for another number of joints
  virtual std::tuple<Eigen::MatrixXd, Eigen::VectorXd, Eigen::VectorXd, Eigen::VectorXd> terms(
      const Eigen::VectorXd& q, const Eigen::VectorXd& qd) const = 0;
};

/// The arm that the robot's estimators believe in.
std::unique_ptr<const Arm> arm_of(const Robot& robot);

}  // namespace tauext::python

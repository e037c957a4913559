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
  virtual int joints() const = 0;  ///< how many
  /// B [kg m^2], C qd + g, C^T qd - g and F [N m] at q [rad], qd [rad/s] of each joint.
  virtual std::tuple<Eigen::MatrixXd, Eigen::VectorXd, Eigen::VectorXd, Eigen::VectorXd> terms(
      const Eigen::VectorXd& q, const Eigen::VectorXd& qd) const = 0;
};

/// The arm of a model.
template <class M>
class ArmOf final : public Arm {
 public:
  explicit ArmOf(const M& model) : model_(model) {}

  int joints() const override { return M::kDof; }

  std::tuple<Eigen::MatrixXd, Eigen::VectorXd, Eigen::VectorXd, Eigen::VectorXd> terms(
      const Eigen::VectorXd& q, const Eigen::VectorXd& qd) const override {
    const Vec<M::kDof> at = q, rate = qd;
    return {model_.inertia(at), model_.bias(at, rate), model_.momentum_bias(at, rate),
            model_.friction(rate)};
  }

 private:
  M model_;
};

/// The arm that the robot's estimators believe in.
std::shared_ptr<Arm> arm_of(const Robot& robot);

}  // namespace tauext::python

// SPDX-License-Identifier: Apache-2.0
/// @file
/// The terms of equation (3) of a robot's arm, as its estimators know it.
#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <memory>
#include <stdexcept>
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

/// The arm of a model.
template <class M>
class ArmOf final : public Arm {
 public:
  explicit ArmOf(const M& model) : model_(model) {}

  std::tuple<Eigen::MatrixXd, Eigen::VectorXd, Eigen::VectorXd, Eigen::VectorXd> terms(
      const Eigen::VectorXd& q, const Eigen::VectorXd& qd) const override {
    if (q.size() != M::kDof || qd.size() != M::kDof)
      throw std::invalid_argument(
          fmt::format("q and qd of {} joints, and the arm has {}", q.size(), M::kDof));
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

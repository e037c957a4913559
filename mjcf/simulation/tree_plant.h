// SPDX-License-Identifier: Apache-2.0
/// @file
/// An arm that nothing but prescribed forces acts on, simulated by the estimators' own dynamics:
/// the equation (3) and the RK4 of Plant, in a tenth of the time.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "estimators/math/ldlt.h"
#include "estimators/tree/tree_model.h"
#include "mjcf/plant/plant.h"
#include "mjcf/plant/simulated.h"
#include "mjcf/plant/tree.h"
#include "mjcf/trace/screw.h"

namespace tauext {

/// As Plant, of an arm of N joints; functions of the same name mean the same.
template <int N>
class TreePlant {
 public:
  using Vector = Vec<N>;  ///< a number of each joint

  /// @throws std::invalid_argument for an arm of another number of joints
  explicit TreePlant(PlainArm plain)
      : plain_(std::move(plain)),
        arm_(detail::filled<TreeModel<N>>(plain_.tree)),
        end_(plain_.tree.point(kEndEffector)) {
    detail::require_size(plain_.tree, N);
  }

  int dof() const { return N; }  ///< joints
  /// Empty if the robot has none.
  const std::vector<Screw>& screws() const { return plain_.screws; }

  /// At q [rad], qd [rad/s], at rest from inputs.
  void set_state(const Vector& q, const Vector& qd) {
    q_ = q, qd_ = qd;
    tau_.setZero(), tau_ext_.setZero();
    look();
  }
  /// Applies tau [N m], clipped, and tau_ext [N m, sign of (3)] from now on.
  void set_input(const Vector& tau, const Vector& tau_ext) {
    tau_ = tau.cwiseMax(Vector(plain_.least)).cwiseMin(Vector(plain_.most));
    tau_ext_ = tau_ext;
    qdd_ = solved(terms_, friction_);
  }

  const Vector& q() const { return q_; }                ///< [rad]
  const Vector& qd() const { return qd_; }              ///< [rad/s]
  const Vector& tau() const { return tau_; }            ///< [N m] as applied, clipped
  const Vector& tau_ext() const { return tau_ext_; }    ///< [N m] the input
  const Vector& qdd() const { return qdd_; }            ///< [rad/s^2] under the present input
  const Mat<N>& inertia() const { return terms_.B; }    ///< B [kg m^2]
  const Vector& bias() const { return terms_.bias; }    ///< C qd + g [N m]
  const Vector& damping() const { return friction_; }   ///< F [N m], all of which is smooth
  const Vector& friction() const { return friction_; }  ///< the same
  double contact_force() const { return 0; }            ///< [N] nothing touches it

  /// The point that touches the outside.
  Point end_effector() const {
    const Vec<3> at = arm_.position(q_, end_.joint, end_.place);
    return {plain_.tree.base + at, jacobian() * qd_};
  }
  /// -J^T f [N m] of a force f [N, world frame] on the arm at its end effector.
  Vector tau_ext_of(const Eigen::Vector3d& f) const { return -jacobian().transpose() * f; }

  /// Whether MuJoCo has to take over: near a limit of a joint, or far from anywhere.
  bool is_lost() const {
    const auto& p = arm_.parameters();
    const Vector rho = p.drho * q_ + p.rho0;
    return !(rho.array() > plain_.lowest.array()).all() ||
           !(rho.array() < plain_.highest.array()).all() || !qd_.allFinite();
  }

  /// Integrates over h [s] by RK4, input held.
  void step(double h) {
    const Vector v1 = qd_, a1 = qdd_;
    const Vector v2 = qd_ + h / 2 * a1, a2 = acceleration(q_ + h / 2 * v1, v2);
    const Vector v3 = qd_ + h / 2 * a2, a3 = acceleration(q_ + h / 2 * v2, v3);
    const Vector v4 = qd_ + h * a3, a4 = acceleration(q_ + h * v3, v4);
    q_ += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    qd_ += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    look();
  }

 private:
  void look() {
    terms_ = arm_.dynamics(q_, qd_);
    friction_ = arm_.friction(qd_);
    qdd_ = solved(terms_, friction_);
  }
  Eigen::Matrix<double, 3, N> jacobian() const {
    return arm_.jacobian(q_, end_.joint, end_.place).template topRows<3>();
  }
  Vector solved(const Dynamics<N>& d, const Vector& friction) const {
    return Ldlt<N>(d.B).solve(Vector(tau_ - tau_ext_ - d.bias - friction));
  }
  Vector acceleration(const Vector& q, const Vector& qd) const {
    return solved(arm_.dynamics(q, qd), arm_.friction(qd));
  }

  PlainArm plain_;
  TreeModel<N> arm_;
  ArmPoint end_;
  Dynamics<N> terms_;
  Vector q_, qd_, tau_, tau_ext_, qdd_, friction_;
};

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// The motion of an arm that nothing but prescribed torques acts on, by the estimators' own
/// dynamics: equation (3), and RK4.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "estimators/math/ldlt.h"
#include "mjcf/plant/any_tree.h"
#include "mjcf/plant/plant.h"

namespace tauext {

/// Where such an arm is, and what moves it.
struct TreeState {
  /// A number of each joint, without a heap.
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostCoordinates, 1>;
  /// Over the joints.
  using Matrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostCoordinates, kMostCoordinates>;

  /// At rest where q is 0, with so many joints.
  explicit TreeState(int joints)
      : q(Vector::Zero(joints)), qd(q), tau(q), tau_ext(q), qdd(q), bias(q), friction(q) {
    B.setZero(joints, joints);
  }

  Vector q, qd;         ///< [rad], [rad/s]
  Vector tau, tau_ext;  ///< [N m] what acts, sign of (3)
  // what follows from these
  Vector qdd;             ///< [rad/s^2]
  Vector bias, friction;  ///< [N m] C qd + g, F
  Matrix B;               ///< [kg m^2]
};

/// The dynamics of such an arm, whatever its number of joints.
class TreeMotion {
 public:
  virtual ~TreeMotion() = default;
  virtual void look(TreeState& s) const = 0;            ///< sets what follows
  virtual void accelerate(TreeState& s) const = 0;      ///< sets qdd, where only torques are new
  virtual void step(TreeState& s, double h) const = 0;  ///< h [s] on, with these torques; looks
  virtual Point end_effector(const TreeState& s) const = 0;  ///< in the axes of the tree
  /// -J^T f [N m] of a force f [N] on the arm at its end effector.
  virtual TreeState::Vector tau_ext_of(const TreeState& s, const Vec<3>& f) const = 0;
};

/// Of N joints, of which none follows another.
template <int N>
class TreeMotionOf final : public TreeMotion {
 public:
  /// @throws std::invalid_argument for another number of joints
  explicit TreeMotionOf(const ArmTree& tree)
      : arm_(model_of(tree)), end_(tree.point(kEndEffector)) {}

  void look(TreeState& s) const override {
    const Vec<N> q = fixed(s.q), qd = fixed(s.qd);
    const Dynamics<N> d = arm_.dynamics(q, qd);
    fixed(s.bias) = d.bias;
    fixed(s.friction) = arm_.friction(qd);
    Mat<N>::Map(s.B.data()) = d.B;
    accelerate(s);
  }

  void accelerate(TreeState& s) const override {
    fixed(s.qdd) = solved(Mat<N>::Map(s.B.data()),
                          fixed(s.tau) - fixed(s.tau_ext) - fixed(s.bias) - fixed(s.friction));
  }

  void step(TreeState& s, double h) const override {
    const Vec<N> u = fixed(s.tau) - fixed(s.tau_ext), q = fixed(s.q), qd = fixed(s.qd);
    const Vec<N> v1 = qd, a1 = fixed(s.qdd);
    const Vec<N> v2 = qd + h / 2 * a1, a2 = acceleration(q + h / 2 * v1, v2, u);
    const Vec<N> v3 = qd + h / 2 * a2, a3 = acceleration(q + h / 2 * v2, v3, u);
    const Vec<N> v4 = qd + h * a3, a4 = acceleration(q + h * v3, v4, u);
    fixed(s.q) = q + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    fixed(s.qd) = qd + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    look(s);
  }

  Point end_effector(const TreeState& s) const override {
    const Vec<N> q = fixed(s.q);
    return {arm_.position(q, end_.joint, end_.place), jacobian(q) * fixed(s.qd)};
  }

  TreeState::Vector tau_ext_of(const TreeState& s, const Vec<3>& f) const override {
    return -jacobian(fixed(s.q)).transpose() * f;
  }

 private:
  static TreeModel<N> model_of(const ArmTree& tree) {
    detail::require_size(tree, N);
    return detail::filled<TreeModel<N>>(tree);
  }
  static Eigen::Map<Vec<N>> fixed(TreeState::Vector& v) { return Eigen::Map<Vec<N>>(v.data()); }
  static Eigen::Map<const Vec<N>> fixed(const TreeState::Vector& v) {
    return Eigen::Map<const Vec<N>>(v.data());
  }

  static Vec<N> solved(const Mat<N>& B, const Vec<N>& torque) { return Ldlt<N>(B).solve(torque); }
  Vec<N> acceleration(const Vec<N>& q, const Vec<N>& qd, const Vec<N>& u) const {
    const Dynamics<N> d = arm_.dynamics(q, qd);
    return solved(d.B, u - d.bias - arm_.friction(qd));
  }
  Eigen::Matrix<double, 3, N> jacobian(const Vec<N>& q) const {
    return arm_.jacobian(q, end_.joint, end_.place).template topRows<3>();
  }

  TreeModel<N> arm_;
  ArmPoint end_;
};

/// Makes one of an arm.
template <int N>
std::unique_ptr<const TreeMotion> tree_motion(const ArmTree& tree) {
  return std::make_unique<TreeMotionOf<N>>(tree);
}

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// The motion of an arm that nothing but prescribed torques acts on, by the estimators' own
/// dynamics: equation (3), and RK4.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>

#include "estimators/math/ldlt.h"
#include "estimators/math/pack.h"
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
  virtual void look(TreeState& s) const = 0;        ///< sets what follows
  virtual void accelerate(TreeState& s) const = 0;  ///< sets qdd, where only torques are new
  /// h [s] on, with these torques, of as many runs as there are; looks.
  virtual void step(std::span<TreeState* const> runs, double h) const = 0;
  virtual Point end_effector(const TreeState& s) const = 0;  ///< in the axes of the tree
  /// -J^T f [N m] of a force f [N] on the arm at its end effector.
  virtual TreeState::Vector tau_ext_of(const TreeState& s, const Vec<3>& f) const = 0;
};

/// Of N joints, of which none follows another; W runs at once, in the lanes of a SIMD register. (W
/// is in its name, because code with other flags has another one.)
template <int N, int W = kRuns>
class TreeMotionOf final : public TreeMotion {
 public:
  /// @throws std::invalid_argument for another number of joints
  explicit TreeMotionOf(const ArmTree& tree)
      : arm_(model_of(tree)),
        arms_(arm_.template with<Pack<W>>()),
        end_(tree.point(kEndEffector)) {}

  void look(TreeState& s) const override {
    Moving<double> x{fixed(s.q), fixed(s.qd)};
    look_at(arm_, x, Vec<N>(fixed(s.tau) - fixed(s.tau_ext)));
    put(x, s);
  }

  void accelerate(TreeState& s) const override {
    const Vec<N> rest = fixed(s.tau) - fixed(s.tau_ext) - fixed(s.bias) - fixed(s.friction);
    fixed(s.qdd) = Ldlt<N>(Mat<N>::Map(s.B.data())).solve(rest);
  }

  void step(std::span<TreeState* const> runs, double h) const override {
    while (runs.size() > 1) {
      const std::size_t n = std::min<std::size_t>(runs.size(), W);
      step_at_once(runs.first(n), h);
      runs = runs.subspan(n);
    }
    if (runs.empty()) return;
    TreeState& s = *runs.front();
    Moving<double> x{fixed(s.q), fixed(s.qd), fixed(s.qdd)};
    integrate(arm_, x, Vec<N>(fixed(s.tau) - fixed(s.tau_ext)), h);
    put(x, s);
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

  // where a run is, or W of them are, and what follows from that
  template <class Scalar>
  struct Moving {
    Vec<N, Scalar> q, qd, qdd, bias, friction;
    Mat<N, Scalar> B;
  };

  // under torques u
  template <class M, class Scalar>
  static void look_at(const M& arm, Moving<Scalar>& x, const Vec<N, Scalar>& u) {
    const Dynamics<N, Scalar> d = arm.dynamics(x.q, x.qd);
    x.B = d.B;
    x.bias = d.bias;
    x.friction = arm.friction(x.qd);
    x.qdd = Ldlt<N, Scalar>(x.B).solve(Vec<N, Scalar>(u - x.bias - x.friction));
  }

  // RK4
  template <class M, class Scalar>
  static void integrate(const M& arm, Moving<Scalar>& x, const Vec<N, Scalar>& u, const Scalar& h) {
    const Scalar half = h / 2, sixth = h / 6;
    const Vec<N, Scalar> q = x.q, v1 = x.qd, a1 = x.qdd;
    const auto at = [&](const Vec<N, Scalar>& v, const Vec<N, Scalar>& a, const Scalar& ahead) {
      x.q = q + ahead * v;
      x.qd = v1 + ahead * a;
      look_at(arm, x, u);
    };
    at(v1, a1, half);
    const Vec<N, Scalar> v2 = x.qd, a2 = x.qdd;
    at(v2, a2, half);
    const Vec<N, Scalar> v3 = x.qd, a3 = x.qdd;
    at(v3, a3, h);
    x.q = q + sixth * (v1 + Scalar(2) * v2 + Scalar(2) * v3 + x.qd);
    x.qd = v1 + sixth * (a1 + Scalar(2) * a2 + Scalar(2) * a3 + x.qdd);
    look_at(arm, x, u);
  }

  static void put(const Moving<double>& x, TreeState& s) {
    fixed(s.q) = x.q, fixed(s.qd) = x.qd, fixed(s.qdd) = x.qdd;
    fixed(s.bias) = x.bias, fixed(s.friction) = x.friction;
    Mat<N>::Map(s.B.data()) = x.B;
  }

  // lanes without a run repeat the first one
  void step_at_once(std::span<TreeState* const> runs, double h) const {
    Moving<Pack<W>> x;
    Vec<N, Pack<W>> u;
    for (int i = 0; i < W; ++i) {
      const auto run = static_cast<std::size_t>(i);
      const TreeState& s = *runs[run < runs.size() ? run : 0];
      for (int j = 0; j < N; ++j) {
        x.q[j].set(i, s.q[j]), x.qd[j].set(i, s.qd[j]), x.qdd[j].set(i, s.qdd[j]);
        u[j].set(i, s.tau[j] - s.tau_ext[j]);
      }
    }
    integrate(arms_, x, u, Pack<W>(h));
    const auto of_lane = []<int Columns>(const Eigen::Matrix<Pack<W>, N, Columns>& all, int i) {
      Eigen::Matrix<double, N, Columns> one;
      for (Eigen::Index k = 0; k < all.size(); ++k) one.data()[k] = all.data()[k][i];
      return one;
    };
    for (int i = 0; i < static_cast<int>(runs.size()); ++i) {
      put({of_lane(x.q, i), of_lane(x.qd, i), of_lane(x.qdd, i), of_lane(x.bias, i),
           of_lane(x.friction, i), of_lane(x.B, i)},
          *runs[static_cast<std::size_t>(i)]);
    }
  }

  Eigen::Matrix<double, 3, N> jacobian(const Vec<N>& q) const {
    return arm_.jacobian(q, end_.joint, end_.place).template topRows<3>();
  }

  TreeModel<N> arm_;
  TreeModel<N, Pack<W>> arms_;  // the same of W runs
  ArmPoint end_;
};

/// Makes one of an arm.
template <int N>
std::unique_ptr<const TreeMotion> tree_motion(const ArmTree& tree) {
  return std::make_unique<TreeMotionOf<N>>(tree);
}

}  // namespace tauext

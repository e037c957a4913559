// SPDX-License-Identifier: Apache-2.0
/// @file
/// TreeMotion of N joints: tree_motion_of.cc.in compiles it for each number.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>

#include "estimators/math/ldlt.h"
#include "estimators/math/pack.h"
#include "mjcf/plant/any_tree.h"
#include "mjcf/simulation/tree_motion.h"

namespace tauext::detail {

// of N joints; W runs at once, in the lanes of a SIMD register
template <int N, int W = kRuns>
class TreeMotionOf final : public TreeMotion {
 public:
  explicit TreeMotionOf(const PlainArm& arm)
      : arm_(model_of(arm.tree)),
        arms_(arm_.template with<Pack<W>>()),
        most_(arm.dry.most),
        D_(arm.dry.D),
        rate_(arm.dry.rate),
        T_(arm.tree.drho),
        is_dry_(!arm.dry.most.isZero(0)) {}

  void look(TreeState& s) const override {
    Moving<double> x{fixed(s.q), fixed(s.qd), fixed(s.qdd)};
    look_at(arm_, x, Vec<N>(fixed(s.tau) - fixed(s.tau_ext)));
    put(x, s);
  }

  void accelerate(TreeState& s) const override {
    Moving<double> x{fixed(s.q),       fixed(s.qd),       fixed(s.qdd),           fixed(s.bias),
                     fixed(s.damping), fixed(s.friction), Mat<N>::Map(s.B.data())};
    accelerate(x, Vec<N>(fixed(s.tau) - fixed(s.tau_ext)));
    fixed(s.qdd) = x.qdd, fixed(s.friction) = x.friction;
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

  Point point(const TreeState& s, const ArmPoint& at) const override {
    Vec<3> position;
    const auto J = jacobian(fixed(s.q), at, &position);
    return {position, J * fixed(s.qd)};
  }

  TreeState::Vector tau_ext_of(const TreeState& s, const ArmPoint& at,
                               const Vec<3>& f) const override {
    return -jacobian(fixed(s.q), at).transpose() * f;
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
    Vec<N, Scalar> q, qd, qdd, bias, damping, friction;
    Mat<N, Scalar> B;
  };

  // under torques u
  template <class M, class Scalar>
  void look_at(const M& arm, Moving<Scalar>& x, const Vec<N, Scalar>& u) const {
    const Dynamics<N, Scalar> d = arm.dynamics(x.q, x.qd);
    x.B = d.B;
    x.bias = d.bias;
    x.damping = arm.friction(x.qd);
    accelerate(x, u);
  }

  // qdd and friction, by what else is known
  template <class Scalar>
  void accelerate(Moving<Scalar>& x, const Vec<N, Scalar>& u) const {
    const Vec<N, Scalar> rest = u - x.bias - x.damping;
    x.friction = x.damping;
    if (is_dry_) {
      be_held(x, rest);
    } else {
      x.qdd = Ldlt<N, Scalar>(x.B).solve(rest);
    }
  }

  // The same with SolverFriction f of the joints, which move by T: B qdd + T^T f = rest. Which of
  // them it holds, and which slide, is guessed, at first by the last qdd, until qdd agrees. After
  // some guesses only the first wrong joint changes, which finds the one answer: it is a linear
  // complementarity problem with a P-matrix (Murty 1974). Else qdd is NaN, and MuJoCo takes over.
  template <class Scalar>
  void be_held(Moving<Scalar>& x, const Vec<N, Scalar>& rest) const {
    constexpr int kMostGuesses = 60, kAllChange = 6;
    const Scalar one = 1, none = 0;
    const Mat<N, Scalar> T = T_.template cast<Scalar>();
    const Vec<N, Scalar> speed = T.lazyProduct(x.qd);
    Vec<N, Scalar> slides = Vec<N, Scalar>::Zero();  // 1, -1: by most_, by -most_; 0: is held
    Scalar wrong = 0;                                // guesses
    const auto guess = [&](bool only_first) {
      wrong = none;
      const Vec<N, Scalar> change = T.lazyProduct(x.qdd);
      for (int i = 0; i < N; ++i) {
        const Scalar f = D_[i] * (change[i] + rate_[i] * speed[i]);
        Scalar now = select(f > Scalar(most_[i]), one, select(f < Scalar(-most_[i]), -one, none));
        now = select(now * slides[i] < none, none, now);  // who slid the other way is held first
        if (only_first) now = select(wrong > none, slides[i], now);
        wrong += select(now == slides[i], none, one);
        slides[i] = now;
      }
    };
    guess(false);
    for (int k = 0; k < kMostGuesses && (k == 0 || any(wrong > none)); ++k) {
      Vec<N, Scalar> stiff, f;
      for (int i = 0; i < N; ++i) {
        stiff[i] = (one - slides[i] * slides[i]) * D_[i];
        f[i] = stiff[i] * rate_[i] * speed[i] + slides[i] * most_[i];
      }
      const Mat<N, Scalar> held = stiff.asDiagonal() * T;
      const Mat<N, Scalar> B = x.B + T.transpose().lazyProduct(held);
      x.qdd = Ldlt<N, Scalar>(B).solve(Vec<N, Scalar>(rest - T.transpose().lazyProduct(f)));
      guess(k >= kAllChange);
    }
    x.friction += rest - x.B.lazyProduct(x.qdd);
    for (int i = 0; i < N; ++i)
      x.qdd[i] = select(wrong > none, Scalar(std::numeric_limits<double>::quiet_NaN()), x.qdd[i]);
  }

  // RK4
  template <class M, class Scalar>
  void integrate(const M& arm, Moving<Scalar>& x, const Vec<N, Scalar>& u, const Scalar& h) const {
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
    fixed(s.bias) = x.bias, fixed(s.damping) = x.damping, fixed(s.friction) = x.friction;
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
           of_lane(x.damping, i), of_lane(x.friction, i), of_lane(x.B, i)},
          *runs[static_cast<std::size_t>(i)]);
    }
  }

  Eigen::Matrix<double, 3, N> jacobian(const Vec<N>& q, const ArmPoint& at,
                                       Vec<3>* position = nullptr) const {
    return arm_.jacobian(q, at.joint, at.place, position).template topRows<3>();
  }

  TreeModel<N> arm_;
  TreeModel<N, Pack<W>> arms_;  // the same of W runs
  Vec<N> most_, D_, rate_;      // of SolverFriction
  Mat<N> T_;                    // of the tree's joints by q
  bool is_dry_;
};

// compiled for the joints of robots that there are
template <int N>
std::unique_ptr<const TreeMotion> tree_motion_of(const PlainArm& arm);

}  // namespace tauext::detail

// SPDX-License-Identifier: Apache-2.0
/// @file
/// One type for arms of N coordinates that are read at run time. Whether joints follow others is
/// decided then, too, so that every estimator is compiled once.
#pragma once

#include <concepts>
#include <functional>
#include <memory>
#include <type_traits>
#include <utility>

#include "estimators/math/pack.h"
#include "estimators/samples/limits.h"
#include "estimators/tree/run_terms.h"
#include "mjcf/plant/tree.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// An arm of any size, filled up to this one: each missing coordinate turns a rotor of 1 kg m^2
/// that stands alone on the base; each missing joint has no mass and never moves.
using TiedTree = TreeModel<kMostCoordinates, double, kMostCoordinates + kMostFollowers>;

extern template class TreeModel<kMostCoordinates, double, kMostCoordinates + kMostFollowers>;

namespace detail {

// filled() up to that size
std::shared_ptr<const TiedTree> tied_tree(const ArmTree& tree);

// functions of a TiedTree, compiled once: whoever has AnyTree<N> needs none of its code
struct Tied {
  using VecN = Vec<kMostCoordinates>;
  using MatN = Mat<kMostCoordinates>;
  using Both = Dynamics<kMostCoordinates>;

  static MatN inertia(const TiedTree& arm, const VecN& q) noexcept;
  static VecN gravity(const TiedTree& arm, const VecN& q) noexcept;
  static VecN bias(const TiedTree& arm, const VecN& q, const VecN& qd) noexcept;
  static VecN momentum_bias(const TiedTree& arm, const VecN& q, const VecN& qd) noexcept;
  static VecN friction(const TiedTree& arm, const VecN& qd) noexcept;
  static VecN dry_friction(const TiedTree& arm, const VecN& qd) noexcept;
  static Both dynamics(const TiedTree& arm, const VecN& q, const VecN& qd) noexcept;
  static Both momentum_dynamics(const TiedTree& arm, const VecN& q, const VecN& qd) noexcept;
  static ForwardDynamics<kMostCoordinates> forward_dynamics(const TiedTree& arm, const VecN& q,
                                                            const VecN& qd, const VecN& u) noexcept;
  static LinearMotion<kMostCoordinates> motion(const TiedTree& arm, const VecN& q, const VecN& qd,
                                               const VecN& u, Block<kMostCoordinates>* B) noexcept;
};

}  // namespace detail

template <int N, int W>
class TreeOfRuns;

/// A TreeModel<N>, or a TiedTree of N coordinates.
template <int N>
class AnyTree {
  static_assert(N <= kMostCoordinates && detail::kPadded<kMostCoordinates> == kMostCoordinates);

 public:
  static constexpr int kDof = N;
  using VecN = Vec<N>;  ///< a number of each coordinate
  using MatN = Mat<N>;  ///< over the coordinates

  /// One without tied joints.
  explicit AnyTree(const TreeModel<N>& arm, const DriveLimits<N>& drives = {}) : arm_(arm) {
    set_limits(drives);
  }
  /// One with tied joints.
  explicit AnyTree(std::shared_ptr<const TiedTree> arm, const DriveLimits<N>& drives = {})
      : arm_(typename TreeModel<N>::Parameters()), tied_(std::move(arm)) {
    set_limits(drives);
  }
  /// The same arm, for the runs of a Pack S.
  template <class S>
  auto with() const {
    if constexpr (std::is_same_v<S, double>) {
      return *this;
    } else {
      return TreeOfRuns<N, S::kWidth>(*this);
    }
  }

  /// limits_by_model() of it and its drives.
  const ArmLimits<N>& limits() const noexcept { return *limits_; }

  // as TreeModel has them, with units and signs

  MatN inertia(const VecN& q) const noexcept {  ///< B(q) [kg m^2]
    if (tied_) [[unlikely]]
      return tied<MatN>([&] { return Tied::inertia(*tied_, wide(q)); });
    return arm_.inertia(q);
  }
  VecN gravity(const VecN& q) const noexcept {  ///< g(q) [N m]
    if (tied_) [[unlikely]]
      return tied<VecN>([&] { return Tied::gravity(*tied_, wide(q)); });
    return arm_.gravity(q);
  }
  VecN bias(const VecN& q, const VecN& qd) const noexcept {  ///< C qd + g [N m]
    if (tied_) [[unlikely]]
      return tied<VecN>([&] { return Tied::bias(*tied_, wide(q), wide(qd)); });
    return arm_.bias(q, qd);
  }
  VecN momentum_bias(const VecN& q, const VecN& qd) const noexcept {  ///< C^T qd - g [N m]
    if (tied_) [[unlikely]]
      return tied<VecN>([&] { return Tied::momentum_bias(*tied_, wide(q), wide(qd)); });
    return arm_.momentum_bias(q, qd);
  }
  VecN friction(const VecN& qd) const noexcept {  ///< F(qd) [N m]
    if (tied_) [[unlikely]]
      return tied<VecN>([&] { return Tied::friction(*tied_, wide(qd)); });
    return arm_.friction(qd);
  }
  VecN dry_friction(const VecN& qd) const noexcept {  ///< Coulomb's share of it [N m]
    if (tied_) [[unlikely]]
      return tied<VecN>([&] { return Tied::dry_friction(*tied_, wide(qd)); });
    return arm_.dry_friction(qd);
  }
  /// inertia and bias, sharing the pose.
  Dynamics<N> dynamics(const VecN& q, const VecN& qd) const noexcept {
    if (tied_) [[unlikely]]
      return tied<Dynamics<N>>([&] { return Tied::dynamics(*tied_, wide(q), wide(qd)); });
    return arm_.dynamics(q, qd);
  }
  /// inertia and momentum_bias, sharing the pose.
  Dynamics<N> momentum_dynamics(const VecN& q, const VecN& qd) const noexcept {
    if (tied_) [[unlikely]]
      return tied<Dynamics<N>>([&] { return Tied::momentum_dynamics(*tied_, wide(q), wide(qd)); });
    return arm_.momentum_dynamics(q, qd);
  }
  /// qdd = B^-1 (u - C qd - F - g) for u = tau - tau_ext [N m], with its Jacobians.
  ForwardDynamics<N> forward_dynamics(const VecN& q, const VecN& qd, const VecN& u) const noexcept {
    if (tied_) [[unlikely]]
      return tied<ForwardDynamics<N>>(
          [&] { return Tied::forward_dynamics(*tied_, wide(q), wide(qd), wide(u)); });
    return arm_.forward_dynamics(q, qd, u);
  }
  /// The same in lanes, but without dry friction; and inertia(q), where B is asked for.
  detail::LinearMotion<N> motion(const VecN& q, const VecN& qd, const VecN& u,
                                 detail::Block<N>* B = nullptr) const noexcept {
    if (tied_) [[unlikely]] {
      detail::Block<kMostCoordinates> inertia;
      const auto m = tied<detail::LinearMotion<N>>(
          [&] { return Tied::motion(*tied_, wide(q), wide(qd), wide(u), B ? &inertia : nullptr); });
      if (B) *B = narrow(inertia);
      return m;
    }
    return arm_.motion(q, qd, u, B);
  }

 private:
  using Tied = detail::Tied;
  using Wide = Tied::VecN;

  static Wide wide(const VecN& v) noexcept {
    Wide w = Wide::Zero();
    w.template head<N>() = v;
    return w;
  }
  static VecN narrow(const Wide& v) noexcept { return v.template head<N>(); }
  template <int P>
  static MatN narrow(const Mat<P>& m) noexcept {
    return m.template topLeftCorner<N, N>();
  }
  static Dynamics<N> narrow(const Dynamics<kMostCoordinates>& d) noexcept {
    return {narrow(d.B), narrow(d.bias)};
  }
  static ForwardDynamics<N> narrow(const ForwardDynamics<kMostCoordinates>& f) noexcept {
    return {narrow(f.qdd), narrow(f.dqdd_dq), narrow(f.dqdd_dqd), narrow(f.dqdd_dtau_ext), f.ok};
  }
  static detail::Block<N> narrow(const detail::Block<kMostCoordinates>& b) noexcept {
    return detail::Block<N>::from(narrow(b.matrix()));
  }
  static detail::LinearMotion<N> narrow(const detail::LinearMotion<kMostCoordinates>& f) noexcept {
    return {detail::Column<N>::template from<N>(f.qdd.template to<N>()), narrow(f.by_q),
            narrow(f.by_qd), narrow(f.minus_inverse), f.ok};
  }

  void set_limits(const DriveLimits<N>& drives) {
    limits_ = std::make_shared<const ArmLimits<N>>(limits_by_model(*this, drives));
  }

  // out of the way of an arm without tied joints
  template <class Result, class Ask>
  [[gnu::noinline]] static Result tied(Ask ask) noexcept {
    return narrow(ask());
  }

  TreeModel<N> arm_;
  std::shared_ptr<const TiedTree> tied_;
  std::shared_ptr<const ArmLimits<N>> limits_;
};

/// The same arm in W runs at once (estimators/runs/runs.h), each term run by run: a tree's passes
/// over its joints fill the lanes by themselves. What an estimator does with terms goes at once.
template <int N, int W>
class TreeOfRuns {
 public:
  static constexpr int kDof = N;
  using Number = Pack<W>;             ///< of what its numbers are
  using VecN = Vec<N, Number>;        ///< a number of each coordinate
  using MatN = Mat<N, Number>;        ///< over the coordinates
  using Terms = RunTerms<N, Number>;  ///< of all runs
  using Both = Dynamics<N, Number>;   ///< two of them

  explicit TreeOfRuns(const AnyTree<N>& arm) : arm_(arm) {}  ///< of that arm
  /// One that looks into these terms before it computes any. They must outlive it; it is then for
  /// one thread.
  TreeOfRuns within(Terms& terms) const {
    TreeOfRuns same = *this;
    same.terms_ = &terms;
    return same;
  }
  /// The same arm, for one run.
  template <std::same_as<double>>
  const AnyTree<N>& with() const {
    return arm_;
  }

  // as AnyTree has them

  MatN inertia(const VecN& q) const noexcept {  ///< B(q) [kg m^2]
    return of_all<MatN>([&](int i) { return arm_.inertia(of(q, i)); });
  }
  VecN gravity(const VecN& q) const noexcept {  ///< g(q) [N m]
    return of_all<VecN>([&](int i) { return arm_.gravity(of(q, i)); });
  }
  VecN bias(const VecN& q, const VecN& qd) const noexcept {  ///< C qd + g [N m]
    return of_all<VecN>([&](int i) { return arm_.bias(of(q, i), of(qd, i)); });
  }
  VecN momentum_bias(const VecN& q, const VecN& qd) const noexcept {  ///< C^T qd - g [N m]
    return of_all<VecN>([&](int i) { return arm_.momentum_bias(of(q, i), of(qd, i)); });
  }
  VecN friction(const VecN& qd) const noexcept {  ///< F(qd) [N m]
    const auto now = [&] { return of_all<VecN>([&](int i) { return arm_.friction(of(qd, i)); }); };
    return terms_ ? terms_->friction(at_, qd, now) : now();
  }
  /// inertia and bias, sharing the pose. They stay until the next question.
  const Both& dynamics(const VecN& q, const VecN& qd) const noexcept {
    const auto now = [&] {
      return of_all<Both>([&](int i) { return arm_.dynamics(of(q, i), of(qd, i)); });
    };
    return terms_ ? terms_->dynamics(at_, q, qd, now) : here_ = now();
  }
  /// inertia and momentum_bias, sharing the pose. They stay until the next question.
  const Both& momentum_dynamics(const VecN& q, const VecN& qd) const noexcept {
    const auto now = [&] {
      return of_all<Both>([&](int i) { return arm_.momentum_dynamics(of(q, i), of(qd, i)); });
    };
    return terms_ ? terms_->momentum_dynamics(at_, q, qd, now) : here_ = now();
  }

 private:
  static Vec<N> of(const VecN& all, int i) noexcept {
    Vec<N> one;
    for (int j = 0; j < N; ++j) one[j] = all[j][i];
    return one;
  }
  template <class One, class All>
  static void put(const One& one, int i, All& all) noexcept {
    for (Eigen::Index k = 0; k < one.size(); ++k) all.data()[k].set(i, one.data()[k]);
  }
  static void put(const Dynamics<N>& one, int i, Both& all) noexcept {
    put(one.B, i, all.B), put(one.bias, i, all.bias);
  }
  template <class All, class Term>
  [[gnu::noinline]] static All of_all(const Term& term) noexcept {
    All all;
    for (int i = 0; i < W; ++i) put(term(i), i, all);
    return all;
  }

  AnyTree<N> arm_;
  Terms* terms_ = nullptr;
  mutable typename Terms::At at_ = 0;
  mutable Both here_;  // without terms_
};

/// What holds the arm: g(q) [N m] at any q [rad].
std::function<Eigen::VectorXd(const Eigen::VectorXd& q)> gravity_of(const ArmTree& arm);

/// Adds it to a tau without gravity; else does nothing.
/// @throws std::invalid_argument for another number of joints
void add_gravity(Trace& trace, const ArmTree& arm);

/// The model of an arm with N coordinates, of which joints may follow others.
/// @throws std::invalid_argument as tree_of does, for another number of coordinates, and where more
/// than kMostFollowers joints follow others
template <int N>
AnyTree<N> any_tree(const Model& model) {
  const ArmTree tree = tree_of(model);
  detail::require_size(tree, N);
  const DriveLimits<N> drives{tree.rated_torque, tree.rated_speed};
  if (tree.joints.size() == N) return AnyTree<N>(detail::filled<TreeModel<N>>(tree), drives);
  return AnyTree<N>(detail::tied_tree(tree), drives);
}

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// What a robot model, an estimator and a detector must offer to take part. No base classes.
#pragma once

#include <concepts>
#include <string_view>
#include <type_traits>

#include "estimators/types.h"

namespace tauext {

namespace detail {
template <class M>
struct ScalarOf {
  using type = double;
};
template <class M>
requires requires {
  typename M::Number;
}
struct ScalarOf<M> {
  using type = typename M::Number;
};
}  // namespace detail

/// What a model computes with: double, if it does not say otherwise by `Number`.
template <class M>
using ScalarOf = typename detail::ScalarOf<M>::type;

/// The terms of (3) of an arm with kDof joints; all in joint coordinates, all const and noexcept.
template <class M>
concept RobotModel = requires(const M& m, const Vec<M::kDof, ScalarOf<M>>& q,
                              const Vec<M::kDof, ScalarOf<M>>& qd) {
  { M::kDof } -> std::convertible_to<int>;
  { m.inertia(q) }
  noexcept->std::convertible_to<Mat<M::kDof, ScalarOf<M>>>;  // B [kg m^2]
  { m.gravity(q) }
  noexcept->std::convertible_to<Vec<M::kDof, ScalarOf<M>>>;  // g [N m]
  { m.bias(q, qd) }
  noexcept->std::convertible_to<Vec<M::kDof, ScalarOf<M>>>;  // C qd + g [N m]
  { m.momentum_bias(q, qd) }
  noexcept->std::convertible_to<Vec<M::kDof, ScalarOf<M>>>;  // C^T qd - g [N m]
  { m.friction(qd) }
  noexcept->std::convertible_to<Vec<M::kDof, ScalarOf<M>>>;  // F [N m]
};

/// Inertia and bias of one state.
template <int N, class Scalar = double>
struct Dynamics {
  Mat<N, Scalar> B = Mat<N, Scalar>::Zero();     ///< [kg m^2] inertia
  Vec<N, Scalar> bias = Vec<N, Scalar>::Zero();  ///< [N m] C qd + g; C^T qd - g for momenta
};

/// B and C qd + g of one state; a model that shares work between the two offers `dynamics` itself.
template <RobotModel M>
[[gnu::always_inline]] inline decltype(auto) dynamics(
    const M& m, const Vec<M::kDof, ScalarOf<M>>& q, const Vec<M::kDof, ScalarOf<M>>& qd) noexcept {
  if constexpr (requires { m.dynamics(q, qd); }) {
    return m.dynamics(q, qd);
  } else {
    return Dynamics<M::kDof, ScalarOf<M>>{m.inertia(q), m.bias(q, qd)};
  }
}

/// Where (3) leads, and how that changes: the blocks of (16).
template <int N, class Scalar = double>
struct ForwardDynamics {
  Vec<N, Scalar> qdd;            ///< [rad/s^2]
  Mat<N, Scalar> dqdd_dq;        ///< [1/s^2]
  Mat<N, Scalar> dqdd_dqd;       ///< [1/s]
  Mat<N, Scalar> dqdd_dtau_ext;  ///< [1/(kg m^2)] = -B^-1
  bool ok = false;               ///< false: B was not positive definite and the rest means nothing
};

/// A model that can be linearised: u [N m] is tau - tau_ext.
template <class M>
concept DifferentiableModel = RobotModel<M> &&
    requires(const M& m, const Vec<M::kDof, ScalarOf<M>>& x) {
  { m.forward_dynamics(x, x, x) }
  noexcept->std::same_as<ForwardDynamics<M::kDof, ScalarOf<M>>>;
};

/// Turns samples into estimates of tau_ext.
///
/// `reset()` forgets everything; the first `update` after it starts the estimator at that sample.
/// After construction nothing throws, allocates, logs or reads a clock.
template <class E>
concept TorqueEstimator = requires(E e, const Measurement<E::kDof>& y) {
  { E::kName } -> std::convertible_to<std::string_view>;
  { E::kDof } -> std::convertible_to<int>;
  { e.reset() }
  noexcept;
  { e.update(y) }
  noexcept->std::same_as<Estimate<E::kDof>>;
};

/// Turns estimates of tau_ext into fiducial marks, either from t [s] and tau_ext [N m] alone, or
/// with qd [rad/s] and tau [N m] of the sample, too: update(t, qd, tau, tau_ext). It is made for a
/// number of joints, D(joints) or D(joints, parameters); of another number it detects nothing.
template <class D>
concept CollisionDetector = requires(D d) {
  { D::kName } -> std::convertible_to<std::string_view>;
  { d.reset() }
  noexcept;
}
&&(
    requires(D d, double t, const JointVecView<>& x) {
      { d.update(t, x) }
      noexcept->std::same_as<Detection>;
    } ||
    requires(D d, double t, const JointVecView<>& x) {
      { d.update(t, x, x, x) }
      noexcept->std::same_as<Detection>;
    });

/// One step of either kind of detector; of several runs, if it is one of Packs.
/// @param t [s] of the sample, with its qd [rad/s] and tau [N m]; of several runs finite numbers
/// @param tau_ext [N m] its estimate, which is used(); of as many joints
template <class Scalar = double, class D>
[[gnu::always_inline]] inline auto detect(
    D& d, double t, const std::type_identity_t<JointVecView<Scalar>>& qd,
    const std::type_identity_t<JointVecView<Scalar>>& tau,
    const std::type_identity_t<JointVecView<Scalar>>& tau_ext) noexcept {
  if constexpr (requires { d.update(t, qd, tau, tau_ext); }) {
    return d.update(t, qd, tau, tau_ext);
  } else {
    return d.update(t, tau_ext);
  }
}

/// One step behind an estimator: silent where a sample was left out, from the start where the
/// estimate diverged.
template <CollisionDetector D, int N>
Detection detect(D& d, const Measurement<N>& y, const Estimate<N>& e) noexcept {
  if (used(e.status)) return detect(d, y.t, y.qd, y.tau, e.tau_ext);
  if (e.status == Status::kDiverged) d.reset();
  return {};
}

/// A detector whose thresholds can be set from data: joint i marks where statistic()[i] of the last
/// update reaches Parameters::threshold[i]. Twice the tau_ext gives 2^kDegree times the statistic.
template <class D>
concept CalibratableDetector = CollisionDetector<D> &&
    requires(const D& d, typename D::Parameters p) {
  { D::kDegree } -> std::convertible_to<int>;
  { d.statistic() }
  noexcept->std::convertible_to<JointVec<>>;
  { p.threshold } -> std::convertible_to<JointVec<>>;
  D(3, p);
};

template <int W>
class Pack;

/// A detector that can do several runs of one clock at once, one in each SIMD lane: it computes
/// with a Scalar, which then is a Pack (estimators/math/pack.h), names that class `For`, and has
/// parameters(), of which one is made. All samples of all runs are used; only scores differ from
/// run to run, and what depends on time alone stays one number.
template <class D>
concept DetectsRuns = CollisionDetector<D> && requires(const D& d) {
  { d.parameters() } -> std::convertible_to<typename D::Parameters>;
  typename D::template For<Pack<4>>;
  // no class that derives from one, and would be that one
  requires std::same_as<typename D::template For<double>, D>;
};

}  // namespace tauext

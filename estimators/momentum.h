// SPDX-License-Identifier: Apache-2.0
/// @file
/// The generalised momentum of an arm and what drives it, which is all that momentum observers see:
///     p = B qd,   pdot = n - tau_ext,   n = tau - F - g + C^T qd                           (i)
/// Over [t_k-1, t_k) tau is tau_k-1 (held; sampled at instants, the mean of both ends); the other
/// terms of n are the mean of both ends.
#pragma once

#include <tuple>

#include "estimators/concepts.h"

namespace tauext {

/// (i) over the step from k-1 to k.
template <int N, class Scalar = double>
struct MomentumStep {
  Mat<N, Scalar> B;   ///< [kg m^2] at k
  Vec<N, Scalar> p;   ///< [N m s] at k
  Vec<N, Scalar> dp;  ///< [N m s] p_k - p_k-1
  Vec<N, Scalar> n;   ///< [N m] over the step
};

/// (i) from sample to sample over a robot model M.
template <RobotModel M>
class Momentum {
 public:
  static constexpr int kDof = M::kDof;
  using Scalar = ScalarOf<M>;  ///< double, or a Pack for several runs at once

  explicit Momentum(const M& model) : model_(model) {}  ///< of this robot

  /// Goes on to sample y, tau [N m] having acted meanwhile; of what is returned at the first sample
  /// only B and p mean anything.
  [[gnu::always_inline]] MomentumStep<kDof, Scalar> advance(const Measurement<kDof, Scalar>& y,
                                                            const Vec<kDof, Scalar>& tau) noexcept {
    MomentumStep<kDof, Scalar> s;
    Vec<kDof, Scalar> rest;
    if constexpr (requires { model_.momentum_dynamics(y.q, y.qd); }) {
      const Dynamics<kDof, Scalar>& now = model_.momentum_dynamics(y.q, y.qd);
      s.B = now.B;
      s.p = s.B * y.qd;
      rest = now.bias - model_.friction(y.qd);
    } else {
      s.B = model_.inertia(y.q);
      s.p = s.B * y.qd;
      rest = model_.momentum_bias(y.q, y.qd) - model_.friction(y.qd);
    }
    s.dp = s.p - p_;
    s.n = tau + 0.5 * (rest + rest_);
    p_ = s.p;
    rest_ = rest;
    return s;
  }

  auto memory() noexcept { return std::tie(p_, rest_); }  ///< see runs/runs.h

 private:
  M model_;
  Vec<kDof, Scalar> p_ = Vec<kDof, Scalar>::Zero();     // [N m s] at the last sample
  Vec<kDof, Scalar> rest_ = Vec<kDof, Scalar>::Zero();  // [N m] n without tau there
};

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// The generalised momentum of an arm and what drives it, which is all that momentum observers see:
///     p = B qd,   pdot = n - tau_ext,   n = tau - F - g + C^T qd                           (i)
/// Over [t_k-1, t_k) tau is tau_k-1 (held; sampled at instants, the mean of both ends); the other
/// terms of n are the mean of both ends.
#pragma once

#include "estimators/concepts.h"

namespace tauext {

/// (i) over the step from k-1 to k.
template <int N>
struct MomentumStep {
  Mat<N> B;   ///< [kg m^2] at k
  Vec<N> p;   ///< [N m s] at k
  Vec<N> dp;  ///< [N m s] p_k - p_k-1
  Vec<N> n;   ///< [N m] over the step
};

/// (i) from sample to sample over a robot model M.
template <RobotModel M>
class Momentum {
 public:
  static constexpr int kDof = M::kDof;

  explicit Momentum(const M& model) : model_(model) {}  ///< of this robot

  /// Goes on to sample y, tau [N m] having acted meanwhile; of what is returned at the first sample
  /// only B and p mean anything.
  [[gnu::always_inline]] MomentumStep<kDof> advance(const Measurement<kDof>& y,
                                                    const Vec<kDof>& tau) noexcept {
    MomentumStep<kDof> s;
    Vec<kDof> rest;
    if constexpr (requires { model_.momentum_dynamics(y.q, y.qd); }) {
      const Dynamics<kDof> now = model_.momentum_dynamics(y.q, y.qd);
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

 private:
  M model_;
  Vec<kDof> p_ = Vec<kDof>::Zero();     // [N m s] at the last sample
  Vec<kDof> rest_ = Vec<kDof>::Zero();  // [N m] n without tau there
};

}  // namespace tauext

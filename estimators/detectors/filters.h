// SPDX-License-Identifier: Apache-2.0
/// @file
/// First-order filters for detectors, exact for an input that is held between samples, whatever
/// their spacing:
///     low-pass   l_k = x_k-1 + e^(-w h) (l_k-1 - x_k-1)                                      (i)
///     high-pass  x_k - l_k
/// A unit step gives 1 - e^(-w t) and e^(-w t).
#pragma once

#include <cmath>

#include "estimators/sampling.h"

namespace tauext {

/// Low-pass of a signal for each joint, or with a Pack for Scalar of several runs; the high-pass is
/// what it leaves.
template <class Scalar = double>
class LowPass {
 public:
  /// @param w [rad/s] cut-off
  /// @throws std::invalid_argument unless it is positive
  LowPass(int joints, double w) : w_(w), x_(JointVec<Scalar>::Zero(joints)), low_(x_) {
    require(w > 0, "w [rad/s] of a filter must be positive");
  }

  /// As if x had been there for ever.
  void start(double t, const JointVecView<Scalar>& x) noexcept {
    t_ = t;
    x_ = low_ = x;
  }

  /// To the next sample, at t [s], which is later than the last one; then each joint's.
  [[gnu::always_inline]] void advance(double t) noexcept {
    const double h = t - t_;
    if (new_step_(h)) decay_ = std::exp(-w_ * h);
    t_ = t;
  }

  /// (i) of joint i, where it is x now.
  [[gnu::always_inline]] Scalar operator()(int i, const Scalar& x) noexcept {
    const Scalar low = x_[i] + Scalar(decay_) * (low_[i] - x_[i]);
    x_[i] = x;
    return low_[i] = low;
  }

 private:
  double w_;
  StepChange<> new_step_;
  double decay_ = 0;
  double t_ = 0;
  JointVec<Scalar> x_, low_;
};

}  // namespace tauext

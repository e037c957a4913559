// SPDX-License-Identifier: Apache-2.0
/// @file
/// Several runs of one detector at once, one in each SIMD lane: runs of one clock, whose samples
/// all are used. A detector can do it if it computes with a Scalar, which then is a Pack, names
/// that class `For`, and has parameters(), of which one is made. Only scores differ from run to
/// run: what depends on time alone stays one number.
#pragma once

#include <concepts>

#include "estimators/concepts.h"
#include "estimators/detectors/marking.h"
#include "estimators/math/pack.h"

namespace tauext {

/// A detector that can do several runs at once.
template <class D>
concept DetectsRuns = CollisionDetector<D> && requires(const D& d) {
  { d.parameters() } -> std::convertible_to<typename D::Parameters>;
  typename D::template For<Pack<4>>;
  // no class that derives from one, and would be that one
  requires std::same_as<typename D::template For<double>, D>;
};

/// The next sample of all runs.
/// @param d a detector of runs: For<Pack<W>> of one that DetectsRuns
/// @param y the samples, all at the time of the first; else only qd [rad/s] and tau [N m] are read,
/// by detectors that want them: numbers within kMeasurementLimit
/// @param tau_ext [N m] their estimates, all of them used()
template <class D, class Scalar>
[[gnu::always_inline]] inline RunsDetection<Scalar> detect_runs(
    D& d, const Measurement<D::kDof, Scalar>& y, const Vec<D::kDof, Scalar>& tau_ext) noexcept {
  if constexpr (requires { d.update(y.t[0], y.qd, y.tau, tau_ext); }) {
    return d.update(y.t[0], y.qd, y.tau, tau_ext);
  } else if constexpr (requires { d.update(y.t[0], y.qd, tau_ext); }) {
    return d.update(y.t[0], y.qd, tau_ext);
  } else {
    return d.update(y.t[0], tau_ext);
  }
}

}  // namespace tauext

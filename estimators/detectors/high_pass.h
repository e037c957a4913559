// SPDX-License-Identifier: Apache-2.0
/// @file
/// A limit on what is quick in the estimate: a first-order high-pass takes payloads, model errors
/// and slow pushes out. After Cho, Kim, Lee and Song, "Collision detection algorithm to distinguish
/// between intended contact and unexpected collision", Advanced Robotics 2012.
///     z = high-pass of tau_ext at w (filters.h)                                             (i)
///     mark where max_i(|z_i| / threshold_i) rises through 1
#pragma once

#include <tuple>

#include "estimators/concepts.h"
#include "estimators/detectors/filters.h"
#include "estimators/detectors/marking.h"

namespace tauext {

/// What can be chosen of a HighPass.
template <int N>
struct HighPassParameters {
  /// [N m] per joint: larger misses more and alarms less; by default twice what a push of 80 N in
  /// 0.8 s at 1.2 m leaves behind the filter (its steepest slope, 225 N m/s, over w)
  Vec<N> threshold = Vec<N>::Constant(45);
  double w = 10;            ///< [rad/s] cut-off: larger lets less of a push pass, and of a blow
  double refractory = 0.2;  ///< [s] after a mark without another
  double start_up = 0;      ///< [s] after the first sample without a mark

  static constexpr auto fields() {
    using P = HighPassParameters;
    return std::tuple_cat(std::tuple(threshold_field<P>("N m"),
                                     Field{"w", &P::w, "rad/s", kLeastBandwidth, kMostBandwidth,
                                           "cut-off; larger lets less pass, of a blow too"}),
                          marking_fields<P>());
  }
};

/// High-pass and limit over N joints.
template <int N, class Scalar = double>
class HighPass {
 public:
  static constexpr const char* kName = "high_pass";
  static constexpr int kDof = N;
  static constexpr int kDegree = 1;
  using Parameters = HighPassParameters<N>;  ///< what can be set
  template <class Other>
  using For = HighPass<N, Other>;  ///< the same, computed with another number

  /// @throws std::invalid_argument for parameters out of range
  explicit HighPass(const Parameters& p = {})
      : p_(check_parameters(p, kName)), low_(p.w), marking_(p.refractory, p.start_up) {}

  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed

  void reset() noexcept {
    marking_.reset();
    forget();
  }

  DetectionOf<Scalar> update(double t, const Vec<N, Scalar>& tau_ext) noexcept {
    if (!marking_.accept(t)) return marking_.held();
    if (marking_.starts()) forget();
    if (marking_.silent(t)) {
      low_.start(t, tau_ext);
    } else {
      statistic_ = (tau_ext - low_(t, tau_ext)).cwiseAbs();  // (i)
    }
    return marking_(t, statistic_.cwiseQuotient(p_.threshold.template cast<Scalar>()).maxCoeff(),
                    Contact::kCollision);
  }

  /// [N m] |z|.
  const Vec<N, Scalar>& statistic() const noexcept { return statistic_; }

 private:
  void forget() noexcept { statistic_.setZero(); }

  Parameters p_;
  LowPass<N, Scalar> low_;
  BasicMarking<Scalar> marking_;
  Vec<N, Scalar> statistic_ = Vec<N, Scalar>::Zero();
};

static_assert(CalibratableDetector<HighPass<3>>);

}  // namespace tauext

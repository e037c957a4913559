// SPDX-License-Identifier: Apache-2.0
/// @file
/// A limit on what is quick in the estimate: a first-order high-pass takes payloads, model errors
/// and slow pushes out. After Cho, Kim, Lee and Song, "Collision detection algorithm to distinguish
/// between intended contact and unexpected collision", Advanced Robotics 2012.
///     z = high-pass of tau_ext at w (filters.h)                                             (i)
///     mark where max_i(|z_i| / threshold_i) rises through 1
#pragma once

#include <cmath>
#include <tuple>

#include "estimators/concepts.h"
#include "estimators/detectors/filters.h"
#include "estimators/detectors/marking.h"

namespace tauext {

/// What can be chosen of a HighPass.
struct HighPassParameters {
  /// [N m] per joint: larger misses more and alarms less; by default twice what a push of 80 N in
  /// 0.8 s at 1.2 m leaves behind the filter (its steepest slope, 225 N m/s, over w)
  JointVec<> threshold = JointVec<>::Constant(1, 45);
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

/// High-pass and limit; with a Pack for Scalar, of several runs.
template <class Scalar = double>
class BasicHighPass {
 public:
  static constexpr const char* kName = "high_pass";
  static constexpr int kDegree = 1;
  using Parameters = HighPassParameters;  ///< what can be set
  template <class Other>
  using For = BasicHighPass<Other>;  ///< the same, computed with another number

  /// @throws std::invalid_argument as for_joints() (estimators/parameters.h)
  explicit BasicHighPass(int joints, const Parameters& p = {})
      : p_(for_joints(p, joints, kName)),
        low_(joints, p.w),
        marking_(p.refractory, p.start_up),
        statistic_(JointVec<Scalar>::Zero(joints)) {}

  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed

  void reset() noexcept {
    marking_.reset();
    forget();
  }

  DetectionOf<Scalar> update(double t, const JointVecView<Scalar>& tau_ext) noexcept {
    if (tau_ext.size() != statistic_.size() || !marking_.accept(t)) return marking_.held();
    if (marking_.starts()) forget();
    if (marking_.silent(t)) {
      low_.start(t, tau_ext);
    } else {
      using std::abs;
      low_.advance(t);
      for (int i = 0; i < statistic_.size(); ++i)
        statistic_[i] = abs(tau_ext[i] - low_(i, tau_ext[i]));  // (i)
    }
    return marking_(t, largest_ratio(statistic_, p_.threshold), Contact::kCollision);
  }

  /// [N m] |z|.
  const JointVec<Scalar>& statistic() const noexcept { return statistic_; }

 private:
  void forget() noexcept { statistic_.setZero(); }

  Parameters p_;
  LowPass<Scalar> low_;
  BasicMarking<Scalar> marking_;
  JointVec<Scalar> statistic_;
};

/// Of one run.
using HighPass = BasicHighPass<>;
static_assert(CalibratableDetector<HighPass>);

}  // namespace tauext

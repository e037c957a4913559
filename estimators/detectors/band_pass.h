// SPDX-License-Identifier: Apache-2.0
/// @file
/// A limit on a band of the estimate: as high_pass.h, and noise above the band is taken out, too.
///     z = low-pass at w_high of the high-pass at w_low of tau_ext (filters.h)                (i)
///     mark where max_i(|z_i| / threshold_i) rises through 1
#pragma once

#include <cmath>
#include <tuple>

#include "estimators/concepts.h"
#include "estimators/detectors/filters.h"
#include "estimators/detectors/marking.h"

namespace tauext {

/// What can be chosen of a BandPass.
struct BandPassParameters {
  /// [N m] per joint: larger misses more and alarms less; as in high_pass.h, for which see the
  /// origin
  JointVec<> threshold = JointVec<>::Constant(1, 45);
  double w_low = 10;        ///< [rad/s] larger lets less of a push pass, and of a blow
  double w_high = 100;      ///< [rad/s] smaller lets less noise pass, and marks later
  double refractory = 0.2;  ///< [s] after a mark without another
  double start_up = 0;      ///< [s] after the first sample without a mark

  static constexpr auto fields() {
    using P = BandPassParameters;
    return std::tuple_cat(
        std::tuple(threshold_field<P>("N m"),
                   Field{"w_low", &P::w_low, "rad/s", kLeastBandwidth, kMostBandwidth,
                         "larger lets less pass, of a blow too"},
                   Field{"w_high", &P::w_high, "rad/s", kLeastBandwidth, kMostBandwidth,
                         "larger lets more noise pass, marks sooner"}),
        marking_fields<P>());
  }
};

/// Band-pass and limit; with a Pack for Scalar, of several runs.
template <class Scalar = double>
class BasicBandPass {
 public:
  static constexpr const char* kName = "band_pass";
  static constexpr int kDegree = 1;
  using Parameters = BandPassParameters;  ///< what can be set
  template <class Other>
  using For = BasicBandPass<Other>;  ///< the same, computed with another number

  /// @throws std::invalid_argument as for_joints() (estimators/parameters.h)
  explicit BasicBandPass(int joints, const Parameters& p = {})
      : p_(for_joints(p, joints, kName)),
        slow_(joints, p.w_low),
        quick_(joints, p.w_high),
        marking_(p.refractory, p.start_up),
        statistic_(JointVec<Scalar>::Zero(joints)) {
    require(p.w_low < p.w_high, "w_low of band_pass must be below w_high");
  }

  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed

  void reset() noexcept {
    marking_.reset();
    forget();
  }

  DetectionOf<Scalar> update(double t, const JointVecView<Scalar>& tau_ext) noexcept {
    if (tau_ext.size() != statistic_.size() || !marking_.accept(t)) return marking_.held();
    if (marking_.starts()) forget();
    if (marking_.silent(t)) {
      slow_.start(t, tau_ext);
      quick_.start(t, JointVec<Scalar>::Zero(tau_ext.size()).eval());
    } else {
      using std::abs;
      slow_.advance(t);
      quick_.advance(t);
      for (int i = 0; i < statistic_.size(); ++i)
        statistic_[i] = abs(quick_(i, tau_ext[i] - slow_(i, tau_ext[i])));  // (i)
    }
    return marking_(t, largest_ratio(statistic_, p_.threshold), Contact::kCollision);
  }

  /// [N m] |z|.
  const JointVec<Scalar>& statistic() const noexcept { return statistic_; }

 private:
  void forget() noexcept { statistic_.setZero(); }

  Parameters p_;
  LowPass<Scalar> slow_, quick_;
  BasicMarking<Scalar> marking_;
  JointVec<Scalar> statistic_;
};

/// Of one run.
using BandPass = BasicBandPass<>;
static_assert(CalibratableDetector<BandPass>);

}  // namespace tauext

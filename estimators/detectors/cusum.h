// SPDX-License-Identifier: Apache-2.0
/// @file
/// Cumulative sums: Page, "Continuous inspection schemes", Biometrika 1954, two-sided, of what the
/// estimate has beyond its own slow mean.
///     z = high-pass of tau_ext at w (filters.h)
///     S+ = max(0, S+ + h (z - drift)),   S- = max(0, S- + h (-z - drift))                   (i)
///     mark where max_i(max(S+_i, S-_i) / threshold_i) rises through 1
/// Sums are in N m s and weighted by h, so they do not depend on the sampling time. Noise cancels
/// in them, which is why this detector lasts where a derivative drowns. A sum stops at `most_score`
/// times the threshold: it does not have to come down from the sky when a contact ends.
#pragma once

#include <algorithm>
#include <tuple>

#include "estimators/concepts.h"
#include "estimators/detectors/filters.h"
#include "estimators/detectors/marking.h"

namespace tauext {

/// What can be chosen of a Cusum.
struct CusumParameters {
  /// [N m s] per joint: larger misses more and alarms less; by default half the impulse of a blow
  /// of 100 N and 10 ms at 1.2 m
  JointVec<> threshold = JointVec<>::Constant(1, 0.4);
  /// [N m] per joint, what z may have for ever: larger forgets quicker; by default above what a
  /// push of 80 N in 0.8 s at 1.2 m leaves behind the filter (its steepest slope, 225 N m/s,
  /// over w)
  JointVec<> drift = JointVec<>::Constant(1, 12);
  double w = 20;            ///< [rad/s] of the slow mean: larger lets less of a push pass
  double most_score = 2;    ///< [1] where a sum stops: larger comes down later when a contact ends
  double refractory = 0.2;  ///< [s] after a mark without another
  double start_up = 0;      ///< [s] after the first sample without a mark

  static constexpr auto fields() {
    using P = CusumParameters;
    return std::tuple_cat(
        std::tuple(threshold_field<P>("N m s"),
                   Field{"drift", &P::drift, "N m", 0, 1e12, "larger forgets sooner"},
                   Field{"w", &P::w, "rad/s", kLeastBandwidth, kMostBandwidth,
                         "larger lets less of a push pass"},
                   Field{"most_score", &P::most_score, "1", 1, 1e12,
                         "larger comes down later when a contact ends"}),
        marking_fields<P>());
  }
};

/// CUSUM; with a Pack for Scalar, of several runs.
template <class Scalar = double>
class BasicCusum {
 public:
  static constexpr const char* kName = "cusum";
  static constexpr int kDegree = 1;    ///< at least: the drift does not grow
  using Parameters = CusumParameters;  ///< what can be set
  template <class Other>
  using For = BasicCusum<Other>;  ///< the same, computed with another number

  /// @throws std::invalid_argument as for_joints() (estimators/parameters.h)
  explicit BasicCusum(int joints, const Parameters& p = {})
      : p_(for_joints(p, joints, kName)),
        mean_(joints, p.w),
        marking_(p.refractory, p.start_up),
        up_(JointVec<Scalar>::Zero(joints)),
        down_(up_),
        statistic_(up_) {}

  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed

  void reset() noexcept {
    marking_.reset();
    forget();
  }

  DetectionOf<Scalar> update(double t, const JointVecView<Scalar>& tau_ext) noexcept {
    if (tau_ext.size() != statistic_.size() || !marking_.accept(t)) return marking_.held();
    if (marking_.starts()) forget();
    if (marking_.silent(t) || t - t_ > kGap) {
      mean_.start(t, tau_ext);
    } else {
      using std::max;
      using std::min;
      const Scalar h = t - t_;
      mean_.advance(t);
      for (int i = 0; i < statistic_.size(); ++i) {
        const Scalar z = tau_ext[i] - mean_(i, tau_ext[i]);
        const double drift = p_.drift[i], most = p_.most_score * p_.threshold[i];
        const auto sum = [&](const Scalar& x) { return min(max(x, Scalar(0)), Scalar(most)); };
        up_[i] = sum(up_[i] + h * (z - drift));  // (i)
        down_[i] = sum(down_[i] - h * (z + drift));
        statistic_[i] = max(up_[i], down_[i]);
      }
    }
    t_ = t;
    return marking_(t, largest_ratio(statistic_, p_.threshold), Contact::kCollision);
  }

  /// [N m s] the larger sum.
  const JointVec<Scalar>& statistic() const noexcept { return statistic_; }

 private:
  void forget() noexcept {
    up_.setZero();
    down_.setZero();
    statistic_.setZero();
  }

  static constexpr double kGap = 0.05;  // [s] after which the mean starts anew, as estimators do

  Parameters p_;
  LowPass<Scalar> mean_;
  BasicMarking<Scalar> marking_;
  double t_ = 0;
  JointVec<Scalar> up_, down_, statistic_;
};

/// Of one run.
using Cusum = BasicCusum<>;
static_assert(CalibratableDetector<Cusum>);

}  // namespace tauext

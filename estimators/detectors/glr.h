// SPDX-License-Identifier: Apache-2.0
/// @file
/// Generalised likelihood ratio of a change of the mean that nobody knows, at a time that nobody
/// knows: Basseville and Nikiforov, "Detection of Abrupt Changes", 1993, section 2.4.3, over a
/// window, and over spans that double, as Lai, "Sequential changepoint detection in quality control
/// and dynamical systems", JRSS B 1995, has them.
///     z = high-pass of tau_ext at w (filters.h),   S_k = sum of h z
///     g_i = max_n |S_k - S_k-n| / sqrt(t_k - t_k-n),   n = 1, 2, 4, .. while t_k - t_k-n <= span  (i)
///     mark where max_i(g_i / threshold_i) rises through 1
/// In white noise of density D each of these has a standard deviation of sqrt(D) or less, however
/// long its span is, so one threshold serves a blow of 5 ms and a push of 100; and it depends on no
/// sampling time. CUSUM (cusum.h) is that test for one size of change, which its drift names.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <tuple>

#include "estimators/concepts.h"
#include "estimators/detectors/filters.h"
#include "estimators/detectors/marking.h"

namespace tauext {

/// What can be chosen of a Glr.
struct GlrParameters {
  /// [N m s^0.5] per joint: larger misses more and alarms less; by default half of what a blow of
  /// 100 N and 10 ms at 1.2 m has
  JointVec<> threshold = JointVec<>::Constant(1, 4);
  double w = 20;            ///< [rad/s] of the slow mean: larger lets less of a push pass
  double span = 0.1;        ///< [s] of the longest change; it holds 128 samples at most
  double refractory = 0.2;  ///< [s] after a mark without another
  double start_up = 0;      ///< [s] after the first sample without a mark

  static constexpr auto fields() {
    using P = GlrParameters;
    return std::tuple_cat(
        std::tuple(threshold_field<P>("N m s^0.5"),
                   Field{"w", &P::w, "rad/s", kLeastBandwidth, kMostBandwidth,
                         "larger lets less of a push pass"},
                   Field{"span", &P::span, "s", 1e-5, 10, "larger finds slower contacts"}),
        marking_fields<P>());
  }
};

/// GLR; with a Pack for Scalar, of several runs.
template <class Scalar = double>
class BasicGlr {
 public:
  static constexpr const char* kName = "glr";
  static constexpr int kDegree = 1;
  using Parameters = GlrParameters;  ///< what can be set
  template <class Other>
  using For = BasicGlr<Other>;  ///< the same, computed with another number

  /// @throws std::invalid_argument as for_joints() (estimators/parameters.h)
  explicit BasicGlr(int joints, const Parameters& p = {})
      : p_(for_joints(p, joints, kName)),
        mean_(joints, p.w),
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
    if (marking_.silent(t) || t - t_[last_] > kGap) {
      mean_.start(t, tau_ext);
      start(t);
    } else {
      add(t, tau_ext);
      look_back();
    }
    return marking_(t, largest_ratio(statistic_, p_.threshold), Contact::kCollision);
  }

  /// [N m s^0.5] g.
  const JointVec<Scalar>& statistic() const noexcept { return statistic_; }

 private:
  static constexpr int kSums = 256;     // that are kept, a power of two
  static constexpr int kSpans = 8;      // between them
  static constexpr double kGap = 0.05;  // [s] after which the mean starts anew, as estimators do

  void forget() noexcept {
    statistic_.setZero();
    start(0);
  }
  // nothing was before t
  void start(double t) noexcept {
    last_ = 0;
    count_ = 1;
    t_[0] = t;
    sum_[0].fill(0);
  }
  [[gnu::always_inline]] void add(double t, const JointVecView<Scalar>& tau_ext) noexcept {
    const int next = (last_ + 1) % kSums;
    const Scalar h = t - t_[last_];
    mean_.advance(t);
    for (int i = 0; i < statistic_.size(); ++i)
      sum_[next][i] = sum_[last_][i] + h * (tau_ext[i] - mean_(i, tau_ext[i]));
    t_[next] = t;
    last_ = next;
    count_ = std::min(count_ + 1, kSums);
  }
  // (i)
  [[gnu::always_inline]] void look_back() noexcept {
    using std::abs;
    using std::max;
    std::array<const Scalar*, kSpans> then;
    std::array<double, kSpans> weight;
    std::size_t spans = 0;
    for (int n = 1; n < count_; n *= 2, ++spans) {
      const int at = (last_ - n + kSums) % kSums;
      const double lasts = t_[last_] - t_[at];
      if (lasts > p_.span) break;
      then[spans] = sum_[at].data();
      weight[spans] = 1 / std::sqrt(lasts);
    }
    for (int i = 0; i < statistic_.size(); ++i) {
      const Scalar now = sum_[last_][i];
      Scalar most = 0;
      for (std::size_t s = 0; s < spans; ++s)
        most = max(most, Scalar(weight[s]) * abs(now - then[s][i]));
      statistic_[i] = most;
    }
  }

  Parameters p_;
  LowPass<Scalar> mean_;
  BasicMarking<Scalar> marking_;
  int last_ = 0, count_ = 1;  // of the sums
  std::array<double, kSums> t_{};
  std::array<std::array<Scalar, kMostDof>, kSums> sum_{};  // [N m s]
  JointVec<Scalar> statistic_;
};

/// Of one run.
using Glr = BasicGlr<>;
static_assert(CalibratableDetector<Glr>);

}  // namespace tauext

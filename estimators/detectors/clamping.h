// SPDX-License-Identifier: Apache-2.0
/// @file
/// Something is caught between the arm and a wall: the force rises slowly, over half a second or
/// more, beyond any push, and stays. A derivative does not see that; a plain limit takes an unknown
/// payload for it. So the limit is on what has changed within the last second or so:
///     z = high-pass of tau_ext at w_baseline, low-pass at w_smooth (filters.h)              (i)
///     size = sqrt(z^T metric z)                                                             (ii)
///     lasting = smallest size of the last `duration`, by eight blocks of it                 (iii)
///     mark where lasting / threshold rises through 1
/// One force is a different torque on every joint, in every direction another; the metric undoes
/// that. Trained on pushes from all sides it is (I + C / rho^2)^-1, C the covariance of z in
/// training and rho a torque that counts where training shows nothing (Mahalanobis 1936), so that
/// pushes of one strength are of one size, and what an unknown payload does as the arm moves counts
/// less. (iii) lets a blow pass: it is over before `duration` is. Known limits: what rises much
/// slower than 1 / w_baseline passes, too; and a push that is as strong and as slow is a clamping
/// to it.
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "estimators/concepts.h"
#include "estimators/detectors/filters.h"
#include "estimators/detectors/marking.h"

namespace tauext {

/// A value for each two joints of an arm of up to kMostDof, without a heap.
template <class Scalar = double>
using JointMat =
    Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostDof, kMostDof>;

/// What can be chosen of a Clamping.
struct ClampingParameters {
  /// [N m] of `lasting`; the smallest one counts, since the metric mixes the joints: larger
  /// misses more and alarms less; by default beyond a push of 100 N at 1.5 m
  JointVec<> threshold = JointVec<>::Constant(1, 150);
  JointMat<> metric{};  ///< [1] of (ii), symmetric positive definite; empty: identity
  /// [rad/s] of the baseline: larger forgets payloads and model errors quicker, but also a
  /// clamping that rises slowly
  double w_baseline = 0.5;
  double w_smooth = 100;    ///< [rad/s] smaller lets less noise pass, and marks later
  double duration = 0.1;    ///< [s] larger lets longer blows pass, and marks later
  double refractory = 0.5;  ///< [s] after a mark without another
  double start_up = 0;      ///< [s] after the first sample without a mark

  /// The metric comes from training, and cannot be set by name.
  static constexpr auto fields() {
    using P = ClampingParameters;
    return std::tuple_cat(
        std::tuple(threshold_field<P>("N m"),
                   Field{"w_baseline", &P::w_baseline, "rad/s", kLeastBandwidth, kMostBandwidth,
                         "larger forgets payloads sooner, clampings too"},
                   Field{"w_smooth", &P::w_smooth, "rad/s", kLeastBandwidth, kMostBandwidth,
                         "larger lets more noise pass, marks sooner"},
                   Field{"duration", &P::duration, "s", 1e-6, 1e3,
                         "larger ignores longer blows, marks later"}),
        marking_fields<P>());
  }
};

/// Limit on slow, lasting changes; with a Pack for Scalar, of several runs.
template <class Scalar = double>
class BasicClamping {
 public:
  static constexpr const char* kName = "clamping";
  static constexpr int kDegree = 1;
  using Parameters = ClampingParameters;  ///< what can be set
  template <class Other>
  using For = BasicClamping<Other>;  ///< the same, computed with another number

  /// @throws std::invalid_argument as for_joints() (estimators/parameters.h)
  explicit BasicClamping(int joints, const Parameters& p = {})
      : p_(for_joints(p, joints, kName)),
        baseline_(joints, p.w_baseline),
        smooth_(joints, p.w_smooth),
        metric_(JointMat<Scalar>::Identity(joints, joints)),
        marking_(p.refractory, p.start_up),
        least_threshold_(p.threshold.minCoeff()),
        z_(JointVec<Scalar>::Zero(joints)),
        statistic_(z_) {
    require(p.w_baseline < p.w_smooth, "w_baseline of clamping must be below w_smooth");
    if (p.metric.size() > 0) {
      require(p.metric.rows() == joints && p.metric.cols() == joints,
              "metric of clamping must have a row and a column for each joint");
      require(p.metric.isApprox(p.metric.transpose()) &&
                  Eigen::LLT<JointMat<>>(p.metric).info() == Eigen::Success,
              "metric of clamping must be symmetric and positive definite");
      metric_ = p.metric.template cast<Scalar>();
    }
    reset();
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
      baseline_.start(t, tau_ext);
      smooth_.start(t, JointVec<Scalar>::Zero(tau_ext.size()).eval());
      block_began_ = t;
    } else {
      using std::sqrt;
      baseline_.advance(t);
      smooth_.advance(t);
      for (int i = 0; i < z_.size(); ++i)
        z_[i] = smooth_(i, tau_ext[i] - baseline_(i, tau_ext[i]));  // (i)
      keep(t, sqrt(square()));                                      // (ii)
    }
    return marking_(t, statistic_[0] / least_threshold_, Contact::kClamping);
  }

  /// [N m] `lasting`, the same for every joint.
  const JointVec<Scalar>& statistic() const noexcept { return statistic_; }

  /// [N m] z of (i): how far tau_ext is from its baseline.
  const JointVec<Scalar>& change() const noexcept { return z_; }

 private:
  void forget() noexcept {
    z_.setZero();
    statistic_.setZero();
    blocks_.fill(0);
    older_ = 0;
  }

  // [(N m)^2] z^T metric z, of the half that the symmetric one is
  [[gnu::always_inline]] Scalar square() const noexcept {
    Scalar sum = 0;
    for (int j = 0; j < z_.size(); ++j) {
      Scalar weighed = metric_(j, j) * z_[j];
      for (int i = 0; i < j; ++i) {
        // one by one, as z was just written: to read it by registers stalls (math/lanes.h)
        asm("" : "+r"(i));
        weighed += (metric_(i, j) + metric_(i, j)) * z_[i];
      }
      sum += z_[j] * weighed;
    }
    return sum;
  }

  static constexpr int kBlocks = 8;

  // (iii)
  void keep(double t, const Scalar& size) noexcept {
    using std::min;
    if (t - block_began_ >= p_.duration / kBlocks) {
      block_began_ = t;
      newest_ = (newest_ + 1) % kBlocks;
      blocks_[newest_] = std::numeric_limits<double>::infinity();
      older_ = blocks_[0];
      for (const Scalar& least : blocks_) older_ = min(older_, least);
      blocks_[newest_] = size;
    }
    blocks_[newest_] = min(blocks_[newest_], size);
    statistic_.setConstant(min(older_, blocks_[newest_]));
  }

  Parameters p_;
  LowPass<Scalar> baseline_, smooth_;
  JointMat<Scalar> metric_;
  BasicMarking<Scalar> marking_;
  double least_threshold_;              // [N m]
  std::array<Scalar, kBlocks> blocks_;  // [N m]
  Scalar older_ = 0;                    // [N m] least of all but the newest
  int newest_ = 0;
  double block_began_ = 0;  // [s]
  JointVec<Scalar> z_, statistic_;
};

/// Of one run.
using Clamping = BasicClamping<>;
static_assert(CalibratableDetector<Clamping>);

}  // namespace tauext

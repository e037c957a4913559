// SPDX-License-Identifier: Apache-2.0
/// @file
/// Collision detector after Pan and Tompkins: section 4 of the paper, Fig. 2. Per joint:
///     slope = d tau_ext / dt                  differentiation, least squares over five points   (i)
///     energy = slope^2                        squaring
///     held = largest energy of the last `hold` seconds                 delay                   (ii)
///     mark where max_i(held_i / threshold_i) rises through 1           fiducial mark          (iii)
/// and no second mark within `refractory`. At equal spacing (i) is Pan and Tompkins' filter
/// (2, 1, 0, -1, -2) / (10 T). The paper gives no filter, window or threshold: all are ours.
///
/// A squared slope grows with the square of the sampling rate and of the noise, so a threshold
/// belongs to one spacing of the five points. Known limits: a soft clamping is missed, a brisk push
/// is marked; and the state of rest before a collision does not matter, which is the point.
#pragma once

#include <array>
#include <cstddef>
#include <tuple>
#include <type_traits>

#include "estimators/concepts.h"
#include "estimators/detectors/marking.h"

namespace tauext {

/// What can be chosen of a PanTompkins.
struct PanTompkinsParameters {
  static constexpr int kMaxStride = 16;  ///< samples between the two that a difference takes

  /// samples from point to point of (i), 1 to kMaxStride: larger is later but less noisy
  int stride = 5;
  /// [(N m/s)^2] of (iii) per joint; the default is 40 times the squared slope of a human's
  /// minimum-jerk push of 50 N m in 1 s (94 N m/s), and belongs to stride 5 at 1 kHz
  JointVec<> threshold = JointVec<>::Constant(1, 3.6e5);
  double hold = 0.02;       ///< [s] how long an energy is kept
  double refractory = 0.2;  ///< [s] after a mark without another
  double start_up = 0;      ///< [s] after the first sample without a mark

  static constexpr auto fields() {
    using P = PanTompkinsParameters;
    return std::tuple_cat(
        std::tuple(
            Field{"stride", &P::stride, "samples", 1, kMaxStride, "larger is later, less noisy"},
            threshold_field<P>("(N m/s)^2"),
            Field{"hold", &P::hold, "s", 0, 1e3, "how long an energy is kept"}),
        marking_fields<P>());
  }
};

/// The paper's detector; with a Pack for Scalar, of several runs.
template <class Scalar = double>
class BasicPanTompkins {
 public:
  static constexpr const char* kName = "pan_tompkins";
  static constexpr int kDegree = 2;          ///< the energy is a square
  using Parameters = PanTompkinsParameters;  ///< what can be set
  template <class Other>
  using For = BasicPanTompkins<Other>;  ///< the same, computed with another number

  /// @throws std::invalid_argument as for_joints() (estimators/parameters.h)
  explicit BasicPanTompkins(int joints, const Parameters& p = {})
      : p_(for_joints(p, joints, kName)),
        marking_(p.refractory, p.start_up),
        held_(JointVec<Scalar>::Zero(joints)),
        held_at_(held_) {}

  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed

  void reset() noexcept {
    marking_.reset();
    forget();
  }

  DetectionOf<Scalar> update(double t, const JointVecView<Scalar>& tau_ext) noexcept {
    if (tau_ext.size() != held_.size() || !marking_.accept(t)) return marking_.held();
    if (marking_.starts()) forget();
    newest_ = newest_ + 1 < kHistory ? newest_ + 1 : 0;
    t_[newest_] = t;
    for (int i = 0; i < held_.size(); ++i) tau_ext_[newest_][i] = tau_ext[i];
    if (++count_ <= 4 * p_.stride) return marking_(t, 0, Contact::kNone);

    const Slope to_newest = slope(newest_);
    for (int i = 0; i < held_.size(); ++i) {
      const Scalar rate = to_newest(i), energy = rate * rate;
      const MaskOf<Scalar> is_higher = energy >= held_[i], is_over = t - held_at_[i] > p_.hold;
      const MaskOf<Scalar> is_new = is_higher | is_over;  // (ii)
      if constexpr (std::is_same_v<Scalar, double>) {
        if (!is_new) continue;  // for one run the processor predicts this branch
      }
      held_[i] = select(is_new, energy, held_[i]);
      held_at_[i] = select(is_new, Scalar(t), held_at_[i]);
    }
    return marking_(t, largest_ratio(held_, p_.threshold),
                    Contact::kCollision);  // (iii)
  }

  /// [(N m/s)^2] held energy of each joint.
  const JointVec<Scalar>& statistic() const noexcept { return held_; }

 private:
  static constexpr int kHistory = 4 * Parameters::kMaxStride + 1;

  void forget() noexcept {
    count_ = 0;
    held_.setZero();
    held_at_.setZero();
  }

  // (i)
  struct Slope {
    std::array<const Scalar*, 5> tau_ext;  // of the five points [N m], joint by joint
    std::array<double, 5> from_mean;       // [s]
    double per_square;                     // [1/s^2]
    // [N m/s]
    [[gnu::always_inline]] Scalar operator()(int joint) const noexcept {
      Scalar sum = Scalar(from_mean[0]) * tau_ext[0][joint];
      for (std::size_t j = 1; j < tau_ext.size(); ++j)
        sum += Scalar(from_mean[j]) * tau_ext[j][joint];
      return sum * Scalar(per_square);
    }
  };
  [[gnu::always_inline]] Slope slope(int newest) const noexcept {
    Slope s;
    double sum_t = 0, square = 0;
    for (std::size_t j = 0; j < s.tau_ext.size(); ++j) {
      s.tau_ext[j] = tau_ext_[newest].data();
      s.from_mean[j] = t_[newest];
      sum_t += t_[newest];
      newest -= p_.stride;
      if (newest < 0) newest += kHistory;
    }
    for (double& t : s.from_mean) {
      t -= 0.2 * sum_t;
      square += t * t;
    }
    s.per_square = 1 / square;
    return s;
  }

  Parameters p_;
  BasicMarking<Scalar> marking_;
  std::array<double, kHistory> t_{};
  std::array<std::array<Scalar, kMostDof>, kHistory> tau_ext_{};  // [N m]
  long count_ = 0;
  int newest_ = 0;  // of the history
  JointVec<Scalar> held_, held_at_;
};

/// Of one run.
using PanTompkins = BasicPanTompkins<>;
static_assert(CalibratableDetector<PanTompkins>);

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// A static limit on the estimate, the oldest detector of all: De Luca and Mattone 2003; Haddadin,
/// De Luca and Albu-Schaeffer 2017, section IV.
///     mark where max_i(|tau_ext_i| / threshold_i) rises through 1
/// Knows no difference between a blow, a hand that leans on the arm and a payload that the model
/// lacks.
#pragma once

#include <cmath>
#include <tuple>

#include "estimators/concepts.h"
#include "estimators/detectors/marking.h"

namespace tauext {

/// What can be chosen of a Threshold.
struct ThresholdParameters {
  /// [N m] per joint: larger misses more and alarms less; by default beyond a push of 100 N at
  /// 1.2 m
  JointVec<> threshold = JointVec<>::Constant(1, 120);
  double refractory = 0.2;  ///< [s] after a mark without another
  double start_up = 0;      ///< [s] after the first sample without a mark

  static constexpr auto fields() {
    return std::tuple_cat(std::tuple(threshold_field<ThresholdParameters>("N m")),
                          marking_fields<ThresholdParameters>());
  }
};

/// Static threshold; with a Pack for Scalar, of several runs.
template <class Scalar = double>
class BasicThreshold {
 public:
  static constexpr const char* kName = "threshold";
  static constexpr int kDegree = 1;
  using Parameters = ThresholdParameters;  ///< what can be set
  template <class Other>
  using For = BasicThreshold<Other>;  ///< the same, computed with another number

  /// @throws std::invalid_argument as for_joints() (estimators/parameters.h)
  explicit BasicThreshold(int joints, const Parameters& p = {})
      : p_(for_joints(p, joints, kName)),
        marking_(p.refractory, p.start_up),
        statistic_(JointVec<Scalar>::Zero(joints)) {}

  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed

  void reset() noexcept {
    marking_.reset();
    statistic_.setZero();
  }

  DetectionOf<Scalar> update(double t, const JointVecView<Scalar>& tau_ext) noexcept {
    using std::abs;
    if (tau_ext.size() != statistic_.size() || !marking_.accept(t)) return marking_.held();
    for (int i = 0; i < statistic_.size(); ++i) statistic_[i] = abs(tau_ext[i]);
    return marking_(t, largest_ratio(statistic_, p_.threshold), Contact::kCollision);
  }

  /// [N m] |tau_ext|.
  const JointVec<Scalar>& statistic() const noexcept { return statistic_; }

 private:
  Parameters p_;
  BasicMarking<Scalar> marking_;
  JointVec<Scalar> statistic_;
};

/// Of one run.
using Threshold = BasicThreshold<>;
static_assert(CalibratableDetector<Threshold>);

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// A static limit on the estimate, the oldest detector of all: De Luca and Mattone 2003; Haddadin,
/// De Luca and Albu-Schaeffer 2017, section IV.
///     mark where max_i(|tau_ext_i| / threshold_i) rises through 1
/// Knows no difference between a blow, a hand that leans on the arm and a payload that the model
/// lacks.
#pragma once

#include <tuple>

#include "estimators/concepts.h"
#include "estimators/detectors/marking.h"

namespace tauext {

/// Static threshold over N joints.
template <int N>
class Threshold {
 public:
  static constexpr const char* kName = "threshold";
  static constexpr int kDof = N;
  static constexpr int kDegree = 1;

  struct Parameters {
    /// [N m] per joint: larger misses more and alarms less; by default beyond a push of 100 N at
    /// 1.2 m
    Vec<N> threshold = Vec<N>::Constant(120);
    double refractory = 0.2;  ///< [s] after a mark without another
    double start_up = 0;      ///< [s] after the first sample without a mark

    static constexpr auto fields() {
      return std::tuple_cat(std::tuple(threshold_field<Parameters>("N m")),
                            marking_fields<Parameters>());
    }
  };

  /// @throws std::invalid_argument for parameters out of range
  explicit Threshold(const Parameters& p = {})
      : p_(check_parameters(p, kName)), marking_(p.refractory, p.start_up) {}

  void reset() noexcept {
    marking_.reset();
    statistic_.setZero();
  }

  Detection update(double t, const Vec<N>& tau_ext) noexcept {
    if (!marking_.accept(t)) return marking_.held();
    statistic_ = tau_ext.cwiseAbs();
    return marking_(t, statistic_.cwiseQuotient(p_.threshold).maxCoeff(), Contact::kCollision);
  }

  /// [N m] |tau_ext|.
  const Vec<N>& statistic() const noexcept { return statistic_; }

 private:
  Parameters p_;
  Marking marking_;
  Vec<N> statistic_ = Vec<N>::Zero();
};

static_assert(CalibratableDetector<Threshold<3>>);

}  // namespace tauext

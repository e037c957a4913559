// SPDX-License-Identifier: Apache-2.0
/// @file
/// A limit that grows with speed, since errors of friction and inertia do: Sotoudehnejad and
/// Kermani, "Velocity-based variable thresholds for improving collision detection in manipulators",
/// ICRA 2014, in its simplest form.
///     mark where max_i(|tau_ext_i| / (threshold_i (1 + |qd_i| / speed))) rises through 1
#pragma once

#include <tuple>

#include "estimators/concepts.h"
#include "estimators/detectors/marking.h"

namespace tauext {

/// Speed-dependent threshold over N joints.
template <int N>
class DynamicThreshold {
 public:
  static constexpr const char* kName = "dynamic_threshold";
  static constexpr int kDof = N;
  static constexpr int kDegree = 1;

  struct Parameters {
    /// [N m] per joint at rest: larger misses more and alarms less; by default a push of 80 N at
    /// 1.2 m
    Vec<N> threshold = Vec<N>::Constant(100);
    double speed = 0.5;  ///< [rad/s] at which the limit has doubled: smaller trusts motion less
    double refractory = 0.2;  ///< [s] after a mark without another
    double start_up = 0;      ///< [s] after the first sample without a mark

    static constexpr auto fields() {
      using P = Parameters;
      return std::tuple_cat(
          std::tuple(threshold_field<P>("N m"),
                     Field{"speed", &P::speed, "rad/s", 1e-6, 1e6, "where the limit has doubled"}),
          marking_fields<P>());
    }
  };

  /// @throws std::invalid_argument for parameters out of range
  explicit DynamicThreshold(const Parameters& p = {})
      : p_(check_parameters(p, kName)), marking_(p.refractory, p.start_up) {}

  void reset() noexcept {
    marking_.reset();
    statistic_.setZero();
  }

  Detection update(const Measurement<N>& y, const Vec<N>& tau_ext) noexcept {
    if (!within(y.qd, kMeasurementLimit) || !marking_.accept(y.t)) return marking_.held();
    const Vec<N> growth = (1 + y.qd.array().abs() / p_.speed).matrix();
    statistic_ = tau_ext.cwiseAbs().cwiseQuotient(growth);
    return marking_(y.t, statistic_.cwiseQuotient(p_.threshold).maxCoeff(), Contact::kCollision);
  }

  /// [N m] |tau_ext| as it would count at rest.
  const Vec<N>& statistic() const noexcept { return statistic_; }

 private:
  Parameters p_;
  Marking marking_;
  Vec<N> statistic_ = Vec<N>::Zero();
};

static_assert(CalibratableDetector<DynamicThreshold<3>>);

}  // namespace tauext

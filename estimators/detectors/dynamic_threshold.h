// SPDX-License-Identifier: Apache-2.0
/// @file
/// A limit that grows with speed, since errors of friction and inertia do: Sotoudehnejad and
/// Kermani, "Velocity-based variable thresholds for improving collision detection in manipulators",
/// ICRA 2014, in its simplest form; and with the torque that holds and moves the arm, since errors
/// of gains, masses and payloads do (ours).
///     mark where max_i((|tau_ext_i| - share |tau_i|) / (threshold_i (1 + |qd_i| / speed))) rises
///     through 1
#pragma once

#include <algorithm>
#include <cmath>
#include <tuple>

#include "estimators/concepts.h"
#include "estimators/detectors/marking.h"

namespace tauext {

/// What can be chosen of a DynamicThreshold.
struct DynamicThresholdParameters {
  /// [N m] per joint at rest: larger misses more and alarms less; by default a push of 80 N at
  /// 1.2 m
  JointVec<> threshold = JointVec<>::Constant(1, 100);
  double speed = 0.5;       ///< [rad/s] at which the limit has doubled: smaller trusts motion less
  double share = 0;         ///< [1] of tau that may be wrong: larger trusts model and sensor less
  double refractory = 0.2;  ///< [s] after a mark without another
  double start_up = 0;      ///< [s] after the first sample without a mark

  static constexpr auto fields() {
    using P = DynamicThresholdParameters;
    return std::tuple_cat(
        std::tuple(threshold_field<P>("N m"),
                   Field{"speed", &P::speed, "rad/s", 1e-6, 1e6, "where the limit has doubled"},
                   Field{"share", &P::share, "1", 0, 1e3, "of tau that may be wrong"}),
        marking_fields<P>());
  }
};

/// Speed-dependent threshold; with a Pack for Scalar, of several runs.
template <class Scalar = double>
class BasicDynamicThreshold {
 public:
  static constexpr const char* kName = "dynamic_threshold";
  static constexpr int kDegree = 1;               ///< at least: the share does not grow
  using Parameters = DynamicThresholdParameters;  ///< what can be set
  template <class Other>
  using For = BasicDynamicThreshold<Other>;  ///< the same, computed with another number

  /// @throws std::invalid_argument as for_joints() (estimators/parameters.h)
  explicit BasicDynamicThreshold(int joints, const Parameters& p = {})
      : p_(for_joints(p, joints, kName)),
        marking_(p.refractory, p.start_up),
        statistic_(JointVec<Scalar>::Zero(joints)) {}

  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed

  void reset() noexcept {
    marking_.reset();
    statistic_.setZero();
  }

  DetectionOf<Scalar> update(double t, const JointVecView<Scalar>& qd,
                             const JointVecView<Scalar>& tau,
                             const JointVecView<Scalar>& tau_ext) noexcept {
    const Eigen::Index n = statistic_.size();
    if (tau_ext.size() != n || qd.size() != n || tau.size() != n || !measured(qd) ||
        !measured(tau) || !marking_.accept(t))
      return marking_.held();
    using std::abs;
    using std::max;
    for (int i = 0; i < statistic_.size(); ++i) {
      const Scalar growth = Scalar(1) + abs(qd[i]) / Scalar(p_.speed);
      statistic_[i] = max(abs(tau_ext[i]) - Scalar(p_.share) * abs(tau[i]), Scalar(0)) / growth;
    }
    return marking_(t, largest_ratio(statistic_, p_.threshold), Contact::kCollision);
  }

  /// [N m] |tau_ext| as it would count at rest and without a torque.
  const JointVec<Scalar>& statistic() const noexcept { return statistic_; }

 private:
  Parameters p_;
  BasicMarking<Scalar> marking_;
  JointVec<Scalar> statistic_;
};

/// Of one run.
using DynamicThreshold = BasicDynamicThreshold<>;
static_assert(CalibratableDetector<DynamicThreshold>);

}  // namespace tauext

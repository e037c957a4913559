// SPDX-License-Identifier: Apache-2.0
/// @file
/// The energy observer: Haddadin, De Luca and Albu-Schaeffer, "Robot Collisions: A Survey on
/// Detection, Isolation, and Identification", IEEE Transactions on Robotics 2017 (its form after
/// the code of mc_energy_residual). With T the arm's kinetic energy,
///     r = w (T - integral of (qd^T (tau - g - F) - r)),   rdot = w (-qd^T tau_ext - r)         (i)
/// so r is the power of the contact through a first-order low-pass, and that is how it is computed
/// here, behind any estimator:
///     mark where |r| / threshold rises through 1
/// One number for the whole arm, and blind where the arm rests.
#pragma once

#include <cmath>
#include <tuple>

#include "estimators/concepts.h"
#include "estimators/detectors/filters.h"
#include "estimators/detectors/marking.h"

namespace tauext {

/// What can be chosen of an Energy.
struct EnergyParameters {
  /// [W] per joint, of which the least counts: larger misses more and alarms less; by default 80 N
  /// at 0.25 m/s
  JointVec<> threshold = JointVec<>::Constant(1, 20);
  double w = 60;            ///< [rad/s] of the low-pass: larger is quicker, and noisier
  double refractory = 0.2;  ///< [s] after a mark without another
  double start_up = 0;      ///< [s] after the first sample without a mark

  static constexpr auto fields() {
    using P = EnergyParameters;
    return std::tuple_cat(std::tuple(threshold_field<P>("W"),
                                     Field{"w", &P::w, "rad/s", kLeastBandwidth, kMostBandwidth,
                                           "low-pass; larger is quicker, noisier"}),
                          marking_fields<P>());
  }
};

/// Energy observer; with a Pack for Scalar, of several runs.
template <class Scalar = double>
class BasicEnergy {
 public:
  static constexpr const char* kName = "energy";
  static constexpr int kDegree = 1;
  using Parameters = EnergyParameters;  ///< what can be set
  template <class Other>
  using For = BasicEnergy<Other>;  ///< the same, computed with another number

  /// @throws std::invalid_argument as for_joints() (estimators/parameters.h)
  explicit BasicEnergy(int joints, const Parameters& p = {})
      : p_(for_joints(p, joints, kName)),
        power_(1, p.w),
        marking_(p.refractory, p.start_up),
        statistic_(JointVec<Scalar>::Zero(joints)) {}

  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed

  void reset() noexcept {
    marking_.reset();
    forget();
  }

  DetectionOf<Scalar> update(double t, const JointVecView<Scalar>& qd, const JointVecView<Scalar>&,
                             const JointVecView<Scalar>& tau_ext) noexcept {
    const Eigen::Index n = statistic_.size();
    if (tau_ext.size() != n || qd.size() != n || !measured(qd) || !marking_.accept(t))
      return marking_.held();
    if (marking_.starts()) forget();
    Scalar power = qd[0] * tau_ext[0];
    for (int i = 1; i < statistic_.size(); ++i) power = power + qd[i] * tau_ext[i];
    if (marking_.silent(t)) {
      power_.start(t, {&power, 1});
    } else {
      using std::abs;
      power_.advance(t);
      statistic_.setConstant(abs(power_(0, power)));  // (i)
    }
    return marking_(t, largest_ratio(statistic_, p_.threshold), Contact::kCollision);
  }

  /// [W] |r|, the same for each joint.
  const JointVec<Scalar>& statistic() const noexcept { return statistic_; }

 private:
  void forget() noexcept { statistic_.setZero(); }

  Parameters p_;
  LowPass<Scalar> power_;
  BasicMarking<Scalar> marking_;
  JointVec<Scalar> statistic_;
};

/// Of one run.
using Energy = BasicEnergy<>;
static_assert(CalibratableDetector<Energy>);

}  // namespace tauext

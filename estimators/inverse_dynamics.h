// SPDX-License-Identifier: Apache-2.0
/// @file
/// Inverse dynamics: the paper (4), with the acceleration it needs from a filtered difference.
///
///     raw_k = tau - B (qd_k - qd_k-1) / h - (C qd + F + g)     over [t_k-1, t_k)         (4)
///     d_k = a d_k-1 + (1 - a) raw_k,   a = exp(-w h)
/// tau is tau_k-1 (held over the interval); B and C qd + F + g are the mean of both ends. Every
/// term goes through the one filter, so the terms stay in phase and a motion without contact
/// cancels. At equal bandwidth this is the first-order momentum observer.
#pragma once

#include <cmath>
#include <tuple>

#include "estimators/concepts.h"
#include "estimators/sampling.h"

namespace tauext {

/// Filtered computed torque over a robot model M.
template <RobotModel M>
class InverseDynamics {
 public:
  static constexpr const char* kName = "inverse_dynamics";
  static constexpr int kDof = M::kDof;

  struct Parameters {
    double bandwidth =
        30;  ///< [rad/s] of the filter: larger is faster and noisier (ours; (4) has none)
    TorqueSampling torque = TorqueSampling::kHeld;  ///< when tau acted
    double max_gap = 0.05;                          ///< [s] a longer gap restarts the filter

    static constexpr auto fields() {
      return std::tuple(bandwidth_field<Parameters>(), torque_field<Parameters>(),
                        max_gap_field<Parameters>());
    }

    /// Bandwidth w [rad/s] on every joint, in every pose.
    static Parameters for_bandwidth(const M&, double w) { return {.bandwidth = w}; }
  };

  /// @throws std::invalid_argument for parameters out of range
  explicit InverseDynamics(const M& model, const Parameters& p = {})
      : model_(model),
        p_(check_parameters(p, kName)),
        sampling_(p.max_gap, limits_of(model), p.torque) {}

  void reset() noexcept {
    sampling_.reset();
    new_step_ = {};
    tau_ext_.setZero();
  }

  Estimate<kDof> update(const Measurement<kDof>& y) noexcept {
    Status status = sampling_.accept(y);
    if (!used(status)) return {tau_ext_, status, sampling_.joints()};
    Dynamics<kDof> now = dynamics(model_, y.q, y.qd);
    now.bias += model_.friction(y.qd);
    if (status == Status::kOk) {
      const double h = sampling_.h();
      const Vec<kDof> qdd = (y.qd - qd_) / h;
      const Vec<kDof> raw =
          sampling_.torque(y) - 0.5 * ((now.B + before_.B) * qdd + now.bias + before_.bias);  // (4)
      if (new_step_(h)) share_ = -std::expm1(-p_.bandwidth * h);
      tau_ext_ += share_ * (raw - tau_ext_);
      if (!within(tau_ext_, kEstimateLimit)) {
        tau_ext_.setZero();
        status = Status::kDiverged;
      }
    }
    before_ = now;
    qd_ = y.qd;
    return {tau_ext_, status, sampling_.joints()};
  }

 private:
  M model_;
  Parameters p_;
  Sampling<kDof> sampling_;
  StepChange new_step_;
  double share_ = 0;  // [1] 1 - a
  // at the last used sample, bias with friction
  Dynamics<kDof> before_{Mat<kDof>::Zero(), Vec<kDof>::Zero()};
  Vec<kDof> qd_ = Vec<kDof>::Zero();       // [rad/s] there
  Vec<kDof> tau_ext_ = Vec<kDof>::Zero();  // [N m] the last estimate
};

}  // namespace tauext

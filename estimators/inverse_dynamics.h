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
  using Scalar = ScalarOf<M>;  ///< double, or a Pack for several runs at once
  using Model = M;             ///< of the arm
  template <class Other>
  using For = InverseDynamics<Other>;  ///< the same over another model

  struct Parameters {
    Scalar bandwidth =
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

  Estimate<kDof, Scalar> update(const Measurement<kDof, Scalar>& y) noexcept {
    Status status = sampling_.accept(y);
    if (!used(status)) return {tau_ext_, status, sampling_.joints()};
    Dynamics<kDof, Scalar> now = dynamics(model_, y.q, y.qd);
    now.bias += model_.friction(y.qd);
    if (status == Status::kOk) {
      const Scalar h = sampling_.h();
      const Vec<kDof, Scalar> qdd = (y.qd - qd_) / h;
      const Vec<kDof, Scalar> raw =
          sampling_.torque(y) - 0.5 * ((now.B + before_.B) * qdd + now.bias + before_.bias);  // (4)
      if (new_step_(h)) {
        using std::expm1;
        share_ = -expm1(-p_.bandwidth * new_step_.h());
      }
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

  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed
  /// What a run is at: all that changes from sample to sample. See runs/runs.h.
  auto memory() noexcept {
    return std::tie(sampling_, new_step_, share_, before_.B, before_.bias, qd_, tau_ext_);
  }

 private:
  M model_;
  Parameters p_;
  Sampling<kDof, Scalar> sampling_;
  StepChange<Scalar> new_step_;
  Scalar share_ = 0;  // [1] 1 - a
  // at the last used sample, bias with friction
  Dynamics<kDof, Scalar> before_{Mat<kDof, Scalar>::Zero(), Vec<kDof, Scalar>::Zero()};
  Vec<kDof, Scalar> qd_ = Vec<kDof, Scalar>::Zero();       // [rad/s] there
  Vec<kDof, Scalar> tau_ext_ = Vec<kDof, Scalar>::Zero();  // [N m] the last estimate
};

}  // namespace tauext

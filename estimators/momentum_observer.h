// SPDX-License-Identifier: Apache-2.0
/// @file
/// First-order generalised momentum observer: De Luca and Mattone, "Actuator failure detection and
/// isolation using generalized momenta", ICRA 2003; Haddadin, De Luca and Albu-Schaeffer, "Robot
/// collisions: a survey on detection, isolation, and identification", T-RO 2017, eq. (31).
///
///     p = B qd,   pdot = n - tau_ext,   n = tau - F - g + C^T qd                           (i)
///     ddot = K (n - pdot - d):  every joint follows tau_ext as a low-pass of K, whatever the pose
/// The residual r of the literature is -d: it has the opposite sign of (3).
///
/// Discretised exactly over [t_k-1, t_k), as Bledt et al., IROS 2018, do, so that it is stable for
/// every K h and no initial momentum has to be kept:
///     d_k = a d_k-1 + (1 - a) (n - (p_k - p_k-1) / h),   a = exp(-K h)                     (ii)
/// tau is tau_k-1 (held over the interval); the other terms of n are the mean of both ends.
#pragma once

#include <cmath>
#include <tuple>

#include "estimators/momentum.h"
#include "estimators/sampling.h"

namespace tauext {

/// Momentum observer over a robot model M.
template <RobotModel M>
class MomentumObserver {
 public:
  static constexpr const char* kName = "mo1";
  static constexpr int kDof = M::kDof;
  using Scalar = ScalarOf<M>;  ///< double, or a Pack for several runs at once
  using Model = M;             ///< of the arm
  template <class Other>
  using For = MomentumObserver<Other>;  ///< the same over another model

  struct Parameters {
    /// [rad/s] bandwidth of every joint, positive: larger is faster and noisier; 90 % of a step
    /// after ln 10 / K, a ramp is followed slope / K behind
    Vec<kDof, Scalar> K = Vec<kDof, Scalar>::Constant(30);
    TorqueSampling torque = TorqueSampling::kHeld;  ///< when tau acted
    double max_gap = 0.05;                          ///< [s] a longer gap restarts the observer

    static constexpr auto fields() {
      return std::tuple(Field{"K", &Parameters::K, "rad/s", kLeastBandwidth, kMostBandwidth,
                              "larger is faster and noisier"},
                        torque_field<Parameters>(), max_gap_field<Parameters>());
    }

    /// Bandwidth w [rad/s] on every joint, in every pose.
    static Parameters for_bandwidth(const M&, double w) {
      return {.K = Vec<kDof, Scalar>::Constant(w)};
    }
  };

  /// @throws std::invalid_argument for parameters out of range
  explicit MomentumObserver(const M& model, const Parameters& p = {})
      : p_(check_parameters(p, kName)),
        sampling_(p.max_gap, limits_of(model), p.torque),
        momentum_(model) {}

  void reset() noexcept {
    sampling_.reset();
    new_step_ = {};
    tau_ext_.setZero();
  }

  Estimate<kDof, Scalar> update(const Measurement<kDof, Scalar>& y) noexcept {
    Status status = sampling_.accept(y);
    if (!used(status)) return {tau_ext_, status, sampling_.joints()};
    const MomentumStep<kDof, Scalar> step = momentum_.advance(y, sampling_.torque(y));
    if (status == Status::kOk) {
      const Scalar h = sampling_.h();
      if (new_step_(h)) {
        share_ = (-new_step_.h() * p_.K).unaryExpr([](const Scalar& x) {
          using std::expm1;
          return Scalar(-expm1(x));
        });
      }
      tau_ext_ += share_.cwiseProduct(step.n - step.dp / h - tau_ext_);  // (ii)
      if (!within(tau_ext_, kEstimateLimit)) {
        tau_ext_.setZero();
        status = Status::kDiverged;
      }
    }
    return {tau_ext_, status, sampling_.joints()};
  }

  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed
  /// What a run is at: all that changes from sample to sample. See runs/runs.h.
  auto memory() noexcept {
    return std::tuple_cat(std::tie(sampling_, new_step_, share_, tau_ext_), momentum_.memory());
  }

 private:
  Parameters p_;
  Sampling<kDof, Scalar> sampling_;
  Momentum<M> momentum_;
  StepChange<Scalar> new_step_;
  Vec<kDof, Scalar> share_ = Vec<kDof, Scalar>::Zero();    // [1] 1 - a of (ii)
  Vec<kDof, Scalar> tau_ext_ = Vec<kDof, Scalar>::Zero();  // [N m] the last estimate
};

}  // namespace tauext

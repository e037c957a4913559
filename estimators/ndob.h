// SPDX-License-Identifier: Apache-2.0
/// @file
/// Nonlinear disturbance observer: the paper (17)-(18) with the sign of (3), and Mohammadi et al.,
/// "Nonlinear disturbance observer design for robotic manipulators", 2013.
///
///     d = z - X qd                                                                     (17)
///     zdot = X B^-1 (tau - C qd - F - g - d)                                           (18)
/// With (3) the error obeys ddot - tau_extdot = -X B^-1 (d - tau_ext) - tau_extdot: its poles are
/// the eigenvalues of X B^-1(q), so they move with the pose. As printed, (17)-(18) carry the
/// opposite sign of (3) and converge to -tau_ext.
///
/// Forward Euler is stable for h < 2 / lambda_max(X B^-1).
#pragma once

#include "estimators/concepts.h"
#include "estimators/ldlt.h"
#include "estimators/sampling.h"

namespace tauext {

/// NDOB over a robot model M.
template <RobotModel M>
class Ndob {
 public:
  static constexpr const char* kName = "ndob";
  static constexpr int kDof = M::kDof;

  struct Parameters {
    /// [N m s/rad] gain of (18), diagonal, positive: larger is faster and noisier; no default fits
    /// every arm
    Vec<kDof> X = Vec<kDof>::Zero();
    Start start = Start::kFirstMeasurement;  ///< z_0 = X qd_0, or 0
    double max_gap = 0.05;                   ///< [s] a longer gap restarts the observer

    /// Section 5.2: X = 2000 diag(0.3, 0.5, 0.3), for wallmobot3.
    static Parameters paper() requires(kDof == 3) { return {.X = {600, 1000, 600}}; }
  };

  /// @throws std::invalid_argument for parameters out of range
  explicit Ndob(const M& model, const Parameters& p) : model_(model), p_(p), sampling_(p.max_gap) {
    require(p.X.minCoeff() > 0, "X of the NDOB must be positive");
  }

  void reset() noexcept {
    sampling_.reset();
    tau_ext_.setZero();
  }

  Estimate<kDof> update(const Measurement<kDof>& y) noexcept {
    Status status = sampling_.accept(y);
    if (status == Status::kBadMeasurement) return {tau_ext_, status};
    if (status == Status::kStarted) {
      start(y);
    } else {
      z_ += sampling_.h() * zdot_;              // over [t_k-1, t_k)
      tau_ext_ = z_ - p_.X.cwiseProduct(y.qd);  // (17)
      if (!within(tau_ext_, kEstimateLimit)) {
        tau_ext_.setZero();
        start(y);
        status = Status::kDiverged;
      }
    }

    const Dynamics<kDof> now = dynamics(model_, y.q, y.qd);
    const Ldlt<kDof> B(now.B);
    if (!B.ok()) {
      sampling_.reset();
      return {tau_ext_, Status::kSingularInertia};
    }
    const Vec<kDof> residual = y.tau - now.bias - model_.friction(y.qd) - tau_ext_;
    zdot_ = p_.X.cwiseProduct(B.solve(residual));  // (18)
    return {tau_ext_, status};
  }

 private:
  void start(const Measurement<kDof>& y) noexcept {
    if (p_.start == Start::kZero) tau_ext_ = -p_.X.cwiseProduct(y.qd);
    z_ = tau_ext_ + p_.X.cwiseProduct(y.qd);
  }

  M model_;
  Parameters p_;
  Sampling sampling_;
  Vec<kDof> z_ = Vec<kDof>::Zero();        // [N m]
  Vec<kDof> zdot_ = Vec<kDof>::Zero();     // [N m/s] over the coming interval
  Vec<kDof> tau_ext_ = Vec<kDof>::Zero();  // [N m] the last estimate
};

}  // namespace tauext

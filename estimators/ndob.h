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
/// Over [t_k-1, t_k) with tau_k-1 held, everything else in (18) is the mean of both ends, d_k too.
/// With d_k from (17) that is one symmetric system for the observer's acceleration a:
///     (B + h X / 2) a = tau_k-1 - (C qd + F + g) - d_k-1 + X (qd_k - qd_k-1) / 2,   z += h X a      (i)
/// It is stable for every h. Forward Euler, as the paper has it, takes (18) at k-1 alone: stable
/// for h < 2 / lambda_max(X B^-1), and off by h/2 B qddd in motion, 0.2 N m rms on wallmobot3 at 1
/// ms.
#pragma once

#include <tuple>

#include "estimators/concepts.h"
#include "estimators/math/each.h"
#include "estimators/math/ldlt.h"
#include "estimators/sampling.h"

namespace tauext {

/// NDOB over a robot model M.
template <RobotModel M>
class Ndob {
 public:
  static constexpr const char* kName = "ndob";
  static constexpr int kDof = M::kDof;
  using Scalar = ScalarOf<M>;  ///< double, or a Pack for several runs at once
  using Model = M;             ///< of the arm
  template <class Other>
  using For = Ndob<Other>;  ///< the same over another model

  struct Parameters {
    /// [N m s/rad] gain of (18), diagonal, positive: larger is faster and noisier; no default fits
    /// every arm
    Vec<kDof, Scalar> X = Vec<kDof, Scalar>::Zero();
    Integration integration = Integration::kSecondOrder;  ///< (i), or (18) at k-1 alone
    Start start = Start::kFirstMeasurement;               ///< z_0 = X qd_0, or 0
    TorqueSampling torque = TorqueSampling::kHeld;        ///< when tau acted
    double max_gap = 0.05;  ///< [s] a longer gap restarts the observer

    static constexpr auto fields() {
      using P = Parameters;
      return std::tuple(Field{"X", &P::X, "N m s/rad", 1e-12, 1e12, "larger is faster and noisier"},
                        integration_field<P>(), start_field<P>(), torque_field<P>(),
                        max_gap_field<P>());
    }

    /// Section 5.2: X = 2000 diag(0.3, 0.5, 0.3), for wallmobot3.
    static Parameters paper() requires(kDof == 3) { return {.X = {600, 1000, 600}}; }

    /// Bandwidth w [rad/s] of every joint that moves alone at q = 0: X = w diag(B(0)). Joints
    /// coupled by B spread about it, and so does every other pose.
    static Parameters for_bandwidth(const M& model, double w) {
      return {.X = w * Mat<kDof, Scalar>(model.inertia(Vec<kDof, Scalar>::Zero())).diagonal()};
    }
  };

  /// @throws std::invalid_argument for parameters out of range
  explicit Ndob(const M& model, const Parameters& p)
      : model_(model),
        p_(check_parameters(p, kName)),
        sampling_(p.max_gap, limits_of(model), p.torque),
        X_(Column::template from<kDof>(p.X)) {}

  void reset() noexcept {
    sampling_.reset();
    tau_ext_.setZero();
  }

  Estimate<kDof, Scalar> update(const Measurement<kDof, Scalar>& y) noexcept {
    Status status = sampling_.accept(y);
    if (!used(status)) return {tau_ext_, status, sampling_.joints()};
    Dynamics<kDof, Scalar> now = dynamics(model_, y.q, y.qd);
    now.bias += model_.friction(y.qd);
    if (status == Status::kStarted) {
      start(y);
    } else if (advance(sampling_.h(), now, y)) {
      tau_ext_ = z_.template to<kDof>() - p_.X.cwiseProduct(y.qd);  // (17)
      if (!within(tau_ext_, kEstimateLimit)) {
        tau_ext_.setZero();
        start(y);
        status = Status::kDiverged;
      }
    } else {
      sampling_.reset();
      return {tau_ext_, Status::kSingularInertia};
    }
    before_ = now;
    qd_ = y.qd;
    return {tau_ext_, status, sampling_.joints()};
  }

  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed
  /// What a run is at: all that changes from sample to sample. See runs/runs.h.
  auto memory() noexcept { return std::tie(sampling_, z_, before_.B, before_.bias, qd_, tau_ext_); }

 private:
  using Column = detail::Column<kDof, Scalar>;

  [[gnu::always_inline]] bool advance(const Scalar& h, const Dynamics<kDof, Scalar>& now,
                                      const Measurement<kDof, Scalar>& y) noexcept {
    const Vec<kDof, Scalar> tau = sampling_.torque(y);
    if (p_.integration == Integration::kEuler) {
      return advance(h, before_.B, tau - before_.bias - tau_ext_);
    }
    Mat<kDof, Scalar> B;  // of (i), its lower triangle, element by element: see lanes.h
#pragma GCC unroll 8
    for (int j = 0; j < kDof; ++j) {
#pragma GCC unroll 8
      for (int i = j; i < kDof; ++i) B(i, j) = 0.5 * (before_.B(i, j) + now.B(i, j));
      B(j, j) += 0.5 * h * p_.X[j];
    }
    const Vec<kDof, Scalar> change = p_.X.cwiseProduct(y.qd - qd_);
    return advance(h, B, tau - tau_ext_ - 0.5 * (before_.bias + now.bias - change));
  }

  // false if B is not positive definite
  [[gnu::always_inline]] bool advance(const Scalar& h, const Mat<kDof, Scalar>& B,
                                      const Vec<kDof, Scalar>& b) noexcept {
    const Ldlt<kDof, Scalar> factor(B);
    const Column a = Column::template from<kDof>(factor.solve(b));  // [rad/s^2]
    z_ = z_ + h * X_ * a;                                           // (18)
    return factor.ok();
  }

  void start(const Measurement<kDof, Scalar>& y) noexcept {
    if (p_.start == Start::kZero) tau_ext_ = -p_.X.cwiseProduct(y.qd);
    z_ = Column::template from<kDof>(tau_ext_ + p_.X.cwiseProduct(y.qd));
  }

  M model_;
  Parameters p_;
  Sampling<kDof, Scalar> sampling_;
  Column X_, z_ = Column::zero();  // [N m s/rad], [N m] padded
  // at the last used sample, bias with friction
  Dynamics<kDof, Scalar> before_{Mat<kDof, Scalar>::Zero(), Vec<kDof, Scalar>::Zero()};
  Vec<kDof, Scalar> qd_ = Vec<kDof, Scalar>::Zero();       // [rad/s] there
  Vec<kDof, Scalar> tau_ext_ = Vec<kDof, Scalar>::Zero();  // [N m] the last estimate
};

}  // namespace tauext

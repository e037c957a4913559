// SPDX-License-Identifier: Apache-2.0
/// @file
/// Linear extended state observer: Gao, "Scaling and bandwidth-parameterization based controller
/// tuning", American Control Conference 2003; discretised as by Miklosovic, Radke and Gao,
/// "Discrete implementation and generalization of the extended state observer", American Control
/// Conference 2006 (both known by their formulas in others' code).
///     a = B^-1 (tau - C qd - g - F),   qdd = a - delta,   delta = B^-1 tau_ext               (i)
/// Over [t_k-1, t_k) a is the mean of both ends, with tau_k-1 held (or each end's own tau). A joint
/// is a double integrator with delta as its third state, and q alone is compared with what is
/// measured: qd is read in C and F, and at the start, so its noise hardly matters.
///     q += h qd + h^2/2 (a - delta),   qd += h (a - delta),   e = q_k - q
///     q += (1 - b^3) e,   qd += 3/2 (1 - b)^2 (1 + b) e / h,   delta -= (1 - b)^3 e / h^2     (ii)
/// which puts all three poles at b = e^(-w h), whatever the step: delta follows a load as
/// w^3 / (s + w)^3. tau_ext = B(q_k) delta; and it is tau_ext that lasts while the arm moves on,
/// not delta, so before (ii)
///     delta = B(q_k)^-1 B(q_k-1) delta                                                      (iii)
#pragma once

#include <cmath>
#include <tuple>

#include "estimators/concepts.h"
#include "estimators/math/ldlt.h"
#include "estimators/sampling.h"

namespace tauext {

/// Extended state observer over a robot model M.
template <RobotModel M>
class ExtendedStateObserver {
 public:
  static constexpr const char* kName = "eso";
  static constexpr int kDof = M::kDof;
  using Scalar = ScalarOf<M>;  ///< double, or a Pack for several runs at once
  using Model = M;             ///< of the arm
  template <class Other>
  using For = ExtendedStateObserver<Other>;  ///< the same over another model

  /// The same for all joints: they move alike.
  struct Parameters {
    Scalar w = 60;  ///< [rad/s] of the three poles; larger is faster, and noisier by its square
    TorqueSampling torque = TorqueSampling::kHeld;  ///< when tau acted
    double max_gap = 0.05;                          ///< [s] a longer gap restarts the observer

    static constexpr auto fields() {
      using P = Parameters;
      return std::tuple(Field{"w", &P::w, "rad/s", kLeastBandwidth, kMostBandwidth,
                              "of its three poles; larger is faster, noisier"},
                        torque_field<P>(), max_gap_field<P>());
    }

    /// -3 dB at w [rad/s] on every joint, in every pose: three poles of 1.96 w.
    static Parameters for_bandwidth(const M&, double w) {
      Parameters p;
      p.w = w / std::sqrt(std::cbrt(2.) - 1);
      return p;
    }
  };

  /// @throws std::invalid_argument for parameters out of range
  explicit ExtendedStateObserver(const M& model, const Parameters& p = {})
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
    const Dynamics<kDof, Scalar>& now = dynamics(model_, y.q, y.qd);
    const Ldlt<kDof, Scalar> B(now.B);
    if (!B.ok()) {
      sampling_.reset();
      return {tau_ext_, Status::kSingularInertia};
    }
    const Scalar h = sampling_.h();
    const Vec<kDof, Scalar> tau = sampling_.torque_before();
    // with the torque of the last sample as this one has judged it
    const Vec<kDof, Scalar> a = Ldlt<kDof, Scalar>(B_).solve(Vec<kDof, Scalar>(tau - rest_));
    B_ = now.B;
    rest_ = now.bias + model_.friction(y.qd);
    delta_ = B.solve(tau_ext_);  // (iii)
    if (status == Status::kStarted) {
      q_ = y.q, qd_ = y.qd;
      return {tau_ext_, status, sampling_.joints()};
    }
    const Vec<kDof, Scalar> a_end =
        B.solve(Vec<kDof, Scalar>((p_.torque == TorqueSampling::kHeld ? tau : y.tau) - rest_));
    if (sampling_.wrapped()) q_ += sampling_.turns();
    follow(h, 0.5 * (a + a_end), y.q);
    tau_ext_ = now.B * delta_;
    if (!(finite(q_) && finite(qd_) && within(tau_ext_, kEstimateLimit))) {
      tau_ext_.setZero(), delta_.setZero();
      q_ = y.q, qd_ = y.qd;
      status = Status::kDiverged;
    }
    return {tau_ext_, status, sampling_.joints()};
  }

  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed
  /// What a run is at: all that changes from sample to sample. See runs/runs.h.
  auto memory() noexcept {
    return std::tie(sampling_, new_step_, gain_q_, gain_qd_, gain_delta_, B_, rest_, q_, qd_,
                    delta_, tau_ext_);
  }

 private:
  // (ii)
  [[gnu::always_inline]] void follow(const Scalar& h, const Vec<kDof, Scalar>& a,
                                     const Vec<kDof, Scalar>& q) noexcept {
    const Vec<kDof, Scalar> dv = h * (a - delta_);
    q_ += h * qd_ + 0.5 * h * dv;
    qd_ += dv;
    if (new_step_(h)) {
      using std::expm1;
      const Scalar c = -expm1(Scalar(-p_.w * h)), b = Scalar(1) - c;
      gain_q_ = Scalar(1) - b * b * b;
      gain_qd_ = 1.5 * c * c * (Scalar(1) + b) / h;
      gain_delta_ = c * c * c / (h * h);
    }
    const Vec<kDof, Scalar> e = q - q_;
    q_ += gain_q_ * e;
    qd_ += gain_qd_ * e;
    delta_ -= gain_delta_ * e;
  }

  M model_;
  Parameters p_;
  Sampling<kDof, Scalar> sampling_;
  StepChange<Scalar> new_step_;
  Scalar gain_q_ = 0, gain_qd_ = 0, gain_delta_ = 0;           // of (ii)
  Mat<kDof, Scalar> B_ = Mat<kDof, Scalar>::Identity();        // [kg m^2] at the last sample
  Vec<kDof, Scalar> rest_ = Vec<kDof, Scalar>::Zero();         // [N m] C qd + g + F there
  Vec<kDof, Scalar> q_ = Vec<kDof, Scalar>::Zero(), qd_ = q_;  // [rad], [rad/s]
  Vec<kDof, Scalar> delta_ = Vec<kDof, Scalar>::Zero();        // [rad/s^2]
  Vec<kDof, Scalar> tau_ext_ = Vec<kDof, Scalar>::Zero();      // [N m] the last estimate
};

}  // namespace tauext

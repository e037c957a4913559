// SPDX-License-Identifier: Apache-2.0
/// @file
/// Active observer in its lumped form, after the extended active observer of Chan, Naghdy and
/// Stirling, "Extended active observer for force estimation and disturbance rejection of robotic
/// manipulators", Robotics and Autonomous Systems 2013, and the active observer of Cortesao. We
/// could not read the source, so what follows is ours: a computed torque makes the joints double
/// integrators, and one extra ("active") state of a Kalman filter takes up what is left. Whether
/// theirs weighs it alike is open.
///     a = B^-1 (tau - C qd - g - F),   qdd = a - delta,   delta = B^-1 tau_ext                 (i)
/// Over [t_k-1, t_k) a is the mean of both ends, with tau_k-1 held (or each end's own tau). Every
/// joint is the same linear system x = [q; qd; delta], so one 3 x 3 covariance serves them all, and
/// the gains do not depend on data.
///     deltadot = white noise of density Q_delta, qdd carries white noise of density Q_qdd
///
/// Exact over a step h (Van Loan), with P in scalars:
///     q += h qd + h^2/2 (a - delta),   qd += h (a - delta)
///     P' = Phi P Phi^T + Q,   Phi = [1 h -h^2/2; 0 1 -h; 0 0 1]                            (ii)
///     Q = Q_delta [h^5/20 h^4/8 -h^3/6; . h^3/3 -h^2/2; . . h] + Q_qdd [h^3/3 h^2/2 0; . h 0; . . 0]
/// then q and qd are measured in turn, with noise of R_q / h and R_qd / h:
///     s = P_ii + R_i / h,   c = P e_i,   x += c (y_i - x_i) / s,   P -= (c c^T) / s         (iii)
/// Densities make the answer independent of the sampling time. tau_ext = B(q_k) delta; and it is
/// tau_ext that lasts while the arm moves on, not delta, so before (ii)
///     delta = B(q_k)^-1 B(q_k-1) delta                                                      (iv)
#pragma once

#include <cstdint>
#include <tuple>

#include "estimators/concepts.h"
#include "estimators/math/ldlt.h"
#include "estimators/samples/gate.h"
#include "estimators/sampling.h"

namespace tauext {

/// Active observer over a robot model M.
template <RobotModel M>
class ActiveObserver {
 public:
  static constexpr const char* kName = "aob";
  static constexpr int kDof = M::kDof;
  using Scalar = ScalarOf<M>;  ///< double, or a Pack for several runs at once
  using Model = M;             ///< of the arm
  template <class Other>
  using For = ActiveObserver<Other>;  ///< the same over another model

  /// The same for all joints: they move alike.
  struct Parameters {
    Scalar Q_delta =
        1e-3;  ///< [(rad/s^2)^2/s] density of deltadot, positive: larger is faster, noisier
    Scalar Q_qdd =
        1e-7;  ///< [(rad/s^2)^2 s] density of the model's error, at least 0; larger: slower
    Scalar R_q = 1e-13;  ///< [rad^2 s] density of the noise of q, positive; 1e-5 rad at 1 ms
    Scalar R_qd = 1e-9;  ///< [(rad/s)^2 s] density of the noise of qd, positive; 1e-3 rad/s at 1 ms
    Scalar gate = 100;   ///< [1] standard deviations by which q may jump
    TorqueSampling torque = TorqueSampling::kHeld;  ///< when tau acted
    double max_gap = 0.05;                          ///< [s] a longer gap restarts the observer

    static constexpr auto fields() {
      using P = Parameters;
      return std::tuple(
          Field{"Q_delta", &P::Q_delta, "(rad/s^2)^2/s", 1e-30, 1e20, "larger is faster, noisier"},
          Field{"Q_qdd", &P::Q_qdd, "(rad/s^2)^2 s", 0, 1e20,
                "the model's error; larger is slower"},
          Field{"R_q", &P::R_q, "rad^2 s", 1e-30, 1e6, "the noise of q; larger is slower"},
          Field{"R_qd", &P::R_qd, "(rad/s)^2 s", 1e-30, 1e6, "the noise of qd; larger is slower"},
          gate_field<P>(), torque_field<P>(), max_gap_field<P>());
    }

    /// Bandwidth w [rad/s] on every joint, in every pose: at w the load's share of the velocity's
    /// spectrum, Q_delta / w^2, is as large as the rest; -3 dB at w for each noise alone.
    static Parameters for_bandwidth(const M&, double w) {
      Parameters p;
      p.Q_delta = w * w * (w * w / (1 / p.R_qd + 1 / (w * w * p.R_q)) + p.Q_qdd);
      return p;
    }
  };

  /// @throws std::invalid_argument for parameters out of range
  explicit ActiveObserver(const M& model, const Parameters& p = {})
      : model_(model),
        p_(check_parameters(p, kName)),
        sampling_(p.max_gap, limits_of(model), p.torque) {}

  void reset() noexcept {
    sampling_.reset();
    tau_ext_.setZero();
  }

  Estimate<kDof, Scalar> update(const Measurement<kDof, Scalar>& y) noexcept {
    Status status = sampling_.accept(y);
    if (!used(status)) return {tau_ext_, status, sampling_.joints()};
    const Dynamics<kDof, Scalar> now = dynamics(model_, y.q, y.qd);  // put_right() asks, too
    const Ldlt<kDof, Scalar> B(now.B);
    if (!B.ok()) {
      sampling_.reset();
      return {tau_ext_, Status::kSingularInertia};
    }
    const Vec<kDof, Scalar> rest = now.bias + model_.friction(y.qd);
    if (status == Status::kStarted) {
      start(y, B);
    } else {
      const Vec<kDof, Scalar> tau = sampling_.torque_before();
      if (sampling_.joints() != 0) [[unlikely]]
        put_right(tau);
      const Vec<kDof, Scalar> a_end =
          B.solve(Vec<kDof, Scalar>((p_.torque == TorqueSampling::kHeld ? tau : y.tau) - rest));
      delta_ = B.solve(tau_ext_);                  // (iv)
      predict(sampling_.h(), 0.5 * (a_ + a_end));  // (i)
      nu_q_ += sampling_.h() * nu_qd_;
      status = sampling_.confirm(unlikely(sampling_.h(), y));
      if (status == Status::kOk) correct(sampling_.h(), y);
      if (status == Status::kOk) tau_ext_ = now.B * delta_;
      if (!(finite(q_) && finite(qd_) && within(tau_ext_, kEstimateLimit))) {
        tau_ext_.setZero();
        start(y, B);
        status = Status::kDiverged;
      }
    }
    a_ = B.solve(Vec<kDof, Scalar>(y.tau - rest));
    return {tau_ext_, status, sampling_.joints()};
  }

  /// P [rad^2 ... (rad/s^2)^2] of [q; qd; delta] of every joint after the last sample.
  Mat<3> covariance() const noexcept {
    Mat<3> P;
    P << qq_, vq_, dq_, vq_, vv_, dv_, dq_, dv_, dd_;
    return P;
  }

  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed
  /// What a run is at: all that changes from sample to sample. See runs/runs.h.
  auto memory() noexcept {
    return std::tie(sampling_, q_, qd_, delta_, nu_q_, nu_qd_, qq_, vq_, dq_, vv_, dv_, dd_, a_,
                    tau_ext_);
  }

 private:
  // P0 is what a few steps of noise give: R at 1 ms, and a delta within what w lets through
  void start(const Measurement<kDof, Scalar>& y, const Ldlt<kDof, Scalar>& B) noexcept {
    q_ = y.q;
    qd_ = y.qd;
    delta_ = B.solve(tau_ext_);
    nu_q_.setZero();
    nu_qd_.setZero();
    qq_ = 1e3 * p_.R_q, vv_ = 1e3 * p_.R_qd, dd_ = 0.01 * p_.Q_delta;
    vq_ = dq_ = dv_ = 0;
  }

  // a_ anew, since the last sample's tau was an outlier and is now this one [N m]; and q turns with
  // its encoder
  [[gnu::noinline]] void put_right(const Vec<kDof, Scalar>& tau) noexcept {
    const Dynamics<kDof, Scalar>& last = dynamics(model_, q_, qd_);
    const Ldlt<kDof, Scalar> B(last.B);
    if (B.ok()) a_ = B.solve(Vec<kDof, Scalar>(tau - last.bias - model_.friction(qd_)));
    if (sampling_.wrapped()) q_ += sampling_.turns();
  }

  // (ii)
  [[gnu::always_inline]] void predict(const Scalar& h, const Vec<kDof, Scalar>& a) noexcept {
    const Vec<kDof, Scalar> dv = h * (a - delta_);
    q_ += h * qd_ + 0.5 * h * dv;
    qd_ += dv;

    const Scalar h2 = 0.5 * h * h;
    const Scalar Pqq = qq_ + h * vq_ - h2 * dq_, Pqv = vq_ + h * vv_ - h2 * dv_;  // Phi P
    const Scalar Pqd = dq_ + h * dv_ - h2 * dd_, Pvv = vv_ - h * dv_, Pvd = dv_ - h * dd_;
    const Scalar Q_v = h * p_.Q_qdd, Q_d = h * p_.Q_delta;
    qq_ = Pqq + h * Pqv - h2 * Pqd + h * h * (Q_v / 3 + h * h / 20 * Q_d);
    vq_ = Pqv - h * Pqd + h * (0.5 * Q_v + h * h / 8 * Q_d);
    dq_ = Pqd - h * h / 6 * Q_d;
    vv_ = Pvv - h * Pvd + Q_v + h * h / 3 * Q_d;
    dv_ = Pvd - 0.5 * h * Q_d;
    dd_ += Q_d;
  }

  // of q alone: a blow changes qd at once, and no blow q
  [[gnu::always_inline]] std::uint8_t unlikely(const Scalar& h,
                                               const Measurement<kDof, Scalar>& y) const noexcept {
    return beyond<kDof, Scalar>(p_.gate, y.q - q_, nu_q_,
                                Vec<kDof, Scalar>::Constant(qq_ + p_.R_q / h));
  }

  // (iii)
  [[gnu::always_inline]] void correct(const Scalar& h,
                                      const Measurement<kDof, Scalar>& y) noexcept {
    const Scalar s_q = 1 / (qq_ + p_.R_q / h);
    update(qq_, vq_, dq_, s_q, y.q - q_);
    const Scalar s_qd = 1 / (vv_ + p_.R_qd / h);
    update(vq_, vv_, dv_, s_qd, y.qd - qd_);
    nu_q_ = y.q - q_;
    nu_qd_ = y.qd - qd_;
  }

  [[gnu::always_inline]] void update(Scalar c_q, Scalar c_v, Scalar c_d, const Scalar& s_inverse,
                                     const Vec<kDof, Scalar>& innovation) noexcept {
    const Vec<kDof, Scalar> scaled = s_inverse * innovation;
    q_ += c_q * scaled;
    qd_ += c_v * scaled;
    delta_ += c_d * scaled;
    qq_ -= c_q * c_q * s_inverse;
    vq_ -= c_v * c_q * s_inverse;
    dq_ -= c_d * c_q * s_inverse;
    vv_ -= c_v * c_v * s_inverse;
    dv_ -= c_d * c_v * s_inverse;
    dd_ -= c_d * c_d * s_inverse;
  }

  M model_;
  Parameters p_;
  Sampling<kDof, Scalar> sampling_;
  Vec<kDof, Scalar> q_ = Vec<kDof, Scalar>::Zero();      // [rad]
  Vec<kDof, Scalar> qd_ = Vec<kDof, Scalar>::Zero();     // [rad/s]
  Vec<kDof, Scalar> delta_ = Vec<kDof, Scalar>::Zero();  // [rad/s^2]
  Vec<kDof, Scalar> nu_q_ = Vec<kDof, Scalar>::Zero(),
                    nu_qd_ = nu_q_;  // sample less filter, to be expected
  Scalar qq_ = 0, vq_ = 0, dq_ = 0, vv_ = 0, dv_ = 0, dd_ = 0;  // of P
  Vec<kDof, Scalar> a_ = Vec<kDof, Scalar>::Zero();        // [rad/s^2] of (i) at the last sample
  Vec<kDof, Scalar> tau_ext_ = Vec<kDof, Scalar>::Zero();  // [N m] the last estimate
};

}  // namespace tauext

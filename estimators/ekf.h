// SPDX-License-Identifier: Apache-2.0
/// @file
/// Extended Kalman filter of x = [q; qd; d], d = tau_ext assumed constant: the paper (6)-(16).
///
/// Time update over h from k-1 to k, with qdd and its Jacobians Jq, Jv at the last estimate:
///     q += h qd,  qd += h qdd,  P' = F P F^T + Q,
///     F = I + h [ 0  I  0 ; Jq  Jv  -B^-1 ; 0  0  0 ]                                   (10), (15)
/// and, unless Integration::kEuler asks for (10) as printed, the second-order terms of Taylor's
/// series
///     q += h^2/2 qdd,   qd += h^2/2 (Jq qd + Jv qdd),                                       (i)
/// without which the filter takes h/2 B qddd for a load: 0.14 N m rms on wallmobot3 in motion at 1
/// ms. (10) says that tau_k-1 drives this step; (13) prints tau_k, a sample late:
/// Alignment::kPaper.
///
/// Dry friction, where the model tells it apart, acts like tau, at the measured speeds: within
/// qdd, steep at low speed, it would slow the filter and make steps overshoot.
///
/// H = [I 0] picks states and R is diagonal, so (14) is 2N scalar updates in turn. How P is kept
/// and updated: math/covariance.h.
#pragma once

#include <cmath>
#include <cstdint>
#include <tuple>

#include "estimators/concepts.h"
#include "estimators/ekf_parameters.h"
#include "estimators/math/block.h"
#include "estimators/math/covariance.h"
#include "estimators/samples/gate.h"
#include "estimators/sampling.h"

namespace tauext {

/// The paper's EKF over a robot model M.
template <DifferentiableModel M>
class Ekf {
 public:
  static constexpr const char* kName = "ekf";
  static constexpr int kDof = M::kDof;
  using Scalar = ScalarOf<M>;                ///< double, or a Pack for several runs at once
  using Model = M;                           ///< of the arm
  using VecN = Vec<kDof, Scalar>;            ///< a number of each joint
  using Sample = Measurement<kDof, Scalar>;  ///< of the sensors
  template <class Other>
  using For = Ekf<Other>;                          ///< the same over another model
  using Vec3 = Vec<3 * kDof, Scalar>;              ///< [q; qd; tau_ext]
  using Parameters = EkfParameters<kDof, Scalar>;  ///< what can be set

  /// @throws std::invalid_argument for parameters out of range
  explicit Ekf(const M& model, const Parameters& p)
      : model_(model),
        p_(check_parameters(p, kName)),
        sampling_(p.max_gap, limits_of(model), p.torque) {
    for (int b = 0; b < 3; ++b) Q_[b] = diagonal(p.Q, b);
    start({});
  }

  void reset() noexcept {
    sampling_.reset();
    x_[2] = Column::zero();
  }

  Estimate<kDof, Scalar> update(const Sample& y) noexcept {
    Status status = sampling_.accept(y);
    if (status == Status::kStarted) start(y);
    if (status != Status::kOk) return estimate(status);
    if (sampling_.wrapped()) [[unlikely]]
      x_[0] = x_[0] + padded(sampling_.turns());
    VecN tau = p_.alignment == Alignment::kHeld ? sampling_.torque(y) : y.tau;
    if constexpr (kDry) {
      const VecN dry = model_.dry_friction(y.qd);
      tau -= 0.5 * (dry + dry_);
      dry_ = dry;
    }
    const Scalar steps = p_.Ts > 0 ? sampling_.h() / p_.Ts : 1;
    if (!predict(sampling_.h(), tau, steps)) {
      sampling_.reset();
      return estimate(Status::kSingularInertia);
    }
    nu_q_ += sampling_.h() * nu_qd_;
    status = sampling_.confirm(unlikely(y, 1 / steps));
    if (status == Status::kOk) correct(y, 1 / steps);
    const Column squares = x_[0] * x_[0] + x_[1] * x_[1] + x_[2] * x_[2];
    if (!all(squares.template to<kDof>().sum() <= Scalar(kEstimateLimit * kEstimateLimit))) {
      x_[2] = Column::zero();
      start(y);
      return estimate(Status::kDiverged);
    }
    return estimate(status);
  }

  /// P [rad^2 ... (N m)^2] after the last sample, in the order of x; symmetric.
  Mat<3 * kDof, Scalar> covariance() const noexcept { return P_.matrix(); }
  /// x = [q; qd; tau_ext] after the last sample.
  Vec3 state() const noexcept { return (Vec3() << of(x_[0]), of(x_[1]), of(x_[2])).finished(); }
  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed
  /// What a run is at: all that changes from sample to sample. See runs/runs.h.
  auto memory() noexcept {
    return std::tuple_cat(std::tie(sampling_, x_[0], x_[1], x_[2]), P_.memory(),
                          std::tie(nu_q_, nu_qd_, dry_));
  }

 private:
  static constexpr bool kDry = requires(const M& m, VecN x) { m.dry_friction(x); };
  using Block = detail::Block<kDof, Scalar>;
  using Column = detail::Column<kDof, Scalar>;

  static Column padded(const VecN& v) noexcept { return Column::template from<kDof>(v); }
  static VecN of(const Column& c) noexcept { return c.template to<kDof>(); }

  Estimate<kDof, Scalar> estimate(Status s) const noexcept {
    return {of(x_[2]), s, sampling_.joints()};
  }

  void start(const Sample& y) noexcept {
    const bool zero = p_.start == Start::kZero;
    x_[0] = zero ? Column::zero() : padded(y.q);
    x_[1] = zero ? Column::zero() : padded(y.qd);
    if (zero) x_[2] = Column::zero();
    if constexpr (kDry) dry_ = model_.dry_friction(y.qd);
    P_.start(diagonal(p_.P0, 0), diagonal(p_.P0, 1), diagonal(p_.P0, 2));
    nu_q_ = nu_qd_ = VecN::Zero();
    if (any(p_.Q_load > Scalar(0))) add_load(10, Block::from(model_.inertia(of(x_[0]))));
  }

  // Q_load B B^T, so many times
  [[gnu::noinline]] void add_load(Scalar times, const Block& B) noexcept {
    using std::sqrt;
    Block s = B;
    for (Column& c : s.column) c = Scalar(sqrt(times * p_.Q_load)) * c;
    detail::products<detail::Into::kAdd, 1>({&s}, {&s}, P_.dd());
  }

  // where x leads; B is set if a load needs it
  [[gnu::always_inline]] auto linearise(const VecN& tau, Block& B) const noexcept {
    const VecN q = of(x_[0]), qd = of(x_[1]), u = tau - of(x_[2]);
    if constexpr (requires { model_.motion(q, qd, u, &B); }) {
      return model_.motion(q, qd, u, any(p_.Q_load > Scalar(0)) ? &B : nullptr);
    } else {
      const auto f = model_.forward_dynamics(q, qd, u);
      const Mat<kDof, Scalar> inertia = model_.inertia(q);
      B = Block::from(inertia);
      return detail::LinearMotion<kDof, Scalar>{padded(f.qdd), Block::from(-inertia * f.dqdd_dq),
                                                Block::from(-inertia * f.dqdd_dqd),
                                                Block::from(f.dqdd_dtau_ext), f.ok};
    }
  }

  // predict and correct stay functions of their own: inlined into one, GCC 12 makes them slower
  [[gnu::noinline]] bool predict(Scalar h, const VecN& tau, Scalar Q_scale) noexcept {
    Block B;
    const auto f = linearise(tau, B);
    if (!f.ok) return false;
    const Column qd = x_[1];
    x_[0] = x_[0] + h * qd;  // (10)
    x_[1] = x_[1] + h * f.qdd;
    if (p_.integration == Integration::kSecondOrder) {  // (i)
      Column rate = Column::zero(), jerk = rate;        // of r, of qdd
#pragma GCC unroll 8
      for (int j = 0; j < kDof; ++j)
        rate = rate + qd[j] * f.by_q.column[j] + f.qdd[j] * f.by_qd.column[j];
#pragma GCC unroll 8
      for (int j = 0; j < kDof; ++j) jerk = jerk + rate[j] * f.minus_inverse.column[j];
      x_[0] = x_[0] + 0.5 * h * h * f.qdd;
      x_[1] = x_[1] + 0.5 * h * h * jerk;
    }
    P_.spread(h, f, Q_scale, Q_);
    if (any(p_.Q_load > Scalar(0))) add_load(Q_scale, B);
    return true;
  }

  // of q alone: a blow changes qd at once, and no blow q
  [[gnu::always_inline]] std::uint8_t unlikely(const Sample& y, Scalar R_scale) const noexcept {
    VecN variance;
    for (int j = 0; j < kDof; ++j) variance[j] = P_.qq(j) + R_scale * p_.R[j];
    return beyond<kDof, Scalar>(p_.gate, y.q - of(x_[0]), nu_q_, variance);
  }

  [[gnu::noinline]] void correct(const Sample& y, Scalar R_scale) noexcept {
    P_.learn(x_, y.q, R_scale * p_.R.template head<kDof>(), y.qd,
             R_scale * p_.R.template tail<kDof>());
    nu_q_ = y.q - of(x_[0]);
    nu_qd_ = y.qd - of(x_[1]);
  }

  // block b of a diagonal
  static Block diagonal(const Vec3& d, int b) noexcept {
    return Block::diagonal(d.template segment<kDof>(b * kDof));
  }

  M model_;
  Parameters p_;
  Sampling<kDof, Scalar> sampling_;
  Block Q_[3];                                                      // diagonal blocks of Q
  Column x_[3] = {Column::zero(), Column::zero(), Column::zero()};  // q, qd, d
  detail::Covariance<kDof, Scalar> P_;
  VecN nu_q_ = VecN::Zero(), nu_qd_ = nu_q_;  // sample less filter, to be expected
  VecN dry_ = nu_q_;                          // [N m] dry friction at the last sample
};

}  // namespace tauext

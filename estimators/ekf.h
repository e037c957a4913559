// SPDX-License-Identifier: Apache-2.0
/// @file
/// Extended Kalman filter of x = [q; qd; d], d = tau_ext assumed constant: the paper (6)-(16).
///
/// Time update over h from k-1 to k, with qdd and its Jacobians Jq, Jv at the last estimate:
///     q += h qd,  qd += h qdd,  P' = F P F^T + Q,
///     F = I + h [ 0  I  0 ; Jq  Jv  -B^-1 ; 0  0  0 ]                                   (10), (15)
/// and, unless Integration::kEuler asks for (10) as printed, the second-order terms of Taylor's
/// series
///     q += h^2/2 qdd,   qd += h^2/2 (Jq qd + Jv qdd),                                       (iii)
/// without which the filter takes h/2 B qddd for a load: 0.14 N m rms on wallmobot3 in motion at 1
/// ms. (10) says that tau_k-1 drives this step; (13) prints tau_k, a sample late:
/// Alignment::kPaper. F is the identity but for its middle rows, so with G = h [Jq Jv -B^-1] (N x
/// 3N) and U = P G^T, in blocks U_q, U_v, U_d, these blocks of the symmetric P change:
///     P_qq' = P_qq + h (P_qv + P_vq) + h^2 P_vv
///     P_qv' = P_qv + h P_vv + U_q + h U_v          P_dq' = P_dq + h P_dv
///     P_vv' = P_vv + V + V^T,  V = U_v + G U / 2   P_dv' = P_dv + U_d                       (i)
///
/// Dry friction, where the model tells it apart, acts like tau, at the measured speeds: within
/// qdd, steep at low speed, it would slow the filter and make steps overshoot.
///
/// Measurement update: H = [I 0] picks states and R is diagonal, so (14) is 2N scalar updates, one
/// for each measured state i, in turn and without any inverse:
///     s = P_ii + R_i,   c = P e_i,   x += c (y_i - x_i) / s,   P -= (c c^T) / s             (ii)
/// Of P only the blocks on and below the diagonal are kept: qq, vq, dq, vv, dv, dd. The columns e_i
/// of q lie in these; for those of v the block vq is turned into qv = vq^T.
///
/// (i) and (ii) are symmetric to the last bit (c_i c_j is formed first), which is what keeps a long
/// run alive. The N rows of a block are padded with zeros to whole SIMD registers. Where they do
/// not fit into one, all of q, and then of qd, are learnt from first and taken from P at once: with
/// w = c / sqrt(s), of which the columns so far change the next c, P -= sum of w w^T.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "estimators/concepts.h"
#include "estimators/ekf_parameters.h"
#include "estimators/math/block.h"
#include "estimators/math/learn_block.h"
#include "estimators/samples/gate.h"
#include "estimators/sampling.h"

namespace tauext {

/// The paper's EKF over a robot model M.
template <DifferentiableModel M>
class Ekf {
 public:
  static constexpr const char* kName = "ekf";
  static constexpr int kDof = M::kDof;
  using Vec3 = Vec<3 * kDof>;              ///< [q; qd; tau_ext]
  using Parameters = EkfParameters<kDof>;  ///< what can be set

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

  Estimate<kDof> update(const Measurement<kDof>& y) noexcept {
    Status status = sampling_.accept(y);
    if (!used(status)) return estimate(status);
    if (status == Status::kStarted) {
      start(y);
      return estimate(status);
    }
    if (sampling_.wrapped()) [[unlikely]]
      x_[0] = x_[0] + padded(sampling_.turns());
    Vec<kDof> tau = p_.alignment == Alignment::kHeld ? sampling_.torque(y) : y.tau;
    if constexpr (kDry) {
      const Vec<kDof> dry = model_.dry_friction(y.qd);
      tau -= 0.5 * (dry + dry_);
      dry_ = dry;
    }
    const double steps = p_.Ts > 0 ? sampling_.h() / p_.Ts : 1;
    if (!predict(sampling_.h(), tau, steps)) {
      sampling_.reset();
      return estimate(Status::kSingularInertia);
    }
    nu_q_ += sampling_.h() * nu_qd_;
    status = sampling_.confirm(unlikely(y, 1 / steps));
    if (status == Status::kOk) correct(y, 1 / steps);
    const Column squares = x_[0] * x_[0] + x_[1] * x_[1] + x_[2] * x_[2];
    if (!(squares.template to<kDof>().sum() <= kEstimateLimit * kEstimateLimit)) {
      x_[2] = Column::zero();
      start(y);
      return estimate(Status::kDiverged);
    }
    return estimate(status);
  }

  /// P [rad^2 ... (N m)^2] after the last sample, in the order of x; symmetric.
  Mat<3 * kDof> covariance() const noexcept {
    Mat<3 * kDof> P;
    const Block* const blocks[3][3] = {
        {&qq_, nullptr, nullptr}, {&vq_, &vv_, nullptr}, {&dq_, &dv_, &dd_}};
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c <= r; ++c) {
        const Mat<kDof> b = blocks[r][c]->matrix();
        P.template block<kDof, kDof>(r * kDof, c * kDof) = b;
        P.template block<kDof, kDof>(c * kDof, r * kDof) = b.transpose();
      }
    }
    return P;
  }

  /// x = [q; qd; tau_ext] after the last sample.
  Vec3 state() const noexcept { return (Vec3() << of(x_[0]), of(x_[1]), of(x_[2])).finished(); }

 private:
  static constexpr bool kBlocked = kDof > 4;  // more than a register
  static constexpr bool kDry = requires(const M& m, Vec<kDof> x) { m.dry_friction(x); };
  using Block = detail::Block<kDof>;
  using Column = detail::Column<kDof>;
  using Into = detail::Into;

  static Column padded(const Vec<kDof>& v) noexcept { return Column::template from<kDof>(v); }
  static Vec<kDof> of(const Column& c) noexcept { return c.template to<kDof>(); }

  Estimate<kDof> estimate(Status s) const noexcept { return {of(x_[2]), s, sampling_.joints()}; }

  void start(const Measurement<kDof>& y) noexcept {
    const bool zero = p_.start == Start::kZero;
    x_[0] = zero ? Column::zero() : padded(y.q);
    x_[1] = zero ? Column::zero() : padded(y.qd);
    if (zero) x_[2] = Column::zero();
    if constexpr (kDry) dry_ = model_.dry_friction(y.qd);
    qq_ = diagonal(p_.P0, 0);
    vv_ = diagonal(p_.P0, 1);
    dd_ = diagonal(p_.P0, 2);
    vq_ = dq_ = dv_ = Block::zero();
    nu_q_.setZero();
    nu_qd_.setZero();
    if (p_.Q_load > 0) add_load(10, Block::from(model_.inertia(of(x_[0]))));
  }

  // Q_load B B^T, so many times
  [[gnu::noinline]] void add_load(double times, const Block& B) noexcept {
    Block s = B;
    for (Column& c : s.column) c = std::sqrt(times * p_.Q_load) * c;
    detail::products<Into::kAdd, 1>({&s}, {&s}, dd_);
  }

  // where x leads; B is set if a load needs it
  [[gnu::always_inline]] auto linearise(const Vec<kDof>& tau, Block& B) const noexcept {
    const Vec<kDof> q = of(x_[0]), qd = of(x_[1]), u = tau - of(x_[2]);
    if constexpr (requires { model_.motion(q, qd, u, &B); }) {
      return model_.motion(q, qd, u, p_.Q_load > 0 ? &B : nullptr);
    } else {
      const auto f = model_.forward_dynamics(q, qd, u);
      const Mat<kDof> inertia = model_.inertia(q);
      B = Block::from(inertia);
      return detail::LinearMotion<kDof>{padded(f.qdd), Block::from(-inertia * f.dqdd_dq),
                                        Block::from(-inertia * f.dqdd_dqd),
                                        Block::from(f.dqdd_dtau_ext), f.ok};
    }
  }

  // predict and correct stay functions of their own: inlined into one, GCC 12 makes them slower
  [[gnu::noinline]] bool predict(double h, const Vec<kDof>& tau, double Q_scale) noexcept {
    Block B;
    const auto f = linearise(tau, B);
    if (!f.ok) return false;
    const Column qd = x_[1];
    x_[0] = x_[0] + h * qd;  // (10)
    x_[1] = x_[1] + h * f.qdd;
    if (p_.integration == Integration::kSecondOrder) {  // (iii)
      Column rate = Column::zero(), jerk = rate;        // of r, of qdd
#pragma GCC unroll 8
      for (int j = 0; j < kDof; ++j)
        rate = rate + qd[j] * f.by_q.column[j] + f.qdd[j] * f.by_qd.column[j];
#pragma GCC unroll 8
      for (int j = 0; j < kDof; ++j) jerk = jerk + rate[j] * f.minus_inverse.column[j];
      x_[0] = x_[0] + 0.5 * h * h * f.qdd;
      x_[1] = x_[1] + 0.5 * h * h * jerk;
    }

    // U^T and G U of (i); G stands without its factor h, transposes are named by their letters
    const Block qv = detail::transposed(vq_);
    const Block Uq = f.template times<0>({&qq_, &vq_}, dq_),
                Uv = f.template times<0>({&qv, &vv_}, dv_),
                Ud = f.template times<2>({&dq_, &dv_}, dd_), dv = detail::transposed(Ud),
                GU = f.template times<2>({&Uq, &Uv}, dv);
    Block V;
    detail::for_each<kBlocked, kDof>([&](int j) __attribute__((always_inline)) {
      V.column[j] = h * Uv.column[j] + 0.5 * h * h * GU.column[j];
    });
    const Block V_t = detail::transposed(V);
    detail::for_each<kBlocked, kDof>([&](int j) __attribute__((always_inline)) {  // (i)
      Column &qq = qq_.column[j], &dq = dq_.column[j], &vq = vq_.column[j], &vv = vv_.column[j];
      qq = qq + h * (qv.column[j] + vq) + h * h * vv + Q_scale * Q_[0].column[j];
      dq = dq + h * dv_.column[j];
      vq = vq + h * (vv + Uq.column[j] + h * Uv.column[j]);
      vv = vv + (V.column[j] + V_t.column[j]) + Q_scale * Q_[1].column[j];
      dv_.column[j] = dv_.column[j] + h * dv.column[j];
      dd_.column[j] = dd_.column[j] + Q_scale * Q_[2].column[j];
    });
    if (p_.Q_load > 0) add_load(Q_scale, B);
    return true;
  }

  // of q alone: a blow changes qd at once, and no blow q
  [[gnu::always_inline]] std::uint8_t unlikely(const Measurement<kDof>& y,
                                               double R_scale) const noexcept {
    Vec<kDof> variance;
    for (int j = 0; j < kDof; ++j) variance[j] = qq_(j, j) + R_scale * p_.R[j];
    return beyond<kDof>(p_.gate, y.q - of(x_[0]), nu_q_, variance);
  }

  [[gnu::noinline]] void correct(const Measurement<kDof>& y, double R_scale) noexcept {
    if constexpr (kBlocked) {
      learn(0, {&qq_, &vq_, &dq_}, y.q, R_scale * p_.R.template head<kDof>());
      const Block qv = detail::transposed(vq_);
      learn(1, {&qv, &vv_, &dv_}, y.qd, R_scale * p_.R.template tail<kDof>());
    } else {
      one_by_one(y.q, y.qd, R_scale);
    }
    nu_q_ = y.q - of(x_[0]);
    nu_qd_ = y.qd - of(x_[1]);
  }

  // (ii) for all of block m of x, whose columns in P these are
  [[gnu::noinline]] void learn(int m, const Block* const (&columns)[3], const Vec<kDof>& y,
                               const Vec<kDof>& R) noexcept {
    Block w[3];
    detail::learn_block<kDof>(m, columns, y, R, x_, w);
    Block* const P[] = {&qq_, &vq_, &vv_, &dq_, &dv_, &dd_};
    for (int a = 0, block = 0; a < 3; ++a) {
      for (int b = 0; b <= a; ++b)
        detail::products<Into::kSubtract, 1>({&w[a]}, {&w[b]}, *P[block++]);
    }
  }

  // by value: what y refers to could, for all that a compiler knows, be these blocks
  [[gnu::always_inline]] void one_by_one(const Vec<kDof> q, const Vec<kDof> qd,
                                         double R_scale) noexcept {
#pragma GCC unroll 8
    for (int i = 0; i < kDof; ++i) {
      const Column c[] = {qq_.column[i], vq_.column[i], dq_.column[i]};
      const double s_inverse = 1 / (c[0][i] + R_scale * p_.R[i]);
      const Column scaled = s_inverse * c[1];
      update(c, s_inverse, q[i] - x_[0][i]);
      vq_.subtract(scaled, c[0]);
    }
    Block qv = detail::transposed(vq_);
#pragma GCC unroll 8
    for (int i = 0; i < kDof; ++i) {
      const Column c[] = {qv.column[i], vv_.column[i], dv_.column[i]};
      const double s_inverse = 1 / (c[1][i] + R_scale * p_.R[kDof + i]);
      const Column scaled = s_inverse * c[0];
      update(c, s_inverse, qd[i] - x_[1][i]);
      qv.subtract(scaled, c[1]);
    }
    vq_ = detail::transposed(qv);
  }

  // (ii), all but the block between q and qd
  [[gnu::always_inline]] void update(const Column (&c)[3], double s_inverse,
                                     double innovation) noexcept {
    for (int b = 0; b < 3; ++b) x_[b] = x_[b] + (s_inverse * innovation) * c[b];
    const Column scaled = s_inverse * c[2];
    qq_.subtract_square(c[0], s_inverse);
    vv_.subtract_square(c[1], s_inverse);
    dq_.subtract(scaled, c[0]);
    dv_.subtract(scaled, c[1]);
    dd_.subtract_square(c[2], s_inverse);
  }

  // block b of a diagonal
  static Block diagonal(const Vec3& d, int b) noexcept {
    return Block::diagonal(d.template segment<kDof>(b * kDof));
  }

  M model_;
  Parameters p_;
  Sampling<kDof> sampling_;
  Block Q_[3];                                                      // diagonal blocks of Q
  Column x_[3] = {Column::zero(), Column::zero(), Column::zero()};  // q, qd, d
  Block qq_, vq_, dq_, vv_, dv_, dd_;                               // of P
  Vec<kDof> nu_q_ = Vec<kDof>::Zero(), nu_qd_ = nu_q_;  // sample less filter, to be expected
  Vec<kDof> dry_ = nu_q_;                               // [N m] dry friction at the last sample
};

}  // namespace tauext

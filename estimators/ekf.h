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
/// H = [I 0] picks states and R is diagonal, so (14) is 2N scalar updates in turn, of each state i:
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
#include <type_traits>

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
  Mat<3 * kDof, Scalar> covariance() const noexcept {
    Mat<3 * kDof, Scalar> P;
    P << qq_.matrix(), vq_.matrix().transpose(), dq_.matrix().transpose(),  //
        vq_.matrix(), vv_.matrix(), dv_.matrix().transpose(), dq_.matrix(), dv_.matrix(),
        dd_.matrix();
    return P;
  }
  /// x = [q; qd; tau_ext] after the last sample.
  Vec3 state() const noexcept { return (Vec3() << of(x_[0]), of(x_[1]), of(x_[2])).finished(); }
  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed
  /// What a run is at: all that changes from sample to sample. See runs/runs.h.
  auto memory() noexcept {
    return std::tie(sampling_, x_[0], x_[1], x_[2], qq_, vq_, dq_, vv_, dv_, dd_, nu_q_, nu_qd_,
                    dry_);
  }

 private:
  static constexpr bool kLarge = kDof > 4;  // more than a register
  static constexpr bool kAtOnce = kLarge || !std::is_same_v<Scalar, double>;  // all of q, of qd
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
    qq_ = diagonal(p_.P0, 0);
    vv_ = diagonal(p_.P0, 1);
    dd_ = diagonal(p_.P0, 2);
    vq_ = dq_ = dv_ = Block::zero();
    nu_q_ = nu_qd_ = VecN::Zero();
    if (any(p_.Q_load > Scalar(0))) add_load(10, Block::from(model_.inertia(of(x_[0]))));
  }

  // Q_load B B^T, so many times
  [[gnu::noinline]] void add_load(Scalar times, const Block& B) noexcept {
    using std::sqrt;
    Block s = B;
    for (Column& c : s.column) c = Scalar(sqrt(times * p_.Q_load)) * c;
    detail::products<detail::Into::kAdd, 1>({&s}, {&s}, dd_);
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
    detail::for_each<kLarge, kDof>([&](int j) __attribute__((always_inline)) {
      V.column[j] = h * Uv.column[j] + 0.5 * h * h * GU.column[j];
    });
    const Block V_t = detail::transposed(V);
    detail::for_each<kLarge, kDof>([&](int j) __attribute__((always_inline)) {  // (i)
      Column &qq = qq_.column[j], &dq = dq_.column[j], &vq = vq_.column[j], &vv = vv_.column[j];
      qq = qq + h * (qv.column[j] + vq) + h * h * vv + Q_scale * Q_[0].column[j];
      dq = dq + h * dv_.column[j];
      vq = vq + h * (vv + Uq.column[j] + h * Uv.column[j]);
      vv = vv + (V.column[j] + V_t.column[j]) + Q_scale * Q_[1].column[j];
      dv_.column[j] = dv_.column[j] + h * dv.column[j];
      dd_.column[j] = dd_.column[j] + Q_scale * Q_[2].column[j];
    });
    if (any(p_.Q_load > Scalar(0))) add_load(Q_scale, B);
    return true;
  }

  // of q alone: a blow changes qd at once, and no blow q
  [[gnu::always_inline]] std::uint8_t unlikely(const Sample& y, Scalar R_scale) const noexcept {
    VecN variance;
    for (int j = 0; j < kDof; ++j) variance[j] = qq_(j, j) + R_scale * p_.R[j];
    return beyond<kDof, Scalar>(p_.gate, y.q - of(x_[0]), nu_q_, variance);
  }

  [[gnu::noinline]] void correct(const Sample& y, Scalar R_scale) noexcept {
    if constexpr (kAtOnce) {
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
  [[gnu::always_inline]] void learn(int m, const Block* const (&columns)[3], const VecN& y,
                                    const VecN& R) noexcept {
    const auto here = [&](int block) __attribute__((always_inline)) {
      Block w[3];
      detail::learn_block<kDof>(block, columns, y, R, x_, w);
      Block* const P[] = {&qq_, &vq_, &vv_, &dq_, &dv_, &dd_};
      detail::for_each<kLarge, 6>([&](int k) __attribute__((always_inline)) {
        constexpr int kRow[] = {0, 1, 1, 2, 2, 2}, kColumn[] = {0, 0, 1, 0, 1, 2};
        detail::products<detail::Into::kSubtract, 1>({&w[kRow[k]]}, {&w[kColumn[k]]}, *P[k]);
      });
    };
    if constexpr (kLarge) return detail::call_apart(here, m);  // in code that stands once
    here(m);
  }

  // by value: what y refers to could, for all that a compiler knows, be these blocks
  [[gnu::always_inline]] void one_by_one(const VecN q, const VecN qd, Scalar R_scale) noexcept {
#pragma GCC unroll 8
    for (int i = 0; i < kDof; ++i) {
      const Column c[] = {qq_.column[i], vq_.column[i], dq_.column[i]};
      const Scalar s_inverse = 1 / (c[0][i] + R_scale * p_.R[i]);
      const Column scaled = s_inverse * c[1];
      update(c, s_inverse, q[i] - x_[0][i]);
      vq_.subtract(scaled, c[0]);
    }
    Block qv = detail::transposed(vq_);
#pragma GCC unroll 8
    for (int i = 0; i < kDof; ++i) {
      const Column c[] = {qv.column[i], vv_.column[i], dv_.column[i]};
      const Scalar s_inverse = 1 / (c[1][i] + R_scale * p_.R[kDof + i]);
      const Column scaled = s_inverse * c[0];
      update(c, s_inverse, qd[i] - x_[1][i]);
      qv.subtract(scaled, c[1]);
    }
    vq_ = detail::transposed(qv);
  }

  // (ii), all but the block between q and qd
  [[gnu::always_inline]] void update(const Column (&c)[3], Scalar s_inverse,
                                     Scalar innovation) noexcept {
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
  Sampling<kDof, Scalar> sampling_;
  Block Q_[3];                                                      // diagonal blocks of Q
  Column x_[3] = {Column::zero(), Column::zero(), Column::zero()};  // q, qd, d
  Block qq_, vq_, dq_, vv_, dv_, dd_;                               // of P
  VecN nu_q_ = VecN::Zero(), nu_qd_ = nu_q_;  // sample less filter, to be expected
  VecN dry_ = nu_q_;                          // [N m] dry friction at the last sample
};

}  // namespace tauext

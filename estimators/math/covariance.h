// SPDX-License-Identifier: Apache-2.0
/// @file
/// Covariance of the EKF's x = [q; qd; d], in blocks of N. Of P only those on and below the
/// diagonal are kept: qq, vq, dq, vv, dv, dd.
///
/// Over h, P' = F P F^T + Q with F = I + h [0 I 0; G; 0 0 0], G = [Jq Jv -B^-1] (N x 3N). With
/// U = P G^T, in blocks U_q, U_v, U_d, these change; Q, diagonal, is added to qq, vv and dd:
///     P_qq' = P_qq + h (P_qv + P_vq) + h^2 P_vv
///     P_qv' = P_qv + h (P_vv + U_q + h U_v)          P_dq' = P_dq + h P_dv
///     P_vv' = P_vv + V + V^T,  V = h U_v + h^2 G U / 2   P_dv' = P_dv + h U_d               (i)
/// A reading y_i of state i, with noise of variance R_i, changes x and P:
///     s = P_ii + R_i,   c = P e_i,   x += c (y_i - x_i) / s,   P -= (c c^T) / s             (ii)
/// The columns e_i of q lie in the blocks; for those of v the block vq is turned into qv = vq^T.
///
/// (i) and (ii) are symmetric to the last bit (one by one, c_i c_j is formed first), which is what
/// keeps a long run alive. The N rows of a block of doubles are padded with zeros to whole SIMD
/// registers. If they need more than one, P changes once for all of q, then once for all of qd:
/// learn_block.h. For several runs each number is a register, and of a symmetric block only one
/// half is computed.
#pragma once

#include <tuple>
#include <type_traits>

#include "estimators/math/block.h"
#include "estimators/math/learn_block.h"

namespace tauext::detail {

/// P, of a run or, with a Pack, of several.
template <int N, class Scalar = double>
class Covariance {
 public:
  using Block = detail::Block<N, Scalar>;    ///< of two of q, v, d
  using Column = detail::Column<N, Scalar>;  ///< a number of each joint
  using VecN = Vec<N, Scalar>;               ///< the same

  /// P becomes diagonal, of these blocks.
  void start(const Block& q, const Block& v, const Block& d) noexcept {
    qq_ = q, vv_ = v, dd_ = d;
    vq_ = dq_ = dv_ = Block::zero();
  }
  Block& dd() noexcept { return dd_; }                   ///< of d [(N m)^2]
  Scalar qq(int j) const noexcept { return qq_(j, j); }  ///< variance of q_j [rad^2]
  /// All of P, symmetric.
  Mat<3 * N, Scalar> matrix() const noexcept {
    Mat<3 * N, Scalar> P;
    P << qq_.matrix(), vq_.matrix().transpose(), dq_.matrix().transpose(),  //
        vq_.matrix(), vv_.matrix(), dv_.matrix().transpose(), dq_.matrix(), dv_.matrix(),
        dd_.matrix();
    return P;
  }
  /// Its blocks.
  auto memory() noexcept { return std::tie(qq_, vq_, dq_, vv_, dv_, dd_); }

  /// (i) over h [s], with `scale` times the noise Q, whose blocks are diagonal.
  [[gnu::always_inline]] void spread(const Scalar& h, const LinearMotion<N, Scalar>& f,
                                     const Scalar& scale, const Block (&Q)[3]) noexcept {
    // the transposes of U_q, U_v, U_d, and G U
    const Block qv = transposed(vq_);
    const Block Uq = f.template times<0>({&qq_, &vq_}, dq_),
                Uv = f.template times<0>({&qv, &vv_}, dv_),
                Ud = f.template times<2>({&dq_, &dv_}, dd_), U_d = transposed(Ud),
                GU = f.template times<2>({&Uq, &Uv}, U_d);
    if constexpr (kSeveral) {
      grow(
          qq_, scale, Q[0], [&](int i, int j) __attribute__((always_inline)) {
            return h * (qv(i, j) + vq_(i, j)) + h * h * vv_(i, j);
          });
      for_each<kLarge, N>([&](int j) __attribute__((always_inline)) {
        below(j, h, Uq, Uv, U_d);
        dd_.column[j].set(j, dd_(j, j) + scale * Q[2](j, j));
      });
      grow(
          vv_, scale, Q[1], [&](int i, int j) __attribute__((always_inline)) {
            return h * (Uv(i, j) + Uv(j, i)) + h * h * GU(i, j);  // G U is symmetric
          });
    } else {
      Block V;
      for_each<kLarge, N>([&](int j) __attribute__((always_inline)) {
        V.column[j] = h * Uv.column[j] + 0.5 * h * h * GU.column[j];
      });
      const Block V_t = transposed(V);
      for_each<kLarge, N>([&](int j) __attribute__((always_inline)) {
        Column &qq = qq_.column[j], &vv = vv_.column[j], &dd = dd_.column[j];
        qq = qq + h * (qv.column[j] + vq_.column[j]) + h * h * vv + scale * Q[0].column[j];
        below(j, h, Uq, Uv, U_d);
        vv = vv + (V.column[j] + V_t.column[j]) + scale * Q[1].column[j];
        dd = dd + scale * Q[2].column[j];
      });
    }
  }

  /// (ii): x, in its blocks, learns of all q, then of all qd.
  [[gnu::always_inline]] void learn(Column (&x)[3], const VecN& q, const VecN& R_q, const VecN& qd,
                                    const VecN& R_qd) noexcept {
    if constexpr (kSeveral) {
      Block* const P[3][3] = {{&qq_}, {&vq_, &vv_}, {&dq_, &dv_, &dd_}};
      LearntBlock<N, Scalar> of_q(0, P, q, R_q, x[0]);
      of_q.teach(0, x[0]);
      of_q.teach(1, x[1]);
      // before the rest learns of q, which then need not wait for divisions
      LearntBlock<N, Scalar> of_qd(1, P, qd, R_qd, x[1]);
      of_q.teach(2, x[2]);
      of_qd.teach(0, x[0]);
      of_qd.teach(1, x[1]);
      of_qd.teach(2, x[2]);
    } else if constexpr (kLarge) {
      learn_of(0, {&qq_, &vq_, &dq_}, q, R_q, x);
      const Block qv = transposed(vq_);
      learn_of(1, {&qv, &vv_, &dv_}, qd, R_qd, x);
    } else {
      one_by_one(x, q, R_q, qd, R_qd);
    }
  }

 private:
  static constexpr bool kLarge = N > 4;                              // more than a register
  static constexpr bool kSeveral = !std::is_same_v<Scalar, double>;  // runs at once

  // (i) of column j of what lies below the diagonal
  [[gnu::always_inline]] void below(int j, const Scalar& h, const Block& Uq, const Block& Uv,
                                    const Block& U_d) noexcept {
    Column &vq = vq_.column[j], &dq = dq_.column[j], &dv = dv_.column[j];
    dq = dq + h * dv;
    vq = vq + h * (vv_.column[j] + Uq.column[j] + h * Uv.column[j]);
    dv = dv + h * U_d.column[j];
  }

  // a block on the diagonal gets by(i, j), which is symmetric, and noise
  template <class By>
  [[gnu::always_inline]] static void grow(Block& P, const Scalar& scale, const Block& Q,
                                          const By& by) noexcept {
    for_each<kLarge, N>([&](int j) __attribute__((always_inline)) {
      P.column[j].set(j, P(j, j) + by(j, j) + scale * Q(j, j));
#pragma GCC unroll 8
      for (int i = j + 1; i < N; ++i) {
        P.column[j].set(i, P(i, j) + by(i, j));
        P.column[i].set(j, P(i, j));
      }
    });
  }

  // (ii) for all of block m of x, whose columns in P these are
  [[gnu::always_inline]] void learn_of(int m, const Block* const (&columns)[3], const VecN& y,
                                       const VecN& R, Column (&x)[3]) noexcept {
    const auto here = [&](int block) __attribute__((always_inline)) {
      Block w[3];
      learn_block<N>(block, columns, y, R, x, w);
      Block* const P[] = {&qq_, &vq_, &vv_, &dq_, &dv_, &dd_};
      for_each<true, 6>([&](int k) __attribute__((always_inline)) {
        constexpr int kRow[] = {0, 1, 1, 2, 2, 2}, kColumn[] = {0, 0, 1, 0, 1, 2};
        products<Into::kSubtract, 1>({&w[kRow[k]]}, {&w[kColumn[k]]}, *P[k]);
      });
    };
    call_apart(here, m);  // in code that stands once
  }

  // by value: a compiler must assume that references could be to these blocks
  [[gnu::always_inline]] void one_by_one(Column (&x)[3], const VecN q, const VecN R_q,
                                         const VecN qd, const VecN R_qd) noexcept {
#pragma GCC unroll 8
    for (int i = 0; i < N; ++i) {
      const Column c[] = {qq_.column[i], vq_.column[i], dq_.column[i]};
      const Scalar s_inverse = 1 / (c[0][i] + R_q[i]);
      const Column scaled = s_inverse * c[1];
      update(x, c, s_inverse, q[i] - x[0][i]);
      vq_.subtract(scaled, c[0]);
    }
    Block qv = transposed(vq_);
#pragma GCC unroll 8
    for (int i = 0; i < N; ++i) {
      const Column c[] = {qv.column[i], vv_.column[i], dv_.column[i]};
      const Scalar s_inverse = 1 / (c[1][i] + R_qd[i]);
      const Column scaled = s_inverse * c[0];
      update(x, c, s_inverse, qd[i] - x[1][i]);
      qv.subtract(scaled, c[1]);
    }
    vq_ = transposed(qv);
  }

  // (ii), all but the block between q and qd
  [[gnu::always_inline]] void update(Column (&x)[3], const Column (&c)[3], Scalar s_inverse,
                                     Scalar innovation) noexcept {
    for (int b = 0; b < 3; ++b) x[b] = x[b] + (s_inverse * innovation) * c[b];
    const Column scaled = s_inverse * c[2];
    qq_.subtract_square(c[0], s_inverse);
    vv_.subtract_square(c[1], s_inverse);
    dq_.subtract(scaled, c[0]);
    dv_.subtract(scaled, c[1]);
    dd_.subtract_square(c[2], s_inverse);
  }

  Block qq_, vq_, dq_, vv_, dv_, dd_;
};

}  // namespace tauext::detail

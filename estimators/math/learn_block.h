// SPDX-License-Identifier: Apache-2.0
/// @file
/// A Kalman filter's measurement update for N readings at once, of a state in blocks of N: the
/// scalar updates in turn, of which only the columns are formed that the next ones need. No root is
/// on the way from one column to the next. For one run, and for several at once.
#pragma once

#include <cmath>
#include <cstddef>

#include "estimators/math/block.h"

namespace tauext::detail {

/// Block m of the state x is read as y, with noise of variance R [unit^2]. x learns from it.
/// @param columns those of block m in the covariance P, for each block of x
/// @param w columns of each block of x; P - sum of w w^T is the new P
template <int N, std::size_t Blocks>
[[gnu::always_inline]] inline void learn_block(int m, const Block<N>* const (&columns)[Blocks],
                                               const Vec<N>& y, const Vec<N>& R,
                                               Column<N> (&x)[Blocks],
                                               Block<N> (&w)[Blocks]) noexcept {
  Block<N> c[Blocks];  // the columns, less what the readings before theirs take
  double r[N];         // 1 / s of each reading, [1/unit^2]
  Column<N> column[Blocks];
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) {
#pragma GCC unroll 3
    for (std::size_t b = 0; b < Blocks; ++b) column[b] = columns[b]->column[i];
#pragma GCC unroll 8
    for (int k = 0; k < i; ++k) {
      const double share = c[m](i, k) * r[k];
#pragma GCC unroll 3
      for (std::size_t b = 0; b < Blocks; ++b) column[b] = column[b] - share * c[b].column[k];
    }
    r[i] = 1 / (column[m][i] + R[i]);
    const double learnt = r[i] * (y[i] - x[m][i]), root = std::sqrt(r[i]);
#pragma GCC unroll 3
    for (std::size_t b = 0; b < Blocks; ++b) {
      c[b].column[i] = column[b];
      w[b].column[i] = root * column[b];
      x[b] = x[b] + learnt * column[b];
    }
  }
}

/// The same for several runs, by rows and without a root. Of the blocks of P on its diagonal, the
/// lower half is computed and copied up. teach() wants b = 0, 1, 2 in turn: each needs the columns
/// of those before.
template <int N, class Scalar>
class LearntBlock {
 public:
  /// Those on and below the diagonal.
  using BlocksOfP = Block<N, Scalar>* const (&)[3][3];

  /// Block m of the state is x, and read as y.
  [[gnu::always_inline]] LearntBlock(int m, BlocksOfP P, const Vec<N, Scalar>& y,
                                     const Vec<N, Scalar>& R, const Column<N, Scalar>& x) noexcept
      : m_(m), P_(P) {
    Scalar before = 0;
#pragma GCC unroll 8
    for (int i = 0; i < N; ++i) {
      Scalar c[N], innovation = y[i] - x[i], pivot = (*P[m][m])(i, i) + R[i];
#pragma GCC unroll 8
      for (int k = 0; k < i; ++k) {
        c[k] = reduced((*P[m][m])(i, k), k, c);
        share_[i][k] = c[k] * r_[k];
        innovation = innovation - learnt_[k] * c[k];
        if (k + 1 < i || i % 2 == 0) pivot = pivot - share_[i][k] * c[k];
      }
      // two at a time: division takes long, and each would wait for the one before
      r_[i] = i % 2 == 0 ? 1 / pivot : before / (before * pivot - c[i - 1] * c[i - 1]);
      learnt_[i] = r_[i] * innovation;
      before = pivot;
    }
  }

  /// Block b, which is x, learns from it, and with it row b of P.
  [[gnu::always_inline]] void teach(int b, Column<N, Scalar>& x) noexcept {
    for_each<(N > 4), N>([&](int i) __attribute__((always_inline)) {
      Scalar(&row)[N] = c_[b][i];
      Scalar scaled[N], sum = x[i];
#pragma GCC unroll 8
      for (int k = 0; k < N; ++k) {
        row[k] = reduced(b < m_ ? (*P_[m_][b])(k, i) : (*P_[b][m_])(i, k), k, row);
        sum = sum + learnt_[k] * row[k];
        scaled[k] = r_[k] * row[k];
      }
      x.set(i, sum);
#pragma GCC unroll 3
      for (int d = 0; d <= b; ++d) {
        const int last = d == b ? i : N - 1;
#pragma GCC unroll 8
        for (int j = 0; j <= last; ++j) {
          Scalar left = (*P_[b][d])(i, j);
#pragma GCC unroll 8
          for (int k = 0; k < N; ++k) left = left - scaled[k] * c_[d][j][k];
          P_[b][d]->column[j].set(i, left);
          if (d == b && j < i) P_[b][b]->column[i].set(j, left);
        }
      }
    });
  }

 private:
  // number k of a row of P, less what the readings before it take
  [[gnu::always_inline]] Scalar reduced(Scalar of_P, int k, const Scalar (&row)[N]) const noexcept {
#pragma GCC unroll 8
    for (int l = 0; l < k; ++l) of_P = of_P - share_[k][l] * row[l];
    return of_P;
  }

  int m_;
  BlocksOfP P_;
  Scalar r_[N], learnt_[N];  // of each reading: 1 / s, and what x gets of its column
  Scalar share_[N][N];       // of column k that column i loses
  Scalar c_[3][N][N];        // the columns so far, by rows
};

}  // namespace tauext::detail

// SPDX-License-Identifier: Apache-2.0
/// @file
/// A Kalman filter's measurement update for N readings at once, of a state in blocks of N: the
/// scalar updates in turn, of which only the columns are formed that the next ones need. No root is
/// on the way from one column to the next.
#pragma once

#include <cmath>
#include <cstddef>

#include "estimators/math/block.h"

namespace tauext::detail {

/// Block m of the state x is read as y, with noise of variance R [unit^2]. x learns from it.
/// @param columns those of block m in the covariance P, for each block of x
/// @param w columns of each block of x; P - sum of w w^T is the new P
template <int N, class Scalar, std::size_t Blocks>
[[gnu::always_inline]] inline void learn_block(int m,
                                               const Block<N, Scalar>* const (&columns)[Blocks],
                                               const Vec<N, Scalar>& y, const Vec<N, Scalar>& R,
                                               Column<N, Scalar> (&x)[Blocks],
                                               Block<N, Scalar> (&w)[Blocks]) noexcept {
  using std::sqrt;
  Block<N, Scalar> c[Blocks];  // the columns, less what the readings before theirs take
  Scalar r[N];                 // what a column is divided by, [1/unit^2]
  Column<N, Scalar> column[Blocks];
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) {
#pragma GCC unroll 3
    for (std::size_t b = 0; b < Blocks; ++b) column[b] = columns[b]->column[i];
#pragma GCC unroll 8
    for (int k = 0; k < i; ++k) {
      const Scalar share = c[m](i, k) * r[k];
#pragma GCC unroll 3
      for (std::size_t b = 0; b < Blocks; ++b) column[b] = column[b] - share * c[b].column[k];
    }
    r[i] = 1 / (column[m][i] + R[i]);
    const Scalar learnt = r[i] * (y[i] - x[m][i]), root = sqrt(r[i]);
#pragma GCC unroll 3
    for (std::size_t b = 0; b < Blocks; ++b) {
      c[b].column[i] = column[b];
      w[b].column[i] = root * column[b];
      x[b] = x[b] + learnt * column[b];
    }
  }
}

}  // namespace tauext::detail

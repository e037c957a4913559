// SPDX-License-Identifier: Apache-2.0
/// @file
/// B = L D L^T of a small symmetric positive definite matrix, unrolled and without square roots: at
/// N = 3 three times as fast as Eigen::LLT, whose loops are made for large matrices.
#pragma once

#include <type_traits>

#include "estimators/math/block.h"
#include "estimators/types.h"

namespace tauext {

/// Factorisation of B; only its lower triangle is read.
template <int N, class Scalar = double>
class Ldlt {
 public:
  static constexpr bool kLanes = N > 4 && std::is_same_v<Scalar, double>;  ///< in whole registers

  /// Factorises B, symmetric and positive definite.
  [[gnu::always_inline]] explicit Ldlt(const Mat<N, Scalar>& B) noexcept {
    Mat<N, Scalar> LD;  // its strictly lower triangle
    for (int j = 0; j < N; ++j) {
      Scalar d = B(j, j);
      for (int k = 0; k < j; ++k) d -= L_[k][j] * LD(j, k);
      ok_ = ok_ && all(d > 0);  // false for NaN
      d_inverse_[j] = Scalar(1) / d;
      for (int i = j + 1; i < N; ++i) {
        Scalar a = B(i, j);
        for (int k = 0; k < j; ++k) a -= LD(i, k) * L_[k][j];
        LD(i, j) = a;
        L_[j][i] = a * d_inverse_[j];
      }
    }
  }

  /// The same of a padded B, whose columns are whole registers.
  [[gnu::always_inline]] explicit Ldlt(const detail::Block<N>& B) noexcept requires(kLanes) {
    using detail::Lanes;
    Lanes c[N][2];
#pragma GCC unroll 8
    for (int j = 0; j < N; ++j) c[j][0] = B.column[j].x[0], c[j][1] = B.column[j].x[1];
#pragma GCC unroll 8
    for (int j = 0; j < N; ++j) {
      const double d = c[j][j / 4][j % 4], inverse = 1 / d;
      ok_ = ok_ && d > 0;
      d_inverse_[j] = inverse;
#pragma GCC unroll 2
      for (int r = j / 4; r < 2; ++r) (c[j][r] * inverse).store(L_[j] + 4 * r);
#pragma GCC unroll 8
      for (int k = j + 1; k < N; ++k) {
        const Lanes share = Lanes(c[j][k / 4][k % 4]) * inverse;
#pragma GCC unroll 2
        for (int r = k / 4; r < 2; ++r) c[k][r] = c[k][r] - c[j][r] * share;
      }
    }
  }

  /// Whether B was positive definite; if not, solve() means nothing.
  bool ok() const noexcept {
    return ok_;
  }

  /// B^-1 b for a vector or a matrix of columns.
  template <int Cols>
  [[gnu::always_inline]] Eigen::Matrix<Scalar, N, Cols> solve(
      Eigen::Matrix<Scalar, N, Cols> b) const noexcept {
    for (int j = 0; j < Cols; ++j) {
      Scalar x[N];  // plain scalars stay in registers
      for (int i = 0; i < N; ++i) x[i] = b(i, j);
      substitute(x);
      for (int i = 0; i < N; ++i) b(i, j) = x[i];
    }
    return b;
  }

  /// -B^-1.
  [[gnu::always_inline]] detail::Block<N, Scalar> minus_inverse() const noexcept {
    if constexpr (kLanes) {
      detail::Block<N, Scalar> out;
      // four columns at a time; as it is symmetric, a row of them is a piece of a column
#pragma GCC unroll 2
      for (int first = 0; first < 8; first += 4) {
        detail::Lanes x[N];
#pragma GCC unroll 8
        for (int i = 0; i < N; ++i) {
          const auto at = [=](int j) { return i == first + j ? -1.0 : 0.0; };
          x[i] = detail::Lanes(at(0), at(1), at(2), at(3));
        }
        substitute(x, first);
#pragma GCC unroll 8
        for (int i = 0; i < N; ++i) out.column[i].x[first / 4] = x[i];
      }
      return out;
    } else {
      Mat<N, Scalar> out;
#pragma GCC unroll 8
      for (int j = 0; j < N; ++j) {
        Scalar x[N];  // column j from row j on: it is symmetric
#pragma GCC unroll 8
        for (int i = j; i < N; ++i) x[i] = i == j ? -1 : 0;
        substitute(x, j, j);
#pragma GCC unroll 8
        for (int i = j; i < N; ++i) out(i, j) = out(j, i) = x[i];
      }
      return detail::Block<N, Scalar>::from(out);
    }
  }

 private:
  // x = B^-1 x from row `least` on, where the rows before the first one are zero
  template <class Row>
  [[gnu::always_inline]] void substitute(Row (&x)[N], int first = 0, int least = 0) const noexcept {
#pragma GCC unroll 8
    for (int i = first; i < N; ++i) {
#pragma GCC unroll 8
      for (int k = first; k < i; ++k) x[i] = x[i] - L_[k][i] * x[k];
    }
#pragma GCC unroll 8
    for (int i = N - 1; i >= least; --i) {
      x[i] = d_inverse_[i] * x[i];
#pragma GCC unroll 8
      for (int k = i + 1; k < N; ++k) x[i] = x[i] - L_[i][k] * x[k];
    }
  }

  Scalar L_[N][detail::kPadded<N, Scalar>];  // by columns, its strictly lower triangle
  Scalar d_inverse_[N];
  bool ok_ = true;
};

}  // namespace tauext

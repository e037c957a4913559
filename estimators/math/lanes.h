// SPDX-License-Identifier: Apache-2.0
/// @file
/// Small matrices padded with zeros to whole SIMD registers. Registers of the compiler's own vector
/// type are filled element by element: a register loaded from memory that was just written in
/// smaller pieces stalls the pipeline, which costs more than the arithmetic of a step.
#pragma once

#include <cstring>

#include "estimators/types.h"

namespace tauext::detail {

/// Four doubles in a register.
typedef double Lanes __attribute__((vector_size(4 * sizeof(double))));

/// Rows of N padded to whole registers; one joint needs none.
template <int N>
inline constexpr int kPadded = N == 1 ? 1 : (N + 3) / 4 * 4;

/// A padded N x N block.
template <int N>
using Block = Mat<kPadded<N>>;

inline void store(double* to, const Lanes& x) noexcept {
  std::memcpy(to, &x, sizeof x);
}

// Lanes go by reference, inlined as all of this is: a vector as a value would warn of its ABI
// wherever a program is built without AVX.

/// Four elements of v from `first` on, with copies of the first one beyond its end; `first` must
/// fold to a constant.
template <int N>
[[gnu::always_inline]] inline void gather(const Vec<N>& v, int first, Lanes& x) noexcept {
  const auto at = [&](int i) { return v[i < N ? i : first]; };
  x = Lanes{at(first), at(first + 1), at(first + 2), at(first + 3)};
}

/// The same with zeros beyond its end.
template <int N>
[[gnu::always_inline]] inline void gather_zeros(const Vec<N>& v, int first, Lanes& x) noexcept {
  gather<N>(v, first, x);
  const Lanes zero = {};
  switch (N - first) {
    case 1:
      x = __builtin_shufflevector(x, zero, 0, 4, 4, 4);
      break;
    case 2:
      x = __builtin_shufflevector(x, zero, 0, 1, 4, 4);
      break;
    case 3:
      x = __builtin_shufflevector(x, zero, 0, 1, 2, 4);
      break;
    default:
      break;
  }
}

/// v with zeros appended.
template <int N>
[[gnu::always_inline]] inline Vec<kPadded<N>> pad_vector(const Vec<N>& v) noexcept {
  if constexpr (kPadded<N> == N) return v;
  Vec<kPadded<N>> p;
  for (int i = 0; i < N; i += 4) {
    Lanes x;
    gather_zeros<N>(v, i, x);
    store(&p[i], x);
  }
  return p;
}

/// m with rows and columns of zeros appended.
template <int N>
[[gnu::always_inline]] inline Block<N> pad_matrix(const Mat<N>& m) noexcept {
  if constexpr (kPadded<N> == N) return m;
  Block<N> b = Block<N>::Zero();
  for (int j = 0; j < N; ++j) b.col(j) = pad_vector<N>(m.col(j));
  return b;
}

[[gnu::always_inline]] inline void load(const double* from, Lanes& x) noexcept {
  std::memcpy(&x, from, sizeof x);
}

/// b^T by tiles of 4 x 4.
template <int Rows>
[[gnu::always_inline]] inline Mat<Rows> transposed(const Mat<Rows>& b) noexcept {
  if constexpr (Rows == 1) return b;
  Mat<Rows> t;
#pragma GCC unroll 2
  for (int i = 0; i < Rows; i += 4) {
#pragma GCC unroll 2
    for (int j = 0; j < Rows; j += 4) {
      Lanes c0, c1, c2, c3;
      load(&b(i, j), c0), load(&b(i, j + 1), c1), load(&b(i, j + 2), c2), load(&b(i, j + 3), c3);
      const Lanes even01 = __builtin_shufflevector(c0, c1, 0, 4, 2, 6);
      const Lanes odd01 = __builtin_shufflevector(c0, c1, 1, 5, 3, 7);
      const Lanes even23 = __builtin_shufflevector(c2, c3, 0, 4, 2, 6);
      const Lanes odd23 = __builtin_shufflevector(c2, c3, 1, 5, 3, 7);
      store(&t(j, i), __builtin_shufflevector(even01, even23, 0, 1, 4, 5));
      store(&t(j, i + 1), __builtin_shufflevector(odd01, odd23, 0, 1, 4, 5));
      store(&t(j, i + 2), __builtin_shufflevector(even01, even23, 2, 3, 6, 7));
      store(&t(j, i + 3), __builtin_shufflevector(odd01, odd23, 2, 3, 6, 7));
    }
  }
  return t;
}

}  // namespace tauext::detail

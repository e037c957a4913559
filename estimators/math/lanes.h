// SPDX-License-Identifier: Apache-2.0
/// @file
/// Small matrices padded with zeros to whole SIMD registers. Registers of the compiler's own vector
/// type are filled element by element: a register loaded from memory that was just written in
/// smaller pieces stalls the pipeline, which costs more than the arithmetic of a step.
#pragma once

#include <cstddef>
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
  if (N - first >= 4) return;
  if constexpr (N > 4) {
    // by bits: of a shuffle with zeros GCC 12 makes a move that valgrind 3.19 does not know
    typedef long long Bits __attribute__((vector_size(sizeof(Lanes))));
    const auto bit = [first](int i) { return first + i < N ? -1LL : 0LL; };
    x = (Lanes)((Bits)x & Bits{bit(0), bit(1), bit(2), bit(3)});
  } else {
    const Lanes zero = {};
    if constexpr (N == 1) x = __builtin_shufflevector(x, zero, 0, 4, 4, 4);
    if constexpr (N == 2) x = __builtin_shufflevector(x, zero, 0, 1, 4, 4);
    if constexpr (N == 3) x = __builtin_shufflevector(x, zero, 0, 1, 2, 4);
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

/// The columns of c from `first` on, so many, plus those of the sum of a_t b_t^T, or less these;
/// over the first K columns of each.
template <int K, bool kMinus, int Columns, int Rows, class B, std::size_t Terms>
[[gnu::always_inline]] inline void add_columns(const Mat<Rows>* const (&a)[Terms],
                                               const B* const (&b)[Terms], int first,
                                               Mat<Rows>& c) noexcept {
  constexpr int kLanes = Rows / 4;
  Lanes sum[Columns][kLanes];
#pragma GCC unroll 4
  for (int j = 0; j < Columns; ++j) {
#pragma GCC unroll 2
    for (int i = 0; i < kLanes; ++i) load(&c(4 * i, first + j), sum[j][i]);
  }
#pragma GCC unroll 1
  for (std::size_t t = 0; t < Terms; ++t) {
#pragma GCC unroll 8
    for (int k = 0; k < K; ++k) {
      Lanes column[kLanes];
#pragma GCC unroll 2
      for (int i = 0; i < kLanes; ++i) load(&(*a[t])(4 * i, k), column[i]);
#pragma GCC unroll 4
      for (int j = 0; j < Columns; ++j) {
        const double x = (*b[t])(first + j, k);
        const Lanes times{x, x, x, x};
#pragma GCC unroll 2
        for (int i = 0; i < kLanes; ++i) {
          if constexpr (kMinus) {
            sum[j][i] -= column[i] * times;
          } else {
            sum[j][i] += column[i] * times;
          }
        }
      }
    }
  }
#pragma GCC unroll 4
  for (int j = 0; j < Columns; ++j) {
#pragma GCC unroll 2
    for (int i = 0; i < kLanes; ++i) store(&c(4 * i, first + j), sum[j][i]);
  }
}

/// c plus the sum of a_t b_t^T, or less that, over the first K columns of each; rows of b beyond K
/// are left out. Four columns of c at a time stay in registers.
template <int K, bool kMinus = false, int Rows, class B, std::size_t Terms>
[[gnu::always_inline]] inline void add_products(const Mat<Rows>* const (&a)[Terms],
                                                const B* const (&b)[Terms], Mat<Rows>& c) noexcept {
  static_assert(K > 4 && K <= 8);
  add_columns<K, kMinus, 4>(a, b, 0, c);
  add_columns<K, kMinus, K - 4>(a, b, 4, c);
}

// one function in each program: less code is faster
template <int N>
[[gnu::noinline]] inline void add_three_products(const Block<N>* const (&A)[3],
                                                 const Mat<N>* const (&G)[3],
                                                 Block<N>& product) noexcept {
  add_products<N>(A, G, product);
}

/// [A0 A1 A2] G^T over the columns that are no padding.
template <int N>
[[gnu::always_inline]] inline Block<N> times_transposed(const Block<N>& A0, const Block<N>& A1,
                                                        const Block<N>& A2,
                                                        const Mat<N>* const (&G)[3]) noexcept {
  using Column = Vec<kPadded<N>>;
  const Block<N>* const A[] = {&A0, &A1, &A2};
  Block<N> product = Block<N>::Zero();
  if constexpr (N > 4) return add_three_products<N>(A, G, product), product;
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) {
    const Column zero = Column::Zero();
    Column sum[3] = {zero, zero, zero};  // short chains of additions
#pragma GCC unroll 3
    for (int b = 0; b < 3; ++b) {
#pragma GCC unroll 8
      for (int j = 0; j < N; ++j) sum[b] += A[b]->col(j) * (*G[b])(i, j);
    }
    product.col(i) = (sum[0] + sum[1]) + sum[2];
  }
  return product;
}

}  // namespace tauext::detail

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Small matrices padded with zeros to whole SIMD registers. Registers of the compiler's own vector
/// type are filled element by element: a register loaded from memory that was just written in
/// smaller pieces stalls the pipeline, which costs more than the arithmetic of a step.
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>

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

/// Calls f(0) to f(N - 1), written out one after the other or in a loop. Written out, it is faster
/// until a step no longer fits into the processor's first cache of instructions, as the EKF of 7
/// joints would not.
template <bool kLoop, int N, class F>
[[gnu::always_inline]] inline void for_each(F&& f) noexcept {
  if constexpr (kLoop) {
#pragma GCC unroll 1
    for (int i = 0; i < N; ++i) f(i);
  } else {
#pragma GCC unroll 4
    for (int i = 0; i < N; ++i) f(i);
  }
}

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
template <int N, class Scalar = double>
[[gnu::always_inline]] inline Vec<kPadded<N>, Scalar> pad_vector(
    const Vec<N, std::type_identity_t<Scalar>>& v) noexcept {
  if constexpr (kPadded<N> == N) return v;
  Vec<kPadded<N>, Scalar> p;
  if constexpr (std::is_same_v<Scalar, double>) {
    for (int i = 0; i < N; i += 4) {
      Lanes x;
      gather_zeros<N>(v, i, x);
      store(&p[i], x);
    }
  } else {
    p.setZero();
    p.template head<N>() = v;
  }
  return p;
}

/// m with rows and columns of zeros appended.
template <int N, class Scalar = double>
[[gnu::always_inline]] inline Mat<kPadded<N>, Scalar> pad_matrix(
    const Mat<N, std::type_identity_t<Scalar>>& m) noexcept {
  if constexpr (kPadded<N> == N) return m;
  Mat<kPadded<N>, Scalar> b;
  for (int j = 0; j < N; ++j) b.col(j) = pad_vector<N, Scalar>(m.col(j));
  b.template rightCols<kPadded<N> - N>().setZero();
  return b;
}

[[gnu::always_inline]] inline void load(const double* from, Lanes& x) noexcept {
  std::memcpy(&x, from, sizeof x);
}

/// Makes the rows of a 4 x 4 matrix of its columns.
[[gnu::always_inline]] inline void turn(Lanes& c0, Lanes& c1, Lanes& c2, Lanes& c3) noexcept {
  const Lanes even01 = __builtin_shufflevector(c0, c1, 0, 4, 2, 6);
  const Lanes odd01 = __builtin_shufflevector(c0, c1, 1, 5, 3, 7);
  const Lanes even23 = __builtin_shufflevector(c2, c3, 0, 4, 2, 6);
  const Lanes odd23 = __builtin_shufflevector(c2, c3, 1, 5, 3, 7);
  c0 = __builtin_shufflevector(even01, even23, 0, 1, 4, 5);
  c1 = __builtin_shufflevector(odd01, odd23, 0, 1, 4, 5);
  c2 = __builtin_shufflevector(even01, even23, 2, 3, 6, 7);
  c3 = __builtin_shufflevector(odd01, odd23, 2, 3, 6, 7);
}

/// b^T, of doubles by tiles of 4 x 4.
template <int Rows, class Scalar>
[[gnu::always_inline]] inline Mat<Rows, Scalar> transposed(const Mat<Rows, Scalar>& b) noexcept {
  Mat<Rows, Scalar> t;
  if constexpr (Rows == 1 || !std::is_same_v<Scalar, double>) {
    t = b.transpose();
    return t;
  } else {
#pragma GCC unroll 2
    for (int i = 0; i < Rows; i += 4) {
#pragma GCC unroll 2
      for (int j = 0; j < Rows; j += 4) {
        Lanes c0, c1, c2, c3;
        load(&b(i, j), c0), load(&b(i, j + 1), c1), load(&b(i, j + 2), c2), load(&b(i, j + 3), c3);
        turn(c0, c1, c2, c3);
        store(&t(j, i), c0), store(&t(j, i + 1), c1), store(&t(j, i + 2), c2);
        store(&t(j, i + 3), c3);
      }
    }
    return t;
  }
}

/// What becomes of a matrix.
enum class Into { kSet, kAdd, kSubtract };

/// The columns of c from `first` on, so many, become the sum of a_t b_t, or get it, or lose it;
/// over the first K columns of each a. The first kTransposed b are given as their transposes.
template <Into kInto, int K, std::size_t kTransposed, int Columns, int Rows, std::size_t Terms>
[[gnu::always_inline]] inline void columns_of_products(const Mat<Rows>* const (&a)[Terms],
                                                       const Mat<Rows>* const (&b)[Terms],
                                                       int first, Mat<Rows>& c) noexcept {
  constexpr int kLanes = Rows / 4;
  Lanes sum[Columns][kLanes];
#pragma GCC unroll 6
  for (int j = 0; j < Columns; ++j) {
#pragma GCC unroll 2
    for (int i = 0; i < kLanes; ++i) {
      if constexpr (kInto == Into::kSet) {
        sum[j][i] = Lanes{};
      } else {
        load(&c(4 * i, first + j), sum[j][i]);
      }
    }
  }
#pragma GCC unroll 3
  for (std::size_t t = 0; t < Terms; ++t) {
    for_each<(Rows > 4), K>([&](int k) __attribute__((always_inline)) {
      Lanes column[kLanes];
#pragma GCC unroll 2
      for (int i = 0; i < kLanes; ++i) load(&(*a[t])(4 * i, k), column[i]);
#pragma GCC unroll 6
      for (int j = 0; j < Columns; ++j) {
        const double x = t < kTransposed ? (*b[t])(first + j, k) : (*b[t])(k, first + j);
        const Lanes times{x, x, x, x};
#pragma GCC unroll 2
        for (int i = 0; i < kLanes; ++i) {
          if constexpr (kInto == Into::kSubtract) {
            sum[j][i] -= column[i] * times;
          } else {
            sum[j][i] += column[i] * times;
          }
        }
      }
    });
  }
#pragma GCC unroll 6
  for (int j = 0; j < Columns; ++j) {
#pragma GCC unroll 2
    for (int i = 0; i < kLanes; ++i) store(&c(4 * i, first + j), sum[j][i]);
  }
}

/// c, of which the columns from K on are zero, becomes the sum of a_t b_t, or gets it, or loses it.
/// The first kTransposed b are given as their transposes. Four columns of c at a time stay in
/// registers.
template <Into kInto, int K, std::size_t kTransposed = 0, int Rows, std::size_t Terms>
[[gnu::always_inline]] inline void products(const Mat<Rows>* const (&a)[Terms],
                                            const Mat<Rows>* const (&b)[Terms],
                                            Mat<Rows>& c) noexcept {
  if constexpr (kInto == Into::kSet) c.template rightCols<Rows - K>().setZero();
  if constexpr (Rows == 1) {
    double sum = 0;
    for (std::size_t t = 0; t < Terms; ++t) sum += (*a[t])(0, 0) * (*b[t])(0, 0);
    c(0, 0) = (kInto == Into::kSet ? 0 : c(0, 0)) + (kInto == Into::kSubtract ? -sum : sum);
  } else if constexpr (K <= 6) {
    columns_of_products<kInto, K, kTransposed, K>(a, b, 0, c);
  } else {
    constexpr int kFirst = (K + 1) / 2;
    columns_of_products<kInto, K, kTransposed, kFirst>(a, b, 0, c);
    columns_of_products<kInto, K, kTransposed, K - kFirst>(a, b, kFirst, c);
  }
}

/// What ForwardDynamics is, with rows and columns of zeros appended.
template <int N, class Scalar = double>
struct PaddedDynamics {
  using Rows = Vec<kPadded<N>, Scalar>;    ///< a number of each joint
  using Square = Mat<kPadded<N>, Scalar>;  ///< over the joints
  Rows qdd;                                ///< [rad/s^2]
  Square by_q;                             ///< [1/s^2] dqdd/dq
  Square by_qd;                            ///< [1/s] dqdd/dqd
  Square by_tau_ext;                       ///< [1/(kg m^2)] dqdd/dtau_ext = -B^-1
  Square B;                                ///< [kg m^2]
  bool ok = false;                         ///< false: B was not positive definite
};

/// f with rows and columns of zeros appended, and B left at zero.
template <int N, class Dynamics>
[[gnu::always_inline]] inline PaddedDynamics<N> pad_dynamics(const Dynamics& f) noexcept {
  return {
      pad_vector<N>(f.qdd),           pad_matrix<N>(f.dqdd_dq),          pad_matrix<N>(f.dqdd_dqd),
      pad_matrix<N>(f.dqdd_dtau_ext), PaddedDynamics<N>::Square::Zero(), f.ok};
}

}  // namespace tauext::detail

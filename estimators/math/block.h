// SPDX-License-Identifier: Apache-2.0
/// @file
/// Small matrices over the joints whose columns are padded with zeros to whole SIMD registers.
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>

#include "estimators/math/each.h"

namespace tauext::detail {

/// A number of each of N joints, with zeros appended.
template <int N, class Scalar = double>
using Column = Each<kPadded<N, Scalar>, Scalar>;

/// N columns of N.
template <int N, class Scalar = double>
struct Block {
  Column<N, Scalar> column[N];  ///< by joint

  /// Of 0.
  [[gnu::always_inline]] static Block zero() noexcept {
    Block b;
#pragma GCC unroll 8
    for (auto& c : b.column) c = Column<N, Scalar>::zero();
    return b;
  }
  /// Of m.
  [[gnu::always_inline]] static Block from(const Mat<N, Scalar>& m) noexcept {
    Block b;
#pragma GCC unroll 8
    for (int j = 0; j < N; ++j) b.column[j] = Column<N, Scalar>::template from<N>(m.col(j));
    return b;
  }
  // column by column: GCC 12 copies an array by halves of registers, which loads then wait for
  Block() noexcept = default;
  [[gnu::always_inline]] Block(const Block& b) noexcept {
    *this = b;
  }
  [[gnu::always_inline]] Block& operator=(const Block& b) noexcept {
    written_out<N>([&](int j) __attribute__((always_inline)) { column[j] = b.column[j]; });
    return *this;
  }

  /// With d on its diagonal, and 0 elsewhere.
  static Block diagonal(const Vec<N, Scalar>& d) noexcept {
    return from(d.asDiagonal().toDenseMatrix());
  }
  /// Its N x N elements.
  [[gnu::always_inline]] Mat<N, Scalar> matrix() const noexcept {
    Mat<N, Scalar> m;
#pragma GCC unroll 8
    for (int j = 0; j < N; ++j) m.col(j) = column[j].template to<N>();
    return m;
  }
  /// Row i, column j; of large blocks from memory, where they are, and not from a register.
  [[gnu::always_inline]] Scalar operator()(int i, int j) const noexcept {
    if constexpr (N > 4 && std::is_same_v<Scalar, double>) {
      double a;
      std::memcpy(
          &a, reinterpret_cast<const char*>(&column[j]) + static_cast<std::size_t>(i) * sizeof a,
          sizeof a);
      return a;
    } else {
      return column[j][i];
    }
  }
  [[gnu::always_inline]] void add(const Block& b) noexcept {  ///< element by element
#pragma GCC unroll 8
    for (int j = 0; j < N; ++j) column[j] = column[j] + b.column[j];
  }
  /// Takes a b^T off.
  [[gnu::always_inline]] void subtract(const Column<N, Scalar>& a,
                                       const Column<N, Scalar>& b) noexcept {
#pragma GCC unroll 8
    for (int j = 0; j < N; ++j) column[j] = column[j] - b[j] * a;
  }
  /// Takes times (c c^T) off, symmetric to the last bit.
  [[gnu::always_inline]] void subtract_square(const Column<N, Scalar>& c,
                                              const Scalar& times) noexcept {
#pragma GCC unroll 8
    for (int j = 0; j < N; ++j) column[j] = column[j] - times * (c[j] * c);
  }
};

/// b^T, of doubles by tiles of 4 x 4.
template <int N, class Scalar>
[[gnu::always_inline]] inline Block<N, Scalar> transposed(const Block<N, Scalar>& b) noexcept {
  Block<N, Scalar> t;
  if constexpr (N == 1) {
    t = b;
  } else if constexpr (std::is_same_v<Scalar, double>) {
    constexpr int kLanes = kPadded<N> / 4;
#pragma GCC unroll 2
    for (int i = 0; i < kLanes; ++i) {
#pragma GCC unroll 2
      for (int j = 0; j < kLanes; ++j) {
        Lanes c[4];
#pragma GCC unroll 4
        for (int k = 0; k < 4; ++k) c[k] = 4 * j + k < N ? b.column[4 * j + k].x[i] : Lanes(0);
        turn(c[0], c[1], c[2], c[3]);
#pragma GCC unroll 4
        for (int k = 0; k < 4; ++k) {
          if (4 * i + k < N) t.column[4 * i + k].x[j] = c[k];
        }
      }
    }
  } else {
#pragma GCC unroll 8
    for (int j = 0; j < N; ++j) {
#pragma GCC unroll 8
      for (int i = 0; i < N; ++i) t.column[j].set(i, b(j, i));
    }
  }
  return t;
}

/// What becomes of a block.
enum class Into { kSet, kAdd, kSubtract };

/// The columns of c from `first` on, so many, become the sum of a_t b_t, or get it, or lose it. The
/// first kTransposed b are given as their transposes.
template <Into kInto, std::size_t kTransposed, int kColumns, int N, class Scalar, std::size_t Terms>
[[gnu::always_inline]] inline void columns_of_products(const Block<N, Scalar>* const (&a)[Terms],
                                                       const Block<N, Scalar>* const (&b)[Terms],
                                                       int first, Block<N, Scalar>& c) noexcept {
  constexpr bool kLoop = N > 4 && std::is_same_v<Scalar, double>;
  constexpr int kCount = Column<N, Scalar>::kCount;
  using Operand = typename Column<N, Scalar>::Operand;
  Operand sum[kColumns][kCount];
#pragma GCC unroll 6
  for (int j = 0; j < kColumns; ++j) {
#pragma GCC unroll 8
    for (int i = 0; i < kCount; ++i)
      sum[j][i] = kInto == Into::kSet ? Operand(0) : c.column[first + j].x[i];
  }
#pragma GCC unroll 3
  for (std::size_t t = 0; t < Terms; ++t) {
    for_each<kLoop, N>([&](int k) __attribute__((always_inline)) {
#pragma GCC unroll 6
      for (int j = 0; j < kColumns; ++j) {
        const Operand times = t < kTransposed ? (*b[t])(first + j, k) : (*b[t])(k, first + j);
#pragma GCC unroll 8
        for (int i = 0; i < kCount; ++i) {
          const Operand product = a[t]->column[k].x[i] * times;
          if (kInto == Into::kSubtract) {
            sum[j][i] = sum[j][i] - product;
          } else if (kInto == Into::kSet && !kLoop && t == 0 && k == 0) {  // else 0 + it is added
            sum[j][i] = product;
          } else {
            sum[j][i] = sum[j][i] + product;
          }
        }
      }
    });
  }
#pragma GCC unroll 6
  for (int j = 0; j < kColumns; ++j) {
#pragma GCC unroll 8
    for (int i = 0; i < kCount; ++i) c.column[first + j].x[i] = sum[j][i];
  }
}

/// c becomes the sum of a_t b_t, or gets it, or loses it. The first kTransposed b are given as
/// their transposes. About as many columns of c at a time as stay in registers.
template <Into kInto, std::size_t kTransposed = 0, int N, class Scalar, std::size_t Terms>
[[gnu::always_inline]] inline void products(const Block<N, Scalar>* const (&a)[Terms],
                                            const Block<N, Scalar>* const (&b)[Terms],
                                            Block<N, Scalar>& c) noexcept {
  constexpr bool kDoubles = std::is_same_v<Scalar, double>;
  constexpr int kAtOnce = kDoubles ? (N <= 6 ? N : (N + 1) / 2) : (N <= 4 ? N : 1);
#pragma GCC unroll 8
  for (int first = 0; first + kAtOnce <= N; first += kAtOnce)
    columns_of_products<kInto, kTransposed, kAtOnce>(a, b, first, c);
  if constexpr (N % kAtOnce > 0)
    columns_of_products<kInto, kTransposed, N % kAtOnce>(a, b, N - N % kAtOnce, c);
}

/// Where (3) leads, in lanes. With r = B qdd + C qd + F + g + tau_ext - tau, which is 0, a model's
/// Jacobians of qdd are -B^-1 times those of r at a qdd that stays the same.
template <int N, class Scalar = double>
struct LinearMotion {
  Column<N, Scalar> qdd;           ///< [rad/s^2]
  Block<N, Scalar> by_q;           ///< [N m/rad] dr/dq
  Block<N, Scalar> by_qd;          ///< [N m s/rad] dr/dqd
  Block<N, Scalar> minus_inverse;  ///< [1/(kg m^2)] -B^-1 = dqdd/dtau_ext
  bool ok = false;                 ///< false: B was not positive definite

  /// How qdd changes with (q; qd; tau_ext) = (b_0; b_1; d), a column for each change:
  /// -B^-1 (dr/dq b_0 + dr/dqd b_1 + d). The first kTransposed b are given as their transposes.
  template <std::size_t kTransposed>
  [[gnu::always_inline]] Block<N, Scalar> times(const Block<N, Scalar>* const (&b)[2],
                                                const Block<N, Scalar>& d) const noexcept {
    if constexpr (N > 4) {  // in code that stands once: it must fit into the first cache
      return apart<kTransposed>(b, d);
    } else {
      return product<kTransposed>(b, d);
    }
  }

 private:
  template <std::size_t kTransposed>
  [[gnu::noinline]] Block<N, Scalar> apart(const Block<N, Scalar>* const (&b)[2],
                                           const Block<N, Scalar>& d) const noexcept {
    return product<kTransposed>(b, d);
  }
  template <std::size_t kTransposed>
  [[gnu::always_inline]] Block<N, Scalar> product(const Block<N, Scalar>* const (&b)[2],
                                                  const Block<N, Scalar>& d) const noexcept {
    Block<N, Scalar> sum = d, out;
    products<Into::kAdd, kTransposed>({&by_q, &by_qd}, b, sum);
    products<Into::kSet>({&minus_inverse}, {&sum}, out);
    return out;
  }
};

}  // namespace tauext::detail

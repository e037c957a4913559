// SPDX-License-Identifier: Apache-2.0
/// @file
/// A number of each body of an arm, side by side: what is written for one body is computed for all
/// of them at once, one body in a SIMD lane.
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>

#include "estimators/math/lanes.h"

namespace tauext::detail {

/// Bodies of a piece: those of a register. Up to 4 bodies, and other scalars than double, are one
/// piece; 5 to 8 are two, computed one after the other where no body needs the other piece.
template <int P, class Scalar>
inline constexpr int kPiece = P > 4 && std::is_same_v<Scalar, double> ? 4 : P;

/// A number of each of P bodies.
template <int P, class Scalar>
struct Each {
  Scalar x[P];  ///< by body

  static Each zero() noexcept { return all(Scalar(0)); }  ///< 0 of each
  static Each all(const Scalar& a) noexcept {             ///< the same of each
    Each e;
    for (Scalar& x : e.x) x = a;
    return e;
  }
  template <int N>
  static Each from(const Vec<N, Scalar>& v) noexcept {  ///< with zeros appended
    Each e = zero();
    for (int i = 0; i < N; ++i) e.x[i] = v[i];
    return e;
  }
  Scalar operator[](int i) const noexcept { return x[i]; }  ///< that of body i
  void set(int i, const Scalar& a) noexcept { x[i] = a; }   ///< that of body i
  const Each& piece(int) const noexcept { return *this; }   ///< the bodies of a piece: here, all
  void put(int, const Each& e) noexcept { *this = e; }      ///< sets the bodies of a piece
  /// The same, or, if that saves work, 0 of the bodies before `first`.
  Each since([[maybe_unused]] int first) const noexcept { return *this; }
  void store(Scalar* to) const noexcept {  ///< as numbers side by side
    for (const Scalar& a : x) *to++ = a;
  }
  /// Adds `times` a, which is 0 but for the bodies `first` to `last`.
  void add(const Each& a, const Scalar& times, int first, int last) noexcept {
    for (int i = first; i <= last; ++i) x[i] += times * a.x[i];
  }
  friend Each operator+(Each a, const Each& b) noexcept {  ///< one by one, as all operators
    for (int i = 0; i < P; ++i) a.x[i] += b.x[i];
    return a;
  }
  friend Each operator-(Each a, const Each& b) noexcept {
    for (int i = 0; i < P; ++i) a.x[i] -= b.x[i];
    return a;
  }
  friend Each operator*(Each a, const Each& b) noexcept {
    for (int i = 0; i < P; ++i) a.x[i] *= b.x[i];
    return a;
  }
};

/// Registers full of them; of one body, which needs no padding, the first lane of one.
template <int P>
requires(P % 4 == 0 || P == 1) struct Each<P, double> {
  static constexpr int kCount = (P + 3) / 4;
  Lanes x[kCount];  ///< by body, four in each

  Each() noexcept = default;
  // one by one: GCC 12 copies an aggregate by halves of registers, which loads then wait for
  [[gnu::always_inline]] Each(const Each& e) noexcept { *this = e; }
  [[gnu::always_inline]] Each& operator=(const Each& e) noexcept {
#pragma GCC unroll 4
    for (int k = 0; k < kCount; ++k) x[k] = e.x[k];
    return *this;
  }
  [[gnu::always_inline]] static Each zero() noexcept {
    return all(0);
  }
  [[gnu::always_inline]] static Each all(double a) noexcept {
    Each e;
#pragma GCC unroll 4
    for (int k = 0; k < kCount; ++k) e.x[k] = Lanes{a, a, a, a};
    return e;
  }
  template <int N>
  [[gnu::always_inline]] static Each from(const Vec<N>& v) noexcept {
    Each e;
#pragma GCC unroll 4
    for (int k = 0; k < kCount; ++k) {
      gather_zeros<N>(v, 4 * k, e.x[k]);
    }
    return e;
  }
  [[gnu::always_inline]] double operator[](int i) const noexcept {
    if (__builtin_constant_p(i)) return x[i / 4][i % 4];
    double a;  // with another index, GCC 12 takes an element out of a register by a detour
    std::memcpy(&a, reinterpret_cast<const char*>(x) + static_cast<std::size_t>(i) * sizeof a,
                sizeof a);
    return a;
  }
  [[gnu::always_inline]] void set(int i, double a) noexcept {
    x[i / 4][i % 4] = a;
  }
  [[gnu::always_inline]] Each<kPiece<P, double>, double> piece(int k) const noexcept {
    Each<kPiece<P, double>, double> e;
    e.x[0] = x[k];
    return e;
  }
  [[gnu::always_inline]] void put(int k, const Each<kPiece<P, double>, double>& e) noexcept {
    x[k] = e.x[0];
  }
  [[gnu::always_inline]] Each since(int first) const noexcept {
    Each e = zero();
#pragma GCC unroll 4
    for (int k = first / 4; k < kCount; ++k) e.x[k] = x[k];
    return e;
  }
  [[gnu::always_inline]] void store(double* to) const noexcept {
    if constexpr (P == 1) {
      *to = x[0][0];
      return;
    }
#pragma GCC unroll 4
    for (int k = 0; k < P / 4; ++k) detail::store(to + 4 * k, x[k]);
  }
  [[gnu::always_inline]] void add(const Each& a, double times, int first, int last) noexcept {
    const Lanes t{times, times, times, times};
#pragma GCC unroll 4
    for (int k = 0; k < kCount; ++k) {
      if (4 * k <= last && first < 4 * k + 4) x[k] += a.x[k] * t;
    }
  }
  [[gnu::always_inline]] friend Each operator+(const Each& a, const Each& b) noexcept {
    Each e;
#pragma GCC unroll 4
    for (int k = 0; k < kCount; ++k) e.x[k] = a.x[k] + b.x[k];
    return e;
  }
  [[gnu::always_inline]] friend Each operator-(const Each& a, const Each& b) noexcept {
    Each e;
#pragma GCC unroll 4
    for (int k = 0; k < kCount; ++k) e.x[k] = a.x[k] - b.x[k];
    return e;
  }
  [[gnu::always_inline]] friend Each operator*(const Each& a, const Each& b) noexcept {
    Each e;
#pragma GCC unroll 4
    for (int k = 0; k < kCount; ++k) e.x[k] = a.x[k] * b.x[k];
    return e;
  }
};

/// f(k), never inlined.
template <class F>
[[gnu::noinline]] void call_apart(const F& f, int k) noexcept {
  f(k);
}

/// Calls f(k) for each piece k. If there are several, kApart makes the code of f a function of its
/// own: a caller that does much else then needs less code, which must fit into the processor's
/// first cache; one that does little is faster without.
template <int P, class Scalar, bool kApart, class F>
[[gnu::always_inline]] inline void for_pieces(const F& f) noexcept {
  constexpr int kCount = P / kPiece<P, Scalar>;
#pragma GCC unroll 2
  for (int k = 0; k < kCount; ++k) {
    if constexpr (kApart && kCount > 1) {
      call_apart(f, k);
    } else {
      f(k);
    }
  }
}

}  // namespace tauext::detail

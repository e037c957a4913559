// SPDX-License-Identifier: Apache-2.0
/// @file
/// A number of each joint or body of an arm, side by side: what is written for one is computed for
/// all of them at once, one in a SIMD lane.
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>

#include "estimators/math/lanes.h"
#include "estimators/types.h"

namespace tauext::detail {

/// N numbers with zeros appended, to whole Lanes; one needs none, nor do others than doubles.
template <int N, class Scalar = double>
inline constexpr int kPadded = N == 1 || !std::is_same_v<Scalar, double> ? N : (N + 3) / 4 * 4;

/// Bodies of a piece: those of a register. Up to 4 bodies are one piece; 5 to 8 are two, computed
/// one after the other where no body needs the other piece. Of other scalars, which fill registers
/// by themselves, each body is one.
template <int P, class Scalar>
inline constexpr int kPiece = !std::is_same_v<Scalar, double> ? 1
                              : P > 4                         ? 4
                                                              : P;

/// A number of each of P bodies.
template <int P, class Scalar>
struct Each {
  using Operand = Scalar;           ///< what operators take one by one
  static constexpr int kCount = P;  ///< of them
  Scalar x[P];                      ///< by body

  Each() noexcept = default;
  [[gnu::always_inline]] Each(const Each& e) noexcept { *this = e; }
  [[gnu::always_inline]] Each& operator=(const Each& e) noexcept {
    written_out<P>([&](int i) __attribute__((always_inline)) { x[i] = e.x[i]; });
    return *this;
  }
  static Each zero() noexcept { return all(Scalar(0)); }  ///< 0 of each
  /// The same of each.
  [[gnu::always_inline]] static Each all(const Scalar& a) noexcept {
    return made([&](int) __attribute__((always_inline)) { return a; });
  }
  /// Of three.
  [[gnu::always_inline]] static Each of(const Scalar& a, const Scalar& b,
                                        const Scalar& c) noexcept {
    Each e = zero();
    e.x[0] = a, e.x[1] = b, e.x[2] = c;
    return e;
  }
  template <int N>
  [[gnu::always_inline]] static Each from(const Vec<N, Scalar>& v) noexcept {  ///< zeros appended
    return made([&](int i) __attribute__((always_inline)) { return i < N ? v[i] : Scalar(0); });
  }
  template <int N>
  [[gnu::always_inline]] Vec<N, Scalar> to() const noexcept {  ///< the first N
    Vec<N, Scalar> v;
    written_out<N>([&](int i) __attribute__((always_inline)) { v[i] = x[i]; });
    return v;
  }
  [[gnu::always_inline]] const Scalar& operator[](int i) const noexcept {
    return x[i];
  }  ///< that of body i
  [[gnu::always_inline]] void set(int i, const Scalar& a) noexcept {
    x[i] = a;
  }  ///< that of body i
  /// The bodies of a piece: here, one.
  [[gnu::always_inline]] Each<1, Scalar> piece(int k) const noexcept {
    return Each<1, Scalar>::all(x[k]);
  }
  /// Sets the bodies of a piece.
  [[gnu::always_inline]] void put(int k, const Each<1, Scalar>& e) noexcept { x[k] = e.x[0]; }
  /// One by one, as all operators.
  [[gnu::always_inline]] friend Each operator+(const Each& a, const Each& b) noexcept {
    return made([&](int i) __attribute__((always_inline)) { return Scalar(a.x[i] + b.x[i]); });
  }
  [[gnu::always_inline]] friend Each operator-(const Each& a, const Each& b) noexcept {
    return made([&](int i) __attribute__((always_inline)) { return Scalar(a.x[i] - b.x[i]); });
  }
  [[gnu::always_inline]] friend Each operator*(const Each& a, const Each& b) noexcept {
    return made([&](int i) __attribute__((always_inline)) { return Scalar(a.x[i] * b.x[i]); });
  }

 private:
  template <class F>
  [[gnu::always_inline]] static Each made(const F& f) noexcept {
    Each e;
    written_out<P>([&](int i) __attribute__((always_inline)) { e.x[i] = f(i); });
    return e;
  }
};

/// Each, so many times.
template <int P, class Scalar>
[[gnu::always_inline]] inline Each<P, Scalar> operator*(const std::type_identity_t<Scalar>& times,
                                                        const Each<P, Scalar>& a) noexcept {
  return Each<P, Scalar>::all(times) * a;
}

/// Registers full of them; of one body, which needs no padding, the first lane of one.
template <int P>
requires(P % 4 == 0 || P == 1) struct Each<P, double> {
  using Operand = Lanes;
  static constexpr int kCount = (P + 3) / 4;
  Lanes x[kCount];  ///< by body, four in each

  Each() noexcept = default;
  // one by one: GCC 12 copies an aggregate by halves of registers, which loads then wait for
  [[gnu::always_inline]] Each(const Each& e) noexcept { *this = e; }
  [[gnu::always_inline]] Each& operator=(const Each& e) noexcept {
    written_out<kCount>([&](int k) __attribute__((always_inline)) { x[k] = e.x[k]; });
    return *this;
  }
  [[gnu::always_inline]] static Each zero() noexcept { return all(0); }
  [[gnu::always_inline]] static Each of(double a, double b, double c) noexcept {
    Each e = zero();
    e.x[0] = Lanes(a, b, c, 0);
    return e;
  }
  [[gnu::always_inline]] static Each all(double a) noexcept {
    return made([&](int) __attribute__((always_inline)) { return Lanes(a); });
  }
  template <int N>
  [[gnu::always_inline]] static Each from(const Vec<N>& v) noexcept {
    const auto at = [&](int i) __attribute__((always_inline)) {
      return i < N ? v[i] : 0;
    };
    return made([&](int k) __attribute__((always_inline)) {
      return Lanes(at(4 * k), at(4 * k + 1), at(4 * k + 2), at(4 * k + 3));
    });
  }
  template <int N>
  [[gnu::always_inline]] Vec<N> to() const noexcept {
    Vec<N> v;
    std::memcpy(v.data(), x, sizeof v);
    return v;
  }
  [[gnu::always_inline]] double operator[](int i) const noexcept {
    if (__builtin_constant_p(i)) return x[i / 4][i % 4];
    double a;  // with another index, GCC 12 takes an element out of a register by a detour
    std::memcpy(&a, reinterpret_cast<const char*>(x) + static_cast<std::size_t>(i) * sizeof a,
                sizeof a);
    return a;
  }
  [[gnu::always_inline]] void set(int i, double a) noexcept { x[i / 4].set(i % 4, a); }
  [[gnu::always_inline]] Each<kPiece<P, double>, double> piece(int k) const noexcept {
    Each<kPiece<P, double>, double> e;
    e.x[0] = x[k];
    return e;
  }
  [[gnu::always_inline]] void put(int k, const Each<kPiece<P, double>, double>& e) noexcept {
    x[k] = e.x[0];
  }
  /// The same, or, if that saves work, 0 of the bodies before `first`.
  [[gnu::always_inline]] Each since(int first) const noexcept {
    return made([&](int k)
                    __attribute__((always_inline)) { return k < first / 4 ? Lanes(0) : x[k]; });
  }
  /// Adds `times` a, which is 0 but for the bodies `first` to `last`.
  [[gnu::always_inline]] void add(const Each& a, double times, int first, int last) noexcept {
    written_out<kCount>([&](int k) __attribute__((always_inline)) {
      if (4 * k <= last && first < 4 * k + 4) x[k] = x[k] + a.x[k] * times;
    });
  }
  [[gnu::always_inline]] friend Each operator+(const Each& a, const Each& b) noexcept {
    return made([&](int k) __attribute__((always_inline)) { return a.x[k] + b.x[k]; });
  }
  [[gnu::always_inline]] friend Each operator-(const Each& a, const Each& b) noexcept {
    return made([&](int k) __attribute__((always_inline)) { return a.x[k] - b.x[k]; });
  }
  [[gnu::always_inline]] friend Each operator*(const Each& a, const Each& b) noexcept {
    return made([&](int k) __attribute__((always_inline)) { return a.x[k] * b.x[k]; });
  }

 private:
  template <class F>
  [[gnu::always_inline]] static Each made(const F& f) noexcept {
    Each e;
    written_out<kCount>([&](int k) __attribute__((always_inline)) { e.x[k] = f(k); });
    return e;
  }
};

/// Calls f(0) to f(N - 1), written out one after the other or in a loop. Written out, it is faster
/// until a step no longer fits into the processor's first cache of instructions, as the EKF of 7
/// joints would not.
template <bool kLoop, int N, class F>
[[gnu::always_inline]] inline void for_each(F&& f) noexcept {
  if constexpr (kLoop) {
#pragma GCC unroll 1
    for (int i = 0; i < N; ++i) f(i);
  } else {
#pragma GCC unroll 6
    for (int i = 0; i < N; ++i) f(i);
  }
}

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

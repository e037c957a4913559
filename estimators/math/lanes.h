// SPDX-License-Identifier: Apache-2.0
/// @file
/// Four doubles that are computed with at once, in one SIMD register where those are as long, else
/// in two. Registers are filled element by element: one that is loaded from memory that was just
/// written in smaller pieces stalls the pipeline, which costs more than the arithmetic of a step.
#pragma once

#include <cstdint>
#include <cstring>
#include <utility>

namespace tauext {

/// What a Pack says of all its runs, of one.
template <class T>
[[gnu::always_inline]] inline bool all(const T& a) noexcept {
  return static_cast<bool>(a);
}
/// Whether it is so of one run at least.
template <class T>
[[gnu::always_inline]] inline bool any(const T& a) noexcept {
  return !all(!a);
}
/// a where it is so, else b.
template <class T>
[[gnu::always_inline]] inline T select(bool is, const T& a, const T& b) noexcept {
  return is ? a : b;
}

}  // namespace tauext

namespace tauext::detail {

/// Calls f(0) to f(N - 1), written out whatever a compiler does with loops: results then stay in
/// registers at any level of optimisation. (Of temporaries in memory GCC 12 at -O1 let one
/// overwrite another, where it had written out a loop around them.)
template <int N, class F>
[[gnu::always_inline]] inline void written_out(const F& f) noexcept {
  [&]<int... K>(std::integer_sequence<int, K...>) __attribute__((always_inline)) {
    (f(K), ...);
  }
  (std::make_integer_sequence<int, N>());
}

/// Doubles in a register, as the compiler is told (-march).
#ifdef __AVX__
inline constexpr int kRegister = 4;
#else
inline constexpr int kRegister = 2;
#endif

template <int R>
struct Registers;
template <>
struct Registers<2> {
  typedef double Register __attribute__((vector_size(16)));
  typedef std::uint64_t Bits __attribute__((vector_size(16)));
};
template <>
struct Registers<8> {
  typedef double Register __attribute__((vector_size(64)));
  typedef std::uint64_t Bits __attribute__((vector_size(64)));
};
template <>
struct Registers<4> {
  typedef double Register __attribute__((vector_size(32)));
  typedef std::uint64_t Bits __attribute__((vector_size(32)));
};

/// Four doubles in registers of R, with the same layout whatever R is.
template <int R>
class BasicLanes {
  static constexpr int kCount = 4 / R;
  using Register = typename Registers<R>::Register;
  using Bits = typename Registers<R>::Bits;

 public:
  BasicLanes() noexcept = default;  ///< not initialised
  /// The same four times.
  [[gnu::always_inline]] BasicLanes(double a) noexcept : BasicLanes(a, a, a, a) {}
  [[gnu::always_inline]] BasicLanes(double a, double b, double c, double d) noexcept {
    if constexpr (R == 4) {
      r_[0] = Register{a, b, c, d};
    } else {
      r_[0] = Register{a, b}, r_[1] = Register{c, d};
    }
  }

  /// Those from here on.
  [[gnu::always_inline]] static BasicLanes load(const double* from) noexcept {
    BasicLanes x;
    std::memcpy(x.r_, from, sizeof x.r_);
    return x;
  }
  [[gnu::always_inline]] void store(double* to) const noexcept { std::memcpy(to, r_, sizeof r_); }

  /// Element i, which should fold to a constant.
  [[gnu::always_inline]] double operator[](int i) const noexcept { return r_[i / R][i % R]; }
  [[gnu::always_inline]] void set(int i, double a) noexcept { r_[i / R][i % R] = a; }

  // operators are one by one
  [[gnu::always_inline]] friend BasicLanes operator+(const BasicLanes& a,
                                                     const BasicLanes& b) noexcept {
    return each([&](int k) { return a.r_[k] + b.r_[k]; });
  }
  [[gnu::always_inline]] friend BasicLanes operator-(const BasicLanes& a,
                                                     const BasicLanes& b) noexcept {
    return each([&](int k) { return a.r_[k] - b.r_[k]; });
  }
  [[gnu::always_inline]] friend BasicLanes operator*(const BasicLanes& a,
                                                     const BasicLanes& b) noexcept {
    return each([&](int k) { return a.r_[k] * b.r_[k]; });
  }
  [[gnu::always_inline]] friend BasicLanes operator/(const BasicLanes& a,
                                                     const BasicLanes& b) noexcept {
    return each([&](int k) { return a.r_[k] / b.r_[k]; });
  }
  [[gnu::always_inline]] BasicLanes operator-() const noexcept {
    return each([&](int k) { return -r_[k]; });
  }
  /// The lesser of each; a's where one is NaN.
  [[gnu::always_inline]] friend BasicLanes min(const BasicLanes& a, const BasicLanes& b) noexcept {
    return each([&](int k) { return a.r_[k] > b.r_[k] ? b.r_[k] : a.r_[k]; });
  }
  /// The greater of each; a's where one is NaN.
  [[gnu::always_inline]] friend BasicLanes max(const BasicLanes& a, const BasicLanes& b) noexcept {
    return each([&](int k) { return a.r_[k] < b.r_[k] ? b.r_[k] : a.r_[k]; });
  }
  /// 2^k of integers k of at most 1022, each given as 0x1.8p52 + k.
  [[gnu::always_inline]] friend BasicLanes power_of_two(const BasicLanes& rounded) noexcept {
    return each([&](int k) { return (Register)(((Bits)rounded.r_[k] + 1023) << 52); });
  }

  /// Makes the rows of a 4 x 4 matrix of its columns.
  [[gnu::always_inline]] friend void turn(BasicLanes& c0, BasicLanes& c1, BasicLanes& c2,
                                          BasicLanes& c3) noexcept {
    if constexpr (R == 4) {
      const Register even01 = __builtin_shufflevector(c0.r_[0], c1.r_[0], 0, 4, 2, 6);
      const Register odd01 = __builtin_shufflevector(c0.r_[0], c1.r_[0], 1, 5, 3, 7);
      const Register even23 = __builtin_shufflevector(c2.r_[0], c3.r_[0], 0, 4, 2, 6);
      const Register odd23 = __builtin_shufflevector(c2.r_[0], c3.r_[0], 1, 5, 3, 7);
      c0.r_[0] = __builtin_shufflevector(even01, even23, 0, 1, 4, 5);
      c1.r_[0] = __builtin_shufflevector(odd01, odd23, 0, 1, 4, 5);
      c2.r_[0] = __builtin_shufflevector(even01, even23, 2, 3, 6, 7);
      c3.r_[0] = __builtin_shufflevector(odd01, odd23, 2, 3, 6, 7);
    } else {
      const Register upper[] = {c0.r_[1], c1.r_[1]};
      c0.r_[1] = __builtin_shufflevector(c2.r_[0], c3.r_[0], 0, 2);
      c1.r_[1] = __builtin_shufflevector(c2.r_[0], c3.r_[0], 1, 3);
      const Register even = __builtin_shufflevector(c0.r_[0], c1.r_[0], 0, 2);
      c1.r_[0] = __builtin_shufflevector(c0.r_[0], c1.r_[0], 1, 3);
      c0.r_[0] = even;
      c2.r_[0] = __builtin_shufflevector(upper[0], upper[1], 0, 2);
      const Register odd = __builtin_shufflevector(c2.r_[1], c3.r_[1], 1, 3);
      c2.r_[1] = __builtin_shufflevector(c2.r_[1], c3.r_[1], 0, 2);
      c3.r_[0] = __builtin_shufflevector(upper[0], upper[1], 1, 3);
      c3.r_[1] = odd;
    }
  }

 private:
  template <class F>
  [[gnu::always_inline]] static BasicLanes each(const F& f) noexcept {
    BasicLanes c;
    written_out<kCount>([&](int k) __attribute__((always_inline)) { c.r_[k] = f(k); });
    return c;
  }

  alignas(4 * sizeof(double)) Register r_[kCount];
};

/// Four doubles.
using Lanes = BasicLanes<kRegister>;

}  // namespace tauext::detail

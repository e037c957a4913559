// SPDX-License-Identifier: Apache-2.0
/// @file
/// A number of each of several independent runs, computed with at once: the scalar of an estimator
/// that does so many runs (estimators/runs/runs.h). What is written for one double is computed for
/// all of them; where it has to branch, it asks `all`, or takes each run's by `select`, which
/// doubles have, too.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <type_traits>

#include "estimators/math/lanes.h"
#include "estimators/math/sin_cos.h"
#include "estimators/math/tanh.h"
#include "estimators/math/truths.h"

namespace tauext {

/// Runs that fit into a register, as the compiler is told (-march); 4 where one holds 2.
#ifdef __AVX512F__
inline constexpr int kRuns = 8;
#else
inline constexpr int kRuns = 4;
#endif

/// W doubles, of which operators take one by one.
template <int W>
class Pack {
#ifdef __AVX512F__
  static constexpr int R = W < 8 ? W : 8;  // in a register
#else
  static constexpr int R = W < detail::kRegister ? W : detail::kRegister;
#endif
  static constexpr int kCount = W / R;
  static_assert(W % R == 0, "whole registers");
  using Register = typename detail::Registers<R>::Register;
  using Integers = typename detail::Registers<R>::Bits;
  using Truths = detail::Truths<R>;

 public:
  static constexpr int kWidth = W;  ///< runs

  /// What a comparison says of each run.
  class Mask {
    using Bits = typename Truths::Bits;

   public:
    bool operator[](int i) const noexcept { return Truths::at(bits_[i / R], i % R); }  ///< of run i
    [[gnu::always_inline]] friend Mask operator&(const Mask& a, const Mask& b) noexcept {
      return made([&](int k) { return static_cast<Bits>(a.bits_[k] & b.bits_[k]); });
    }
    [[gnu::always_inline]] friend Mask operator|(const Mask& a, const Mask& b) noexcept {
      return made([&](int k) { return static_cast<Bits>(a.bits_[k] | b.bits_[k]); });
    }
    [[gnu::always_inline]] Mask operator!() const noexcept {
      return made([&](int k) { return Truths::no(bits_[k]); });
    }
    /// Whether it is so of all runs.
    [[gnu::always_inline]] friend bool all(const Mask& m) noexcept {
      Bits both = m.bits_[0];
      detail::written_out<kCount>([&](int k) __attribute__((always_inline)) {
        both = static_cast<Bits>(both & m.bits_[k]);
      });
      return Truths::all(both);
    }

   private:
    friend Pack;
    template <class F>
    [[gnu::always_inline]] static Mask made(const F& f) noexcept {
      Mask m;
      detail::written_out<kCount>([&](int k) __attribute__((always_inline)) { m.bits_[k] = f(k); });
      return m;
    }
    Bits bits_[kCount];
  };

  Pack() noexcept = default;  ///< not initialised

  /// Copies register by register: GCC 12 copies arrays by halves of them, for which loads wait.
  [[gnu::always_inline]] Pack(const Pack& a) noexcept {
    *this = a;
  }
  [[gnu::always_inline]] Pack& operator=(const Pack& a) noexcept {
    detail::written_out<kCount>([&](int k) __attribute__((always_inline)) { r_[k] = a.r_[k]; });
    return *this;
  }
  /// The same of every run.
  [[gnu::always_inline]] Pack(double a) noexcept {
    detail::written_out<kCount>([&](int k)
                                    __attribute__((always_inline)) { r_[k] = Register{} + a; });
  }

  [[gnu::always_inline]] double operator[](int i) const noexcept {
    return r_[i / R][i % R];
  }  ///< of run i
  [[gnu::always_inline]] void set(int i, double a) noexcept {
    r_[i / R][i % R] = a;
  }  ///< of run i

  [[gnu::always_inline]] friend Pack operator+(const Pack& a, const Pack& b) noexcept {
    return made([&](int k) { return a.r_[k] + b.r_[k]; });
  }
  [[gnu::always_inline]] friend Pack operator-(const Pack& a, const Pack& b) noexcept {
    return made([&](int k) { return a.r_[k] - b.r_[k]; });
  }
  [[gnu::always_inline]] friend Pack operator*(const Pack& a, const Pack& b) noexcept {
    return made([&](int k) { return a.r_[k] * b.r_[k]; });
  }
  [[gnu::always_inline]] friend Pack operator/(const Pack& a, const Pack& b) noexcept {
    return made([&](int k) { return a.r_[k] / b.r_[k]; });
  }
  [[gnu::always_inline]] Pack operator-() const noexcept {
    return made([&](int k) { return -r_[k]; });
  }
  [[gnu::always_inline]] Pack& operator+=(const Pack& b) noexcept {
    return *this = *this + b;
  }
  [[gnu::always_inline]] Pack& operator-=(const Pack& b) noexcept {
    return *this = *this - b;
  }
  [[gnu::always_inline]] Pack& operator*=(const Pack& b) noexcept {
    return *this = *this * b;
  }
  [[gnu::always_inline]] Pack& operator/=(const Pack& b) noexcept {
    return *this = *this / b;
  }

  [[gnu::always_inline]] friend Mask operator<(const Pack& a, const Pack& b) noexcept {
    return compared([&](int k) { return Truths::less(a.r_[k], b.r_[k]); });
  }
  [[gnu::always_inline]] friend Mask operator<=(const Pack& a, const Pack& b) noexcept {
    return compared([&](int k) { return Truths::at_most(a.r_[k], b.r_[k]); });
  }
  [[gnu::always_inline]] friend Mask operator>(const Pack& a, const Pack& b) noexcept {
    return b < a;
  }
  [[gnu::always_inline]] friend Mask operator>=(const Pack& a, const Pack& b) noexcept {
    return b <= a;
  }
  [[gnu::always_inline]] friend Mask operator==(const Pack& a, const Pack& b) noexcept {
    return compared([&](int k) { return Truths::equal(a.r_[k], b.r_[k]); });
  }
  [[gnu::always_inline]] friend Mask operator!=(const Pack& a, const Pack& b) noexcept {
    return !(a == b);
  }

  /// a where it is so, else b.
  [[gnu::always_inline]] friend Pack select(const Mask& m, const Pack& a, const Pack& b) noexcept {
    return chosen(m, a, b);
  }
  /// The lesser of each; a's where one is NaN.
  [[gnu::always_inline]] friend Pack min(const Pack& a, const Pack& b) noexcept {
    return chosen(b < a, b, a);
  }
  /// The greater of each; a's where one is NaN.
  [[gnu::always_inline]] friend Pack max(const Pack& a, const Pack& b) noexcept {
    return chosen(a < b, b, a);
  }
  [[gnu::always_inline]] friend Pack abs(const Pack& a) noexcept {
    return made([&](int k) { return (Register)((Integers)a.r_[k] & ~sign()); });
  }
  /// a, with the sign of b.
  [[gnu::always_inline]] friend Pack copysign(const Pack& a, const Pack& b) noexcept {
    return made([&](int k) {
      return (Register)(((Integers)a.r_[k] & ~sign()) | ((Integers)b.r_[k] & sign()));
    });
  }
  [[gnu::always_inline]] friend Pack sqrt(const Pack& a) noexcept {
    return made([&](int k) { return Truths::root(a.r_[k]); });
  }
  /// 2^k of integers k of at most 1022, each given as 0x1.8p52 + k.
  [[gnu::always_inline]] friend Pack power_of_two(const Pack& rounded) noexcept {
    return made([&](int k) { return (Register)(((Integers)rounded.r_[k] + 1023) << 52); });
  }
  [[gnu::always_inline]] friend Pack tanh(const Pack& x) noexcept {
    Pack y;
    detail::tanh(x, y);
    return y;
  }
  friend Pack exp(const Pack& x) noexcept {
    return x.each([](double a) { return std::exp(a); });
  }
  friend Pack expm1(const Pack& x) noexcept {
    return x.each([](double a) { return std::expm1(a); });
  }
  friend Pack sin(const Pack& x) noexcept {
    return x.each([](double a) { return std::sin(a); });
  }
  friend Pack cos(const Pack& x) noexcept {
    return x.each([](double a) { return std::cos(a); });
  }

 private:
  template <class F>
  [[gnu::always_inline]] static Mask compared(const F& f) noexcept {
    return Mask::made(f);
  }
  [[gnu::always_inline]] static Integers sign() noexcept {
    return Integers{} + 0x8000000000000000u;
  }
  [[gnu::always_inline]] static Pack chosen(const Mask& m, const Pack& a, const Pack& b) noexcept {
    return made([&](int k) { return Truths::choose(m.bits_[k], a.r_[k], b.r_[k]); });
  }
  template <class F>
  [[gnu::always_inline]] static Pack made(const F& f) noexcept {
    Pack y;
    detail::written_out<kCount>([&](int k) __attribute__((always_inline)) { y.r_[k] = f(k); });
    return y;
  }
  template <class F>
  Pack each(const F& f) const noexcept {
    Pack y;
    for (int i = 0; i < W; ++i) y.set(i, f((*this)[i]));
    return y;
  }

  Register r_[kCount];
};

/// sin and cos of x [rad], |x| < 1e6, of each run.
template <int N, int W>
[[gnu::always_inline]] inline void sin_cos(const Vec<N, Pack<W>>& x, Vec<N, Pack<W>>& sin,
                                           Vec<N, Pack<W>>& cos) noexcept {
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) detail::sin_cos(x[i], sin[i], cos[i]);
}

}  // namespace tauext

/// @cond
template <int W>
struct Eigen::NumTraits<tauext::Pack<W>> : Eigen::GenericNumTraits<tauext::Pack<W>> {
  using Real = tauext::Pack<W>;
  using NonInteger = tauext::Pack<W>;
  using Literal = tauext::Pack<W>;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
};
/// @endcond

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Hyperbolic tangents of a few numbers at once: without branches, one number in each SIMD lane,
/// and without libm, whose call costs as much as the rest of a joint.
///
/// With m = e^2x - 1, tanh x = m / (m + 2). 2x = k ln 2 + r, |r| <= ln 2 / 2, and
/// e^r - 1 = u / v by the minimax polynomials of S. L. Moshier's Cephes (exp.c), so
///     tanh x = (2^k u + (2^k - 1) v) / (2^k u + (2^k + 1) v),
/// which is exact at 0. Relative error below 7e-16.
#pragma once

#include "estimators/math/each.h"

namespace tauext {

namespace detail {

template <class Lanes>
[[gnu::always_inline]] inline void tanh(const Lanes& x, Lanes& tanh_x) noexcept {
  constexpr double kLog2E = 0x1.71547652b82fep+0;
  constexpr double kLn2Part1 = 0x1.62e42feep-1, kLn2Part2 = 0x1.a39ef35793c76p-33;
  constexpr double kRound = 0x1.8p+52;  // as in sin_cos.h; its last bits are those of k, too
  constexpr double kMost = 40;          // beyond, tanh is 1 to the last bit
  const Lanes twice = max(min(2 * x, kMost), -kMost);
  const Lanes rounded = twice * kLog2E + kRound;
  const Lanes k = rounded - kRound;
  const Lanes r = (twice - k * kLn2Part1) - k * kLn2Part2;
  const Lanes power = power_of_two(rounded);
  const Lanes z = r * r;
  Lanes half = 1.26177193074810590878e-4 * z + 3.02994407707441961300e-2;
  half = r * (half * z + 9.99999999999999999910e-1);
  Lanes v = 3.00198505138664455042e-6 * z + 2.52448340349684104192e-3;
  v = (v * z + 2.27265548208155028766e-1) * z + 2.00000000000000000005 - half;
  const Lanes u = power * (2 * half);
  tanh_x = (u + (power - 1) * v) / (u + (power + 1) * v);
}

}  // namespace detail

/// tanh of x [1].
template <int N>
[[gnu::always_inline]] inline Vec<N> tanh(const Vec<N>& x) noexcept {
  const auto all = detail::Each<detail::kPadded<N>, double>::from(x);
  Vec<N> out;
#pragma GCC unroll 2
  for (int first = 0; first < N; first += 4) {
    detail::Lanes t;
    detail::tanh(all.x[first / 4], t);
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
      if (first + i < N) out[first + i] = t[i];
    }
  }
  return out;
}

/// The same for any other scalar, by its own tanh.
template <int N, class Scalar>
Vec<N, Scalar> tanh(const Vec<N, Scalar>& x) noexcept {
  Vec<N, Scalar> out;
  for (int i = 0; i < N; ++i) out[i] = tanh(x[i]);
  return out;
}

}  // namespace tauext

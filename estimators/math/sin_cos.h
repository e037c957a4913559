// SPDX-License-Identifier: Apache-2.0
/// @file
/// Sines and cosines of a few angles at once: without branches, one angle in each SIMD lane, and
/// without libm, whose last bits differ from processor to processor.
///
/// x = k pi/2 + r, |r| <= pi/4: k pi/2 is subtracted in three parts of 33 bits, so every product is
/// exact for |k| < 2^20 (fdlibm, e_rem_pio2.c). sin r and cos r by the minimax polynomials of
/// S. L. Moshier's Cephes (sin.c). Absolute error below 2.1e-16 for |x| < 1e6 rad.
#pragma once

#include "estimators/math/each.h"

namespace tauext {

namespace detail {

template <class Lanes>
[[gnu::always_inline]] inline void sin_cos(const Lanes& x, Lanes& sin_x, Lanes& cos_x) noexcept {
  constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1;
  constexpr double kPart1 = 0x1.921fb544p+0, kPart2 = 0x1.0b4611a6p-34,
                   kPart3 = 0x1.3198a2e037073p-69;
  constexpr double kRound = 0x1.8p+52;  // adding and subtracting it rounds to the nearest integer
  const Lanes k = (x * kTwoOverPi + kRound) - kRound;
  const Lanes r = ((x - k * kPart1) - k * kPart2) - k * kPart3;
  const Lanes z = r * r;
  Lanes s = 1.58962301576546568060e-10 * z - 2.50507477628578072866e-8;
  s = s * z + 2.75573136213857245213e-6;
  s = s * z - 1.98412698295895385996e-4;
  s = s * z + 8.33333333332211858878e-3;
  s = s * z - 1.66666666666666307295e-1;
  s = r + r * (z * s);
  Lanes c = -1.13585365213876817300e-11 * z + 2.08757008419747316778e-9;
  c = c * z - 2.75573141792967388112e-7;
  c = c * z + 2.48015872888517045348e-5;
  c = c * z - 1.38888888888730564116e-3;
  c = c * z + 4.16666666666665929218e-2;
  c = (1 - 0.5 * z) + z * z * c;

  // odd quadrants swap the two, odd half turns negate both; factors of 0 and +-1 are exact
  const Lanes half_turns = (0.5 * k - 0.25 + kRound) - kRound;
  const Lanes turns = (0.5 * half_turns - 0.25 + kRound) - kRound;
  const Lanes odd = k - 2 * half_turns;
  const Lanes sign = 1 - 2 * (half_turns - 2 * turns);
  sin_x = sign * (1 - odd) * s + sign * odd * c;
  cos_x = sign * (1 - odd) * c - sign * odd * s;
}

}  // namespace detail

/// sin and cos of x [rad], |x| < 1e6.
template <int N>
[[gnu::always_inline]] inline void sin_cos(const Vec<N>& x, Vec<N>& sin, Vec<N>& cos) noexcept {
  const auto angles = detail::Each<detail::kPadded<N>, double>::from(x);
#pragma GCC unroll 2
  for (int first = 0; first < N; first += 4) {
    detail::Lanes s, c;
    detail::sin_cos(angles.x[first / 4], s, c);
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
      if (first + i < N) sin[first + i] = s[i], cos[first + i] = c[i];
    }
  }
}

/// The same for any other scalar, by its own sin and cos.
template <int N, class Scalar>
void sin_cos(const Vec<N, Scalar>& x, Vec<N, Scalar>& s, Vec<N, Scalar>& c) noexcept {
  for (int i = 0; i < N; ++i) s[i] = sin(x[i]), c[i] = cos(x[i]);
}

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// A number as NumPy keeps it in bytes.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace tauext {

/// What NumPy's '<f8' says.
struct NpyNumber {
  char kind = 'f';   ///< b, i, u or f
  int size = 8;      ///< [bytes]
  bool big = false;  ///< the highest byte is the first

  /// Whether it is one that value() knows.
  bool known() const {
    const bool wide = size == 2 || size == 4 || size == 8;
    if (kind == 'b') return size == 1;
    return kind == 'f' ? wide : (kind == 'i' || kind == 'u') && (size == 1 || wide);
  }

  /// Integers beyond 2^53 are rounded.
  double value(const unsigned char* bytes) const {
    std::uint64_t bits = 0;
    for (int i = 0; i < size; ++i) bits = bits << 8 | bytes[big ? i : size - 1 - i];
    if (kind == 'b') return bits != 0;
    if (kind == 'u') return static_cast<double>(bits);
    if (kind == 'i') {
      const int unused = 64 - 8 * size;
      return static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused);
    }
    if (size == 8) return std::bit_cast<double>(bits);
    if (size == 4) return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    return half(static_cast<int>(bits));
  }

 private:
  // IEEE 754 binary16
  static double half(int bits) {
    const int exponent = bits >> 10 & 31, fraction = bits & 1023;
    const double size = exponent == 31  ? (fraction == 0 ? std::numeric_limits<double>::infinity()
                                                         : std::numeric_limits<double>::quiet_NaN())
                        : exponent == 0 ? std::ldexp(fraction, -24)
                                        : std::ldexp(1024 + fraction, exponent - 25);
    return bits >> 15 == 0 ? size : -size;
  }
};

}  // namespace tauext

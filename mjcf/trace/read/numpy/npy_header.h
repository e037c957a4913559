// SPDX-License-Identifier: Apache-2.0
/// @file
/// The header of a .npy: what numpy/lib/format.py writes, versions 1.0 to 3.0.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "mjcf/trace/byte_order.h"

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
    const std::uint64_t bits =
        from_bytes(bytes, size, big ? std::endian::big : std::endian::little);
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

/// How many columns an array may have.
inline constexpr std::size_t kMostNpyColumns = 4096;

/// A field of a structured element, or the whole of a plain one.
struct NpyField {
  std::string name;        ///< "" of a plain one
  NpyNumber number;        ///< if it is one
  bool is_number = false;  ///< else it is text or padding
  std::size_t count = 1;   ///< of numbers in a row, as in ('q', '<f8', (6,))
  std::size_t offset = 0;  ///< [bytes] in the element
};

/// What such a header says.
struct NpyHeader {
  std::vector<NpyField> fields;
  bool structured = false;
  std::size_t item_size = 0;         ///< [bytes] of an element, at most 1 MB
  bool fortran_order = false;        ///< the first index runs fastest
  std::vector<std::uint64_t> shape;  ///< each number at most 2^40
  std::string unusable;              ///< the type of a field that no column can hold; "" if none
  std::size_t size = 0;              ///< [bytes] of the header, behind which the elements begin
};

/// Reads it from the first bytes of a file.
/// @throws std::runtime_error beginning with `what`, if it is no header, or longer than 64 kB
NpyHeader read_npy_header(std::string_view bytes, const std::string& what);

/// What a header's text says, but for its size.
/// @throws std::runtime_error beginning with `what`
NpyHeader parse_npy_header(std::string_view text, const std::string& what);

}  // namespace tauext

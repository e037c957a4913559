// SPDX-License-Identifier: Apache-2.0
/// @file
/// The header of a .npy: what numpy/lib/format.py writes, versions 1.0 to 3.0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mjcf/trace/read/numpy/byte_stream.h"
#include "mjcf/trace/read/numpy/npy_number.h"

namespace tauext {

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
/// @throws std::runtime_error naming path and array, if it is no header, or longer than 64 kB
NpyHeader read_npy_header(ByteStream& stream);

/// What a header's text says, but for its size.
/// @throws std::runtime_error beginning with `what`
NpyHeader parse_npy_header(std::string_view text, const std::string& what);

}  // namespace tauext

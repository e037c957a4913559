// SPDX-License-Identifier: Apache-2.0
/// @file
/// Unsigned integers of up to 8 bytes, as files and messages hold them: the lowest byte first,
/// where no order is given.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>

namespace tauext {

/// The number in so many bytes.
template <class Byte>
constexpr std::uint64_t from_bytes(const Byte* bytes, std::size_t count,
                                   std::endian order = std::endian::little) noexcept {
  std::uint64_t x = 0;
  for (std::size_t i = 0; i < count; ++i)
    x = x << 8 | static_cast<std::uint8_t>(bytes[order == std::endian::big ? i : count - 1 - i]);
  return x;
}

/// So many low bytes of a number.
constexpr std::string to_bytes(std::uint64_t x, std::size_t count,
                               std::endian order = std::endian::little) {
  std::string bytes(count, '\0');
  for (std::size_t i = 0; i < count; ++i, x >>= 8)
    bytes[order == std::endian::big ? count - 1 - i : i] = static_cast<char>(x & 255);
  return bytes;
}

}  // namespace tauext

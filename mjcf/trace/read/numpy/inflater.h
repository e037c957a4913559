// SPDX-License-Identifier: Apache-2.0
/// @file
/// What zlib does for a .npz. It is optional: without it everything here throws, and says what to
/// install.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

namespace tauext {

/// @throws std::runtime_error naming the package, if zlib was missing at build
void require_zlib();

/// The checksum of a ZIP; `before` is that of the bytes before these.
std::uint32_t crc32_of(std::uint32_t before, const void* bytes, std::size_t count);

/// Unpacks the bytes of one member, step by step.
class Inflater {
 public:
  /// How many bytes a step took and gave.
  struct Step {
    std::size_t used = 0;  ///< of the packed ones
    std::size_t made = 0;  ///< of the unpacked ones
    bool good = false;     ///< whether they are what a deflater writes
    bool end = false;      ///< whether no more will follow
  };

  Inflater();
  ~Inflater();
  /// Each of the sizes [bytes] at most 1 GiB.
  Step step(const unsigned char* packed, std::size_t packed_size, unsigned char* to,
            std::size_t size);

 private:
  struct Stream;
  std::unique_ptr<Stream> stream_;
};

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// The bytes of a file from the first to the last, unpacked where it is compressed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace tauext {

/// Whether bytes that begin a file are those of gzip, xz, zstd, bzip2 or lz4.
bool is_compressed(std::string_view begin);

/// Such bytes that lie in memory, unpacked.
/// @param size [bytes] that they have then; no more are unpacked than one more
/// @throws std::runtime_error naming the path of the file that they are from
std::string unpacked(std::string_view bytes, std::size_t size, const std::string& path);

/// The CRC-32 of ISO 3309, which ZIP, gzip and MCAP have; `before` is that of the bytes before.
/// @throws std::runtime_error naming the package, if zlib was missing at build
std::uint32_t crc32_of(std::uint32_t before, const void* bytes, std::size_t count);

/// A file of text, by what its first bytes say, in constant memory. zlib unpacks gzip, and
/// libarchive the others; both are optional at build. A checksum of lz4 or zstd that is not there
/// is not compared.
class UnpackedFile {
 public:
  /// It is claimed (input_file.h).
  /// @throws std::runtime_error naming the path, if it cannot be read, or is compressed and
  /// its library was missing at build
  explicit UnpackedFile(const std::string& path);
  ~UnpackedFile();

  /// The next bytes, at most so many; 0 at the end.
  /// @throws std::runtime_error naming the path, if it cannot be read, or is damaged
  std::size_t read(char* to, std::size_t most);

 private:
  struct Source;
  std::unique_ptr<Source> source_;
};

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// The bytes of an array's file in their order, unpacked, in constant memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mjcf/trace/read/numpy/byte_file.h"
#include "mjcf/trace/read/numpy/inflater.h"
#include "mjcf/trace/read/numpy/zip_directory.h"

namespace tauext {

/// Where such bytes are.
struct Extent {
  std::string what;                  ///< "x.npz: array 'q'", for errors
  std::uint64_t offset = 0;          ///< [bytes] in the file
  std::uint64_t packed = 0;          ///< [bytes] there
  std::uint64_t size = 0;            ///< [bytes] unpacked
  bool deflated = false;             ///< else they are stored as they are
  std::optional<std::uint32_t> crc;  ///< of the unpacked bytes, if it is known
};

/// Those of a whole file.
Extent extent_of(const ByteFile& file);

/// Those of a member of a ZIP.
/// @throws std::runtime_error beginning with `what`, if it is encrypted, or packed in another way,
/// or has a size that cannot be
Extent extent_of(const ByteFile& file, const ZipMember& member, const std::string& what);

/// Reads such bytes from the first to the last.
class ByteStream {
 public:
  /// The file must outlive it.
  /// @param checked whether all bytes are read, and compared with their checksum when the last one
  /// is; else those that are skipped cost nothing if they are stored
  ByteStream(const ByteFile& file, Extent extent, bool checked);

  /// The next bytes.
  /// @throws std::runtime_error naming path and array, if they are not there, or damaged
  void read(void* to, std::size_t count);
  /// Leaves the next bytes out; it throws as read() does.
  void skip(std::uint64_t count);
  const Extent& extent() const { return extent_; }

 private:
  void fill();
  std::size_t unpack(std::size_t most);
  [[noreturn]] void fail(const std::string& why) const;

  const ByteFile& file_;
  Extent extent_;
  bool checked_;
  std::unique_ptr<Inflater> inflater_;
  std::vector<unsigned char> packed_, block_;
  std::size_t packed_at_ = 0, packed_end_ = 0, at_ = 0, end_ = 0;  // in these two
  std::uint64_t packed_taken_ = 0, taken_ = 0;                     // of those in the file
  std::uint32_t crc_ = 0;
};

}  // namespace tauext

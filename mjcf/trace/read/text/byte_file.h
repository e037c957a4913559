// SPDX-License-Identifier: Apache-2.0
/// @file
/// A file that is read at offsets, none of which is believed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace tauext {

/// A regular file, which is claimed (input_file.h).
class ByteFile {
 public:
  /// @throws std::runtime_error naming the path, if it cannot be read or is no regular file
  explicit ByteFile(std::string path);
  ~ByteFile();
  ByteFile(const ByteFile&) = delete;
  ByteFile& operator=(const ByteFile&) = delete;

  const std::string& path() const { return path_; }
  std::uint64_t size() const { return size_; }  ///< [bytes] when it was opened
  /// Whether so many bytes at that offset lie in the file.
  bool has(std::uint64_t offset, std::uint64_t count) const {
    return offset <= size_ && count <= size_ - offset;
  }
  /// @throws std::runtime_error that says this of the path
  [[noreturn]] void fail(std::string_view why) const;
  /// @throws std::runtime_error naming the path, if the file does not have these bytes
  void read(std::uint64_t offset, void* to, std::size_t count) const;

 private:
  std::string path_;
  int fd_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace tauext

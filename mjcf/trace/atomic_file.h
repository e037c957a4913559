// SPDX-License-Identifier: Apache-2.0
/// @file
/// Output files that appear whole or not at all.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace tauext {

/// A file under a temporary name beside its path, renamed onto it by commit(); without commit()
/// nothing is left. The path "-" is standard output.
class AtomicFile {
 public:
  /// @throws std::runtime_error naming the path and the system's reason
  explicit AtomicFile(std::string path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// @throws std::runtime_error when the disk is full and the like
  void write(std::string_view text);
  /// @throws std::runtime_error when the last bytes could not be written
  void commit();

 private:
  [[noreturn]] void fail(const char* what) const;

  std::string path_, temporary_;
  std::FILE* file_ = nullptr;
};

}  // namespace tauext

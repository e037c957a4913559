// SPDX-License-Identifier: Apache-2.0
/// @file
/// Files that are read whole, and a folder for those that nobody keeps.
#pragma once

#include <string>

namespace tauext::gate {

/// All bytes of a file.
/// @throws std::runtime_error naming the path, if it cannot be read
std::string read_file(const std::string& path);

/// Folder of its own below the system's temporary one, removed with what is in it.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::string& path() const { return path_; }
  /// Copies a file into it.
  /// @return the copy's path  @throws std::runtime_error naming the file
  std::string copy(const std::string& file, const std::string& name) const;

 private:
  std::string path_;
};

}  // namespace tauext::gate

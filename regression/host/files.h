// SPDX-License-Identifier: Apache-2.0
/// @file
/// A folder for files that nobody keeps.
#pragma once

#include <string>

namespace tauext::gate {

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

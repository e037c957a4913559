// SPDX-License-Identifier: Apache-2.0
/// @file
/// A file to which lines are added, each of them whole: whoever kills the program leaves at most
/// the last one unfinished.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace tauext::study {

/// One writer at a time: another one is refused.
class Journal {
 public:
  /// Opens it, and makes it if it is not there.
  /// @throws std::runtime_error naming the path and the system's reason, or that another program
  /// writes it
  explicit Journal(const std::string& path);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Forgets what is behind so many bytes, and goes on from there.
  void cut(std::size_t bytes);
  /// @param line without its end
  void add(std::string_view line);

 private:
  std::string path_;
  int fd_;
  std::size_t end_ = 0;  // [bytes] of whole lines
  bool broken_ = false;
};

}  // namespace tauext::study

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Output files that appear whole or not at all.
#pragma once

#include <sys/stat.h>

#include <cstdio>
#include <string>
#include <string_view>

namespace tauext {

/// A file that takes its path's place by commit(). Until then it is in no folder (O_TMPFILE), so
/// that whatever ends the program leaves nothing; where the file system cannot do that, a program
/// that is killed leaves a hidden .part beside the path. It keeps mode and owner of what it
/// replaces, as far as the user may. The path "-" is standard output; devices and pipes are written
/// in place. A link stays a link, and what it points to is replaced, unless somebody else's link
/// lies in a folder that everybody may write.
class AtomicFile {
 public:
  /// @throws std::runtime_error naming the path: the system's reason, or that this program reads
  /// that very file (input_file.h)
  explicit AtomicFile(std::string path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// @throws std::runtime_error when the disk is full and the like
  void write(std::string_view text);
  /// @throws std::runtime_error when the last bytes could not be written
  void commit();

 private:
  void follow_links();
  void open_beside();
  void keep_owner();
  void put_in_place();
  [[noreturn]] void fail(const char* what) const;

  std::string path_, temporary_;
  std::FILE* file_ = nullptr;
  bool in_place_ = false;  // standard output, a device or a pipe
  bool replaces_ = false;  // a file that is there
  struct stat replaced_ {};
};

}  // namespace tauext

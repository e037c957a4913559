// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/atomic_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <utility>

namespace tauext {

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)) {
  if (path_ == "-") {
    file_ = stdout;
    return;
  }
  // a link stays a link: what it points to is replaced
  std::error_code error;
  for (int links = 0; links < 8 && std::filesystem::is_symlink(path_, error); ++links) {
    const std::filesystem::path link(path_);
    path_ = (link.parent_path() / std::filesystem::read_symlink(link)).string();
  }
  // a device or a pipe cannot be replaced by a file, so it is written in place
  std::error_code ignored;
  const bool special =
      std::filesystem::exists(path_, ignored) && !std::filesystem::is_regular_file(path_, ignored);
  if (!special) temporary_ = fmt::format("{}.{}.part", path_, ::getpid());
  file_ = std::fopen(special ? path_.c_str() : temporary_.c_str(), "we");
  if (file_ == nullptr) {
    temporary_.clear();
    fail("cannot open for writing");
  }
}

AtomicFile::~AtomicFile() {
  if (file_ != nullptr && file_ != stdout) std::fclose(file_);
  if (!temporary_.empty()) std::remove(temporary_.c_str());
}

void AtomicFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail("cannot write");
}

void AtomicFile::commit() {
  if (std::fflush(file_) != 0) fail("cannot write");
  if (file_ == stdout) return;
  if (std::fclose(std::exchange(file_, nullptr)) != 0) fail("cannot write");
  if (temporary_.empty()) return;
  if (std::rename(temporary_.c_str(), path_.c_str()) != 0)
    fail("cannot rename the new file onto it");
  temporary_.clear();
}

void AtomicFile::fail(const char* what) const {
  const int reason = errno;
  throw std::runtime_error(fmt::format("{}: {}: {}", path_, what, std::strerror(reason)));
}

}  // namespace tauext

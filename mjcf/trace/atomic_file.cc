// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <random>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "mjcf/trace/file_claims.h"

namespace tauext {
namespace fs = std::filesystem;
namespace {

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

// .out.csv.9f0c31d2a5b6e877.part beside out.csv; a name may have 255 bytes
std::string temporary_name(const fs::path& path) {
  std::random_device random;
  return (folder_of(path) / fmt::format(".{}.{:08x}{:08x}.part",
                                        path.filename().string().substr(0, 150), random(),
                                        random()))
      .string();
}

// the kernel's rule for sticky folders, /proc/sys/fs/protected_symlinks
bool may_follow(const fs::path& link) {
  struct stat folder {};
  struct stat file {};
  if (::stat(folder_of(link).c_str(), &folder) != 0 || ::lstat(link.c_str(), &file) != 0) {
    return false;
  }
  const bool everybodys = (folder.st_mode & S_ISVTX) != 0 && (folder.st_mode & S_IWOTH) != 0;
  return !everybodys || file.st_uid == ::geteuid() || file.st_uid == folder.st_uid;
}

}  // namespace

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)) {
  if (path_ == "-") {
    file_ = stdout;
    in_place_ = true;
    return;
  }
  if (path_.empty()) throw std::runtime_error("an output has no name");
  follow_links();
  const bool exists = ::stat(path_.c_str(), &replaced_) == 0;
  if (!exists && errno != ENOENT) fail("cannot open for writing");
  in_place_ = exists && !S_ISREG(replaced_.st_mode);
  if (in_place_) {
    file_ = std::fopen(path_.c_str(), "we");
    if (file_ == nullptr) fail("cannot open for writing");
    return;
  }
  if (exists) claims::add_output(replaced_, path_);
  replaces_ = exists;
  try {
    open_beside();
  } catch (...) {
    if (exists) claims::drop_output(replaced_);
    throw;
  }
}

AtomicFile::~AtomicFile() {
  if (replaces_) claims::drop_output(replaced_);
  if (file_ != nullptr && file_ != stdout) std::fclose(file_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void AtomicFile::follow_links() {
  std::error_code error;
  for (int links = 0; links < 8 && fs::is_symlink(path_, error); ++links) {
    struct stat target {};  // /dev/fd/N is a link to what has no name
    if (::stat(path_.c_str(), &target) == 0 && !S_ISREG(target.st_mode)) return;
    const fs::path link(path_);
    if (!may_follow(link)) {
      throw std::runtime_error(fmt::format(
          "{}: is somebody else's link in a folder that everybody may write: not followed", path_));
    }
    path_ = (folder_of(link) / fs::read_symlink(link)).string();
  }
}

void AtomicFile::open_beside() {
  constexpr mode_t kMode = 0666;  // less the umask
  int fd = ::open(folder_of(path_).c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, kMode);
  if (fd < 0) {
    temporary_ = temporary_name(path_);
    fd = ::open(temporary_.c_str(), O_CREAT | O_EXCL | O_NOFOLLOW | O_WRONLY | O_CLOEXEC, kMode);
  }
  if (fd < 0) fail("cannot open for writing");
  file_ = ::fdopen(fd, "w");
  if (file_ != nullptr) return;
  ::close(fd);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  fail("cannot open for writing");
}

void AtomicFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail("cannot write");
}

void AtomicFile::commit() {
  if (std::fflush(file_) != 0) fail("cannot write");
  if (file_ == stdout) return;
  if (!in_place_) {
    keep_owner();
    if (::fsync(::fileno(file_)) != 0) fail("cannot write");
    put_in_place();
  }
  if (std::fclose(std::exchange(file_, nullptr)) != 0) fail("cannot write");
  if (std::exchange(replaces_, false)) claims::drop_output(replaced_);
}

// As far as the user may. Where owner or group cannot be kept, ours do not get their rights.
void AtomicFile::keep_owner() {
  if (!replaces_) return;
  const int fd = ::fileno(file_);
  mode_t mode = replaced_.st_mode & 07777;
  if (::fchown(fd, replaced_.st_uid, replaced_.st_gid) != 0) {
    mode &= ~mode_t{S_ISUID | S_ISGID};
    if (::fchown(fd, static_cast<uid_t>(-1), replaced_.st_gid) != 0) mode &= ~mode_t{S_IRWXG};
  }
  ::fchmod(fd, mode);
}

void AtomicFile::put_in_place() {
  struct stat now {};  // a file that this program reads may have come there since
  if (::stat(path_.c_str(), &now) == 0 && !replaces_) {
    claims::add_output(now, path_);
    claims::drop_output(now);
  }
  if (temporary_.empty()) {
    const std::string nameless = fmt::format("/proc/self/fd/{}", ::fileno(file_));
    const std::string name = temporary_name(path_);
    if (::linkat(AT_FDCWD, nameless.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) != 0) {
      fail("cannot name the new file");
    }
    temporary_ = name;
  }
  if (std::rename(temporary_.c_str(), path_.c_str()) != 0) {
    fail("cannot rename the new file onto it");
  }
  temporary_.clear();
  if (const int folder = ::open(folder_of(path_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
      folder >= 0) {
    ::fsync(folder);
    ::close(folder);
  }
}

void AtomicFile::fail(const char* what) const {
  const int reason = errno;
  throw std::runtime_error(fmt::format("{}: {}: {}", path_, what, std::strerror(reason)));
}

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
#include "bench/study/detection/journal.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>

#include "mjcf/trace/input_file.h"

namespace tauext::study {
namespace {

[[noreturn]] void fail_as_system(const std::string& path) {
  throw std::runtime_error(path + ": " + std::error_code(errno, std::generic_category()).message());
}

}  // namespace

Journal::Journal(const std::string& path) : path_(path) {
  refuse_input(path);
  fd_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (fd_ < 0) fail_as_system(path);
  if (::flock(fd_, LOCK_EX | LOCK_NB) == 0) return;
  ::close(fd_);
  throw std::runtime_error(path + ": another program is writing it");
}

Journal::~Journal() {
  ::close(fd_);
}

void Journal::cut(std::size_t bytes) {
  if (::ftruncate(fd_, static_cast<off_t>(bytes)) != 0 || ::lseek(fd_, 0, SEEK_END) < 0)
    fail_as_system(path_);
}

void Journal::add(std::string_view line) {
  std::string rest(line);
  rest += '\n';
  while (!rest.empty()) {
    const ssize_t n = ::write(fd_, rest.data(), rest.size());
    if (n < 0 && errno != EINTR) fail_as_system(path_);
    if (n > 0) rest.erase(0, static_cast<std::size_t>(n));
  }
}

}  // namespace tauext::study

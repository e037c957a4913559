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
  const int why = errno;
  ::close(fd_);
  if (why == EWOULDBLOCK) throw std::runtime_error(path + ": another program is writing it");
  throw std::runtime_error(path + ": cannot be locked against other writers (" +
                           std::error_code(why, std::generic_category()).message() +
                           "); another file system may do that");
}

Journal::~Journal() {
  ::close(fd_);
}

void Journal::cut(std::size_t bytes) {
  if (::ftruncate(fd_, static_cast<off_t>(bytes)) != 0 || ::lseek(fd_, 0, SEEK_END) < 0)
    fail_as_system(path_);
  end_ = bytes;
}

void Journal::add(std::string_view line) {
  if (broken_) throw std::runtime_error(path_ + ": a line could not be written");
  std::string rest(line);
  rest += '\n';
  const std::size_t whole = end_ + rest.size();
  while (!rest.empty()) {
    const ssize_t n = ::write(fd_, rest.data(), rest.size());
    if (n > 0) rest.erase(0, static_cast<std::size_t>(n));
    if (n >= 0 || errno == EINTR) continue;
    const int why = errno;
    broken_ = true;  // nothing may stand behind half a line
    [[maybe_unused]] const int cut = ::ftruncate(fd_, static_cast<off_t>(end_));
    errno = why;
    fail_as_system(path_);
  }
  end_ = whole;
  ::fdatasync(fd_);  // for a machine that is lost
}

}  // namespace tauext::study

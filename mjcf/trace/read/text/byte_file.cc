// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/text/byte_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "mjcf/trace/input_file.h"

namespace tauext {

ByteFile::ByteFile(std::string path) : path_(std::move(path)) {
  claim_input(path_);
  struct stat file {};
  // a pipe would wait for who writes it
  if (::stat(path_.c_str(), &file) == 0 && !S_ISREG(file.st_mode)) fail("is no regular file");
  fd_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd_ < 0 || ::fstat(fd_, &file) != 0) {
    const int reason = errno;
    if (fd_ >= 0) ::close(fd_);
    fail(std::strerror(reason));
  }
  size_ = static_cast<std::uint64_t>(file.st_size);
}

ByteFile::~ByteFile() {
  ::close(fd_);
}

void ByteFile::fail(std::string_view why) const {
  throw std::runtime_error(fmt::format("{}: {}", path_, why));
}

void ByteFile::read(std::uint64_t offset, void* to, std::size_t count) const {
  for (std::size_t done = 0; done < count;) {
    const ssize_t n = has(offset, count) ? ::pread(fd_, static_cast<char*>(to) + done, count - done,
                                                   static_cast<off_t>(offset + done))
                                         : 0;
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail(n < 0 ? std::strerror(errno) : "ends too early");
    done += static_cast<std::size_t>(n);
  }
}

}  // namespace tauext

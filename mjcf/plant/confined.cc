// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/confined.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <string_view>

namespace tauext {
namespace {

using Clock = std::chrono::steady_clock;

#ifdef TAUEXT_SANITIZED
constexpr bool kSanitized = true;  // their shadow is memory, too
#else
constexpr bool kSanitized = false;
#endif

// the first byte that the child writes
constexpr char kResult = 'r', kError = 'e', kNoMemory = 'm';

void limit(__rlimit_resource what, rlim_t to) {
  const rlimit both{to, to};
  ::setrlimit(what, &both);
}

// [bytes] of addresses that this process has
std::size_t own_memory() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

void confine(const Limits& limits) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  // this process's handlers would remove its files
  for (const int s : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) {
    ::signal(s, SIG_DFL);
  }
  const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(null, standard);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
  limit(RLIMIT_CPU, static_cast<rlim_t>(std::ceil(limits.time)));
  if (!kSanitized) limit(RLIMIT_AS, own_memory() + limits.memory);
}

void write_all(int to, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(to, bytes.data(), bytes.size());
    if (n <= 0) ::_exit(1);
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
}

[[noreturn]] void be_child(int to, const Limits& limits, const std::function<std::string()>& work) {
  confine(limits);
  char kind = kError;
  std::string bytes;
  try {
    bytes = work();
    kind = kResult;
  } catch (const std::bad_alloc&) {
    kind = kNoMemory;
  } catch (const std::exception& e) {
    bytes = e.what();
  }
  write_all(to, {&kind, 1});
  write_all(to, bytes);
  ::_exit(0);
}

// all that the child writes, while there is time and room
std::string read_all(int from, const Limits& limits) {
  const auto end = Clock::now() + std::chrono::duration<double>(limits.time);
  std::string bytes;
  std::array<char, 1 << 16> buffer;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
    pollfd readable{.fd = from, .events = POLLIN, .revents = 0};
    const int ready =
        ::poll(&readable, 1, static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) throw Unfinished(fmt::format("is not done after {:g} s", limits.time));
    const ssize_t n = ::read(from, buffer.data(), buffer.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return bytes;
    if (bytes.size() + static_cast<std::size_t>(n) > limits.memory) {
      throw Unfinished(fmt::format("needs more than {} MB", limits.memory >> 20));
    }
    bytes.append(buffer.data(), static_cast<std::size_t>(n));
  }
}

int wait_for(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

std::string confined(const Limits& limits, const std::function<std::string()>& work) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error(fmt::format("no pipe: {}", std::strerror(errno)));
  }
  const pid_t child = ::fork();
  if (child == 0) be_child(ends[1], limits, work);
  const int error = errno;
  ::close(ends[1]);
  if (child < 0) {
    ::close(ends[0]);
    throw std::runtime_error(fmt::format("no child process: {}", std::strerror(error)));
  }
  std::string bytes;
  try {
    bytes = read_all(ends[0], limits);
  } catch (...) {
    ::kill(child, SIGKILL);
    ::close(ends[0]);
    wait_for(child);
    throw;
  }
  ::close(ends[0]);
  const int status = wait_for(child);
  if (WIFSIGNALED(status)) {
    throw Unfinished(WTERMSIG(status) == SIGXCPU
                         ? fmt::format("is not done after {:g} s", limits.time)
                         : fmt::format("crashes ({})", ::strsignal(WTERMSIG(status))));
  }
  if (bytes.empty() || WEXITSTATUS(status) != 0) throw Unfinished("ends without a word");
  if (bytes[0] == kNoMemory) {
    throw Unfinished(fmt::format("needs more than {} MB", limits.memory >> 20));
  }
  if (bytes[0] == kError) throw std::runtime_error(bytes.substr(1));
  return bytes.substr(1);
}

}  // namespace tauext

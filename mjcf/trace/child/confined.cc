// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/child/confined.h"

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
#include <cstdint>
#include <cstring>
#include <exception>
#include <fstream>
#include <new>
#include <string_view>

namespace tauext {
namespace {

using Clock = std::chrono::steady_clock;

#ifdef TAUEXT_SANITIZED
constexpr bool kSanitized = true;  // the sanitizers' own memory would count, too
#else
constexpr bool kSanitized = false;
#endif

// the last byte that the child writes: without it the rest is not whole
constexpr char kResult = 'r', kError = 'e', kNoMemory = 'm';

void limit(__rlimit_resource what, rlim_t soft, rlim_t hard) {
  const rlimit both{soft, hard};
  ::setrlimit(what, &both);
}

// [bytes] of addresses that this process has
std::size_t own_memory() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

void confine(const Limits& limits, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);  // it died before
  const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  ::dup2(null, STDIN_FILENO);
  ::dup2(null, STDOUT_FILENO);
  if (!kSanitized) ::dup2(null, STDERR_FILENO);
  const auto seconds = static_cast<rlim_t>(std::ceil(limits.time));
  limit(RLIMIT_CORE, 0, 0);
  limit(RLIMIT_FSIZE, 0, 0);
  limit(RLIMIT_CPU, seconds, seconds + 1);
  if (kSanitized) return;
  const rlim_t memory = own_memory() + limits.memory;
  limit(RLIMIT_AS, memory, memory);
}

void write_all(int to, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(to, bytes.data(), bytes.size());
    if (n <= 0) ::_exit(1);
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
}

// noexcept: an exception that escaped would go on in a second copy of the program
[[noreturn]] void be_child(int to, const Limits& limits, pid_t parent,
                           const std::function<std::string()>& work) noexcept {
  char kind = kError;
  std::string bytes;
  try {
    confine(limits, parent);
    bytes = work();
    kind = kResult;
  } catch (const std::bad_alloc&) {
    kind = kNoMemory;
  } catch (const std::exception& e) {
    bytes = e.what();
  } catch (...) {
    bytes = "an exception without words";
  }
  write_all(to, bytes);
  write_all(to, {&kind, 1});
  ::_exit(0);
}

// A child with the default for every signal: this process's handlers remove its files, and must
// not run there.
pid_t fork_child(const std::array<int, 2>& ends, const Limits& limits,
                 const std::function<std::string()>& work) {
  const pid_t parent = ::getpid();
  sigset_t all;
  sigset_t before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  const pid_t child = ::fork();
  if (child == 0) {
    for (int s = 1; s < NSIG; ++s) ::signal(s, SIG_DFL);
    ::close(ends[0]);
  }
  const int error = errno;
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (child == 0) be_child(ends[1], limits, parent, work);
  errno = error;
  return child;
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
    if (bytes.size() + static_cast<std::size_t>(n) > limits.result) {
      throw Unfinished(fmt::format("makes more than {} MB", limits.result >> 20));
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
  pid_t child = -1;
  if (::pipe2(ends.data(), O_CLOEXEC) == 0) {
    child = fork_child(ends, limits, work);
    const int error = errno;
    ::close(ends[1]);
    if (child < 0) ::close(ends[0]);
    errno = error;
  }
  if (child < 0) {
    throw std::runtime_error(fmt::format("cannot start a child process: {}", std::strerror(errno)));
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
  const char kind = bytes.empty() ? '\0' : bytes.back();
  if (kind == kNoMemory) {
    throw Unfinished(fmt::format("needs more than {} MB", limits.memory >> 20));
  }
  if (kind != kError && kind != kResult) throw Unfinished("ends without a result");
  bytes.pop_back();
  if (kind == kError) throw std::runtime_error(bytes);
  return bytes;
}

}  // namespace tauext

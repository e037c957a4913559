// SPDX-License-Identifier: Apache-2.0
#include "bench/program/realtime.h"

#include <fmt/format.h>
#include <sched.h>
#include <sys/mman.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <stdexcept>

namespace tauext {
namespace {

[[noreturn]] void refuse(const char* what) {
  const int reason = errno;
  throw std::runtime_error(fmt::format(
      "--realtime: {}: {}. Allow it to the program: sudo setcap cap_sys_nice,cap_ipc_lock+ep "
      "PROGRAM; or to a user, in /etc/security/limits.d/realtime.conf: 'USER - rtprio 99' and "
      "'USER - memlock unlimited', and log in anew",
      what, std::strerror(reason)));
}

// pages of the stack that the loop will need are there before it begins
void touch_stack() {
  std::array<volatile std::byte, 256 * 1024> pages;
  for (std::size_t i = 0; i < pages.size(); i += 4096) pages[i] = std::byte{0};
}

}  // namespace

Realtime::Realtime(int priority) {
  if (priority < 1 || priority > 99) {
    throw std::invalid_argument(fmt::format("--realtime {}: a priority is 1 to 99", priority));
  }
  if (::mlockall(MCL_CURRENT | MCL_FUTURE) != 0) refuse("cannot keep its memory in RAM");
  touch_stack();
  const sched_param first{.sched_priority = priority};
  if (::sched_setscheduler(0, SCHED_FIFO, &first) == 0) return;
  const int reason = errno;
  ::munlockall();
  errno = reason;
  refuse("cannot be scheduled before others");
}

Realtime::~Realtime() {
  const sched_param ordinary{};
  ::sched_setscheduler(0, SCHED_OTHER, &ordinary);
}

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
// A process in a network of its own, in which multicast goes by lo.
#pragma once

#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <string>

namespace tauext::test {

inline constexpr int kForbidden = 99;  // no such network here

// what `body` returns (0 to 98), run in a child
inline int in_own_network(const std::function<int()>& body) {
  const pid_t child = ::fork();
  if (child < 0) return kForbidden;
  if (child == 0) {
    const std::string root = "0 " + std::to_string(::getuid()) + " 1";  // who we are, inside
    if (::unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0 ||
        !(std::ofstream("/proc/self/uid_map") << root).flush() ||
        std::system("ip link set lo up multicast on && ip route add 224.0.0.0/4 dev lo") != 0) {
      ::_exit(kForbidden);
    }
    ::_exit(body());
  }
  int status = 0;
  return ::waitpid(child, &status, 0) == child && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace tauext::test

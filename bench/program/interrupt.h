// SPDX-License-Identifier: Apache-2.0
/// @file
/// Ctrl-C and kill as something to be asked for.
#pragma once

#include <atomic>
#include <csignal>

namespace tauext {

/// From its construction on the first SIGINT, SIGTERM or SIGHUP is only noted; a second one acts as
/// ever, should the first not help. Make it when all that could hang has been set up.
class Interrupt {
 public:
  Interrupt() {
    struct sigaction action {};
    action.sa_handler = [](int) { seen_ = true; };
    action.sa_flags = SA_RESETHAND;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    sigaction(SIGHUP, &action, nullptr);
  }
  /// Whether there was one.
  bool seen() const { return seen_; }

 private:
  static inline std::atomic<bool> seen_ = false;
};

}  // namespace tauext

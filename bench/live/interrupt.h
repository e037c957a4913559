// SPDX-License-Identifier: Apache-2.0
/// @file
/// Ctrl-C and kill as something to be asked for.
#pragma once

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>

namespace tauext::live {

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
  bool seen() const { return seen_; }

 private:
  static inline std::atomic<bool> seen_ = false;
};

/// [s] since then.
inline double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// [us] since then.
inline std::int64_t microseconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() -
                                                               begin)
      .count();
}

/// Whether a run is over: interrupted, or `duration` [s] after its begin, if that is not 0.
inline bool over(const Interrupt& interrupt, std::chrono::steady_clock::time_point begin,
                 double duration) {
  return interrupt.seen() || (duration > 0 && seconds_since(begin) > duration);
}

}  // namespace tauext::live

// SPDX-License-Identifier: Apache-2.0
/// @file
/// When a run is over.
#pragma once

#include <chrono>
#include <cstdint>

#include "bench/program/interrupt.h"

namespace tauext::live {

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

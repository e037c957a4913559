// SPDX-License-Identifier: Apache-2.0
/// @file
/// A loop that other programs, and the disk, do not keep waiting.
#pragma once

namespace tauext {

/// While it lives, this thread and those that it starts are scheduled before all ordinary ones
/// (SCHED_FIFO; the started ones stay so). From its construction on all memory of the process stays
/// in RAM, what is asked for later and new stacks included.
class Realtime {
 public:
  static constexpr int kUsual =
      20;  ///< [1] above ordinary programs, below the kernel's own threads

  /// @param priority 1 to 99
  /// @throws std::invalid_argument for another priority; std::runtime_error with the remedy, where
  /// the user may not do that
  explicit Realtime(int priority);
  ~Realtime();
  Realtime(const Realtime&) = delete;
  Realtime& operator=(const Realtime&) = delete;
};

}  // namespace tauext

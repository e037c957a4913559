// SPDX-License-Identifier: Apache-2.0
/// @file
/// What a network does to a stream of measurements: late, repeated, swapped and lost ones.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "lcmtypes/reading.h"
#include "lcmtypes/sequence.h"

namespace tauext {

/// What to do with a reading that has arrived.
enum class Arrival : std::uint8_t {
  kNext,      ///< newer than all before: give it to the estimator
  kRestart,   ///< the sender has started anew: reset the estimator, then give it
  kRepeated,  ///< the time of the newest one: drop it
  kLate,      ///< older than the newest one, or overtaken: an estimator cannot use it
};

/// Puts readings into order by dropping what comes too late, and counts what became of them. A
/// sender whose clock goes back (it was restarted, or one false time stamp lay far ahead) is
/// believed after Sequence::kPatience late readings that are in order among themselves.
class Arrivals {
 public:
  /// Readings.
  struct Counts {
    std::int64_t used = 0;                              ///< given to the estimator
    std::int64_t repeated = 0, late = 0, restarts = 0;  ///< as Arrival says
    /// Never came: by seq where the type has one (sequence.h); else whole periods that are missing,
    /// the period being the median of the last ones.
    std::int64_t lost = 0;
  };

  /// Says what to do with the next one that has come, and counts it.
  Arrival take(const Reading& reading) noexcept;
  const Counts& counts() const { return counts_; }  ///< since the begin

 private:
  Arrival accept(const Reading& r, Arrival as) noexcept;
  void count_period(std::int64_t step) noexcept;
  std::int64_t period() const noexcept;

  Counts counts_;
  Sequence sequence_;
  bool any_ = false;
  std::int64_t newest_ = 0;  // [us] of what was used
  std::int64_t last_late_ = 0;
  int late_in_order_ = 0;
  std::array<std::int64_t, 31> periods_{};  // [us]
  std::size_t periods_known_ = 0;
};

}  // namespace tauext

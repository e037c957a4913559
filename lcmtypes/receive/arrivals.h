// SPDX-License-Identifier: Apache-2.0
/// @file
/// What a network does to a stream of measurements: late, repeated, swapped and lost ones, and
/// those of somebody else.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "lcmtypes/reading.h"
#include "lcmtypes/receive/account.h"
#include "lcmtypes/receive/senders.h"
#include "lcmtypes/receive/sequence.h"

namespace tauext {

/// What to do with a reading that has arrived.
enum class Arrival : std::uint8_t {
  kNext,      ///< newer than all before: give it to the estimator
  kRestart,   ///< the sender has started anew: reset the estimator, then give it
  kRepeated,  ///< the time of the newest one: drop it
  kLate,      ///< older than the newest one, or overtaken: an estimator cannot use it
  kOther,     ///< of another sender on the same channel: drop it
};

/// Puts readings into order by dropping what comes too late, and counts what became of them. A
/// sender whose clock goes back (it was restarted, or one false time stamp lay far ahead) is
/// believed after Sequence::kPatience late readings that are in order among themselves.
class Arrivals {
 public:
  /// Readings. Lost are, by seq, those that never came (sequence.h); where the type has no seq,
  /// whole periods that are missing, the period being the median of the last ones.
  struct Counts : Account {
    std::int64_t restarts = 0;  ///< of the sender
    /// Positions jumped to and fro kPatience times within a second, which no arm does: two share
    /// the channel.
    bool two_arms = false;
  };

  /// Says what to do with the next one that has come, and counts it.
  /// @param sender who sent it; 0: unknown
  /// @param now [us] when it came, on a clock that never goes back
  Arrival take(const Reading& reading, Sender sender, std::int64_t now) noexcept;

  /// A message came and was no good; where it says its number and time, that one is not lost.
  void reject(const Stamp& stamp, Sender sender) noexcept;

  /// A sender says that it has ended, and how many messages it has sent; believed if the channel is
  /// its own.
  void end(std::int64_t sent, Sender sender) noexcept;

  const Counts& counts() const { return counts_; }  ///< since the begin

  /// Once, if two senders share the channel: in words; else "".
  std::string trouble();

 private:
  Arrival accept(const Reading& r, Arrival as) noexcept;
  Arrival start_anew(const Reading& r) noexcept;
  void look_for_jumps(const Reading& r) noexcept;
  void count_lost() noexcept;
  void find_again(std::int64_t utime) noexcept;
  void count_period(std::int64_t utime) noexcept;
  std::int64_t period() const noexcept;

  Counts counts_;
  Senders senders_;
  Sequence sequence_;
  bool any_ = false;
  std::int64_t newest_ = 0;  // [us] of what was used
  std::int64_t last_late_ = 0;
  int late_in_order_ = 0;
  std::int64_t excused_ = 0;                // messages since the newest that were no good
  std::int64_t lost_ = 0, doubtful_ = 0;    // readings without a number; in a jump not yet believed
  std::array<std::int64_t, 31> periods_{};  // [us]
  std::size_t periods_known_ = 0;
  struct Gap {
    std::int64_t from = 0, to = 0;  // [us] between these
    std::int64_t missing = 0;       // readings without a number
  };
  std::array<Gap, 16> gaps_;  // the newest
  std::size_t oldest_gap_ = 0;
  std::array<Joints, 2> before_{};  // [rad] q of the newest, and of the one before
  std::int64_t jumps_since_ = 0;    // [us] of the sender's clock
  int jumps_ = 0;                   // since then
  bool told_ = false;
};

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Whose messages a channel carries: one sender's, until that one is silent.
#pragma once

#include <cstdint>
#include <string>

#include "lcmtypes/receive/sequence.h"

namespace tauext {

/// Who sent a message: IPv4 address and port. 0: unknown (memq, tcpq and logs do not say).
using Sender = std::uint64_t;

/// "127.0.0.1:40123".
std::string name_of(Sender sender);

/// Two arms on one channel look like one arm that jumps to and fro. So a channel is its first
/// sender's until that one has been silent for half a second, and two that speak in turns are
/// reported. Where senders are unknown, messages out of turn betray them: kPatience within a
/// second.
class Senders {
 public:
  /// Whose a message is.
  enum class Whose : std::uint8_t {
    kOurs,   ///< of the sender that the channel belongs to
    kNew,    ///< of another, to which the channel belongs from now on: the old one is silent
    kOther,  ///< of another one, while the first still speaks: not to be used
  };

  /// @param now [us] on a clock that never goes back
  Whose take(Sender sender, std::int64_t now) noexcept;
  /// Our sender says that it has ended: the channel is whose who speaks next.
  void end() noexcept { current_ = 0; }
  /// A message of ours was the next one. Whoever only repeats himself is silent.
  void in_turn(std::int64_t now) noexcept { heard_ = now; }
  /// A message of ours came late, twice, or from where the stream did not go on.
  void out_of_turn(std::int64_t now) noexcept;

  /// Whether the channel is this sender's, or nobody's yet.
  bool is_ours(Sender sender) const noexcept { return current_ == 0 || sender == current_; }

  /// Once: "127.0.0.1:4000 and 127.0.0.1:4001 both send on the channel; ...", or that there must be
  /// two; "" if there is nothing new to say.
  std::string trouble();

 private:
  static constexpr std::int64_t kSilence = 500'000, kSecond = 1'000'000;  // [us]

  Sender current_ = 0, before_ = 0, other_ = 0;
  std::int64_t heard_ = 0;  // [us] from the current one
  bool other_spoke_ = false;
  std::int64_t out_since_ = 0;  // [us]
  int out_ = 0;                 // messages out of turn since then
  bool two_known_ = false, reported_two_ = false;
  bool disorder_ = false, reported_disorder_ = false;  // messages out of turn
};

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// LCM's logs, as lcm-logger writes them and lcm-logplayer and lcm-spy play them.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "lcmtypes/wire.h"

namespace tauext {

/// A log under construction, in memory: who writes it to a file decides how, and sees a full disk.
/// With simulated times it is the same from run to run, byte by byte.
class LogBuffer {
 public:
  /// @param utime [us] time of the event
  void append(std::string_view channel, std::int64_t utime, Bytes message);

  /// The log so far; valid until the next append.
  std::string_view bytes() const { return bytes_; }

 private:
  std::string bytes_;
  std::uint64_t events_ = 0;
};

/// One message of a log; views are valid during the call.
struct LogEvent {
  std::int64_t utime = 0;    ///< [us]
  std::string_view channel;  ///< its name
  Bytes message;             ///< not yet decoded
};

/// What a log had beside good events.
struct LogFaults {
  std::int64_t junk_bytes = 0;      ///< between events, skipped
  std::int64_t junk_stretches = 0;  ///< places where such bytes lie
  bool truncated = false;           ///< the last event is cut off
};

/// Hands every good event of a log on, in its order; skips what is none.
/// @throws std::runtime_error naming the path: unreadable, or no event in it
LogFaults read_log(const std::string& path, const std::function<void(const LogEvent&)>& handler);

}  // namespace tauext

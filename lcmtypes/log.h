// SPDX-License-Identifier: Apache-2.0
/// @file
/// LCM's logs, as lcm-logger writes them and lcm-logplayer and lcm-spy play them.
#pragma once

#include <lcm/eventlog.h>

#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <string_view>

#include "lcmtypes/wire.h"

namespace tauext {

/// A log under construction, in memory: who writes it to a file decides how, and sees a full disk.
/// With simulated times it is the same from run to run, byte by byte.
class LogBuffer {
 public:
  LogBuffer();
  ~LogBuffer();
  LogBuffer(const LogBuffer&) = delete;
  LogBuffer& operator=(const LogBuffer&) = delete;

  /// @param utime [us] time of the event
  /// @throws std::runtime_error if memory is out
  void append(const char* channel, std::int64_t utime, Bytes message);

  /// The log so far; valid until the next append.
  std::string_view bytes();

 private:
  char* text_ = nullptr;
  std::size_t size_ = 0;
  lcm_eventlog_t log_{};
};

/// One message of a log; views are valid during the call.
struct LogEvent {
  std::int64_t utime = 0;  ///< [us]
  std::string_view channel;
  Bytes message;
};

/// What a log had beside good events.
struct LogFaults {
  std::int64_t junk_bytes = 0;  ///< between events, skipped
  std::int64_t junk_stretches = 0;
  bool truncated = false;  ///< the last event is cut off
};

/// Hands every good event of a log on, in its order; skips what is none.
/// @throws std::runtime_error naming the path: unreadable, or no event in it
LogFaults read_log(const std::string& path, const std::function<void(const LogEvent&)>& handler);

}  // namespace tauext

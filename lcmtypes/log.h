// SPDX-License-Identifier: Apache-2.0
/// @file
/// LCM's logs, as lcm-logger writes them and lcm-logplayer and lcm-spy play them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

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

/// One message of a log; its views are valid until the next one is read.
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

/// The good events of a log, one after the other; what is none is skipped.
class LogEvents {
 public:
  /// @throws std::runtime_error naming the path, if it cannot be read
  explicit LogEvents(const std::string& path);

  /// The next one, whose views are valid until the next call; false at the end.
  /// @throws std::runtime_error naming the path: unreadable, or no event in it
  bool next(LogEvent& event);
  const LogFaults& faults() const { return faults_; }  ///< so far

 private:
  bool fill(std::size_t wanted);
  void read_more(std::size_t bytes);
  std::size_t next_event();
  bool believable(std::size_t length);
  LogEvent event() const;
  [[noreturn]] void fail(const char* what) const;

  std::string path_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  std::int64_t left_ = 0;  // bytes not yet read
  std::vector<unsigned char> buffer_;
  std::size_t begin_ = 0, end_ = 0;  // of what was read and not used
  std::size_t used_ = 0;             // of that, the event that was handed out
  bool any_ = false, in_junk_ = false;
  LogFaults faults_;
};

/// Hands every good event of a log on, in its order.
/// @throws std::runtime_error as LogEvents does
LogFaults read_log(const std::string& path, const std::function<void(const LogEvent&)>& handler);

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// A recorded log of any kind.
#pragma once

#include <cstdint>
#include <string>

#include "mjcf/trace/trace.h"

namespace tauext {

/// A log, and how much of it could not be used.
struct RecordedLog {
  Trace trace;               ///< what could be used
  std::int64_t skipped = 0;  ///< rows, or messages of the channel
  /// Whether a joint moves at least twice as fast as its qd says, at most half as fast, or the
  /// other way.
  bool contradicts = false;
  /// Whether most of it could be used, and q and qd agree: else it is not the log that one means.
  bool usable() const { return skipped <= trace.size() && !contradicts; }
  /// Asked by programs that write down what they learn from it.
  /// @throws std::invalid_argument if q and qd contradict each other
  void require_consistent(const std::string& path) const;
};

/// How a log is to be read.
struct LogOptions {
  /// of an LCM log the channel, of a ROS 2 bag the topic; "": the only one that holds measurements
  std::string channel;
  /// of any other log a preset or a TOML file of mjcf/trace/read/column_map.h; "": ours
  std::string columns;
  bool currents = false;  ///< whether tau may be currents, which Robot::make_torques() then mends
};

/// A recorded log: LCM, CSV, .npy, .npz or a ROS 2 bag. What was skipped, what is irregular in it,
/// and what can hardly be in the units of a Trace, goes to standard error.
/// @throws std::runtime_error or std::invalid_argument naming the path and the reason
RecordedLog read_any_log(const std::string& path, const LogOptions& options = {});

}  // namespace tauext

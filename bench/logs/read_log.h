// SPDX-License-Identifier: Apache-2.0
/// @file
/// A recorded log of either kind.
#pragma once

#include <cstdint>
#include <string>

#include "mjcf/trace/trace.h"

namespace tauext {

/// A log, and how much of it could not be used.
struct RecordedLog {
  Trace trace;               ///< what could be used
  std::int64_t skipped = 0;  ///< rows, or messages of the channel
  /// Whether not most of it was skipped: else the log is something else than one thinks.
  bool usable() const { return skipped <= trace.size(); }
};

/// A recorded log, CSV or LCM; what was skipped goes to standard error.
/// @param channel of an LCM log; "": the only one that holds measurements
/// @throws std::runtime_error naming the path and the reason
RecordedLog read_log_or_csv(const std::string& path, const std::string& channel = "");

}  // namespace tauext

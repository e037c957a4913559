// SPDX-License-Identifier: Apache-2.0
/// @file
/// Traces as LCM logs (lcm_reader.h reads them).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lcmtypes/log.h"
#include "lcmtypes/reading.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// [us] of a time [s].
std::int64_t utime_of(double t);

/// The samples of a trace as they travel; its truth, if it has one, or else the driver's own
/// estimate as their reference. Times below 0,
/// which messages do not have, are shifted so that the first is 0.
/// @throws std::invalid_argument for an arm of more than 8 joints
std::vector<Reading> readings_of(const Trace& trace);

/// Adds a trace's samples to a log, on TAUEXT_SAMPLE, IIWA_STATUS or PANDA_STATUS.
void append_samples(const std::vector<Reading>& readings, MessageType type, LogBuffer& log);

/// @throws std::runtime_error if a URL means a log in the place of a file that this program reads
void refuse_input_as_log(const std::string& url);

/// Whether a path names an LCM log: it ends in .lcm, or is lcm-logger's lcmlog-DATE.
bool is_lcm_log(const std::string& path);

}  // namespace tauext

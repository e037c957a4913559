// SPDX-License-Identifier: Apache-2.0
/// @file
/// Traces as LCM logs, and back.
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
/// estimate as their reference. Times below
/// 0, which messages do not have, are shifted so that the first is 0.
/// @throws std::invalid_argument for an arm of more than 8 joints
std::vector<Reading> readings_of(const Trace& trace);

/// Adds a trace's samples to a log, on TAUEXT_SAMPLE, IIWA_STATUS or PANDA_STATUS.
void append_samples(const std::vector<Reading>& readings, MessageType type, LogBuffer& log);

/// What a log had beside the samples that were used.
struct LogReport {
  std::string channel;        ///< that was read
  std::int64_t rejected = 0;  ///< messages on it that were no good, or of another number of joints
  std::int64_t out_of_order = 0;  ///< late or repeated
  std::int64_t lost = 0;          ///< never recorded
  bool two_arms = false;          ///< as Arrivals says
  LogFaults faults;               ///< of the file
  /// "" if there was nothing of that, else in words.
  std::string in_words() const;
};

/// Reads a log's measurements from one channel: by its name, or "" for the only one that has any
/// (of several, TAUEXT_SAMPLE). Times count from 0 if they are those of a wall clock (more than
/// 10^8 s).
/// @throws std::runtime_error naming path and reason: unreadable, no such channel, several to
/// choose from
Trace read_lcm(const std::string& path, const std::string& channel, LogReport* report);

/// @throws std::runtime_error if a URL means a log in the place of a file that this program reads
void refuse_input_as_log(const std::string& url);

/// Whether a path names an LCM log: it ends in .lcm, or is lcm-logger's lcmlog-DATE.
bool is_lcm_log(const std::string& path);

}  // namespace tauext

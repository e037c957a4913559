// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the programs share: flags of the plant and the sensors, exit codes, error messages.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "mjcf/record.h"

namespace tauext {

/// Exit codes of all programs.
enum ExitCode : int {
  kGood = 0,         ///< done, and the answer is good
  kAnswerIsNo = 1,   ///< done, but an entry failed
  kCouldNotRun = 2,  ///< wrong flags, unreadable input, unwritable output
};

/// Adds the flags of the sensors' faults, the model's errors, a file of both, --seed, --kp and --kd.
void add_recording_flags(CLI::App& app, Sensors& sensors, ModelError& error, Recording& recording);

/// Parses and runs; prints help, version and errors as "<program>: <what>"; returns the exit code.
int run_program(CLI::App& app, int argc, char** argv, const std::function<int()>& body);

/// Says on standard error what read_csv left out, if anything.
void report_skipped(const SkippedRows& skipped, const std::string& log);

/// A recorded log, CSV or LCM; what was skipped goes to standard error.
/// @throws std::runtime_error naming the path and the reason
Trace read_log_or_csv(const std::string& path, const std::string& channel);

/// @throws std::invalid_argument if writing `out` would overwrite the log that is read
void refuse_same_file(const std::string& log, const std::string& out);

/// "name  description" lines of everything the roster and the scenarios hold.
std::string list_known();

}  // namespace tauext

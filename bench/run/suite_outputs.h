// SPDX-License-Identifier: Apache-2.0
/// @file
/// A run of the suite that leaves more than its tables and its JSON. Not installed.
#pragma once

#include <optional>
#include <string>

#include "bench/run/suite/suite_run.h"

namespace tauext {

/// What a run leaves beside its tables and its JSON.
struct SuiteOutputs {
  bool paper = false;                  ///< whether Table III is printed beside ours
  std::optional<std::string> report;   ///< file for the page of the results
  std::string wrench;                  ///< the point of which it shows forces; "": none
  std::optional<std::string> lcm;      ///< URL for summaries
  std::optional<std::string> lcm_log;  ///< folder for logs
};

/// run_suite(), with these.
/// @returns the exit code
/// @throws as run_suite() does, and std::invalid_argument for a point that a robot does not have
int run_suite_with_outputs(const SuiteRun& run, const SuiteOutputs& outputs);

}  // namespace tauext

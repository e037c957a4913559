// SPDX-License-Identifier: Apache-2.0
/// @file
/// A run of the suite inside Google Benchmark, and what it leaves: tables, JSON, logs and messages.
/// Not installed.
#pragma once

#include <optional>
#include <string>

#include "bench/score/entry.h"
#include "bench/score/suite.h"
#include "mjcf/trace/table_writer.h"

namespace tauext {

/// What tauext-bench was asked for.
struct SuiteRun {
  SuiteOptions suite;
  Selection selection;
  bool all = true;          ///< whether Google Benchmark's filter lets every entry pass
  bool paper = false;       ///< whether Table III is printed beside ours
  bool list_tests = false;  ///< whether Google Benchmark lists and runs nothing
  TableFormat format = TableFormat::kText;  ///< of the tables
  std::optional<std::string> display;       ///< Google Benchmark's own format on standard output
  std::optional<std::string> out;           ///< file for the results as JSON
  std::optional<std::string> report;        ///< file for the page of the results
  std::string wrench;                       ///< the point of which it shows forces; "": none
  std::optional<std::string> lcm;           ///< URL for summaries
  std::optional<std::string> lcm_log;       ///< folder for logs
};

/// Scores and times the entries, and prints their tables.
/// @returns the exit code
/// @throws std::invalid_argument for a selection or a format that is unknown, and if nothing ran
int run_suite(const SuiteRun& run);

}  // namespace tauext

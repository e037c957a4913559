// SPDX-License-Identifier: Apache-2.0
/// @file
/// A run of the suite inside Google Benchmark, its tables and its JSON. Not installed.
#pragma once

#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/score/entry.h"
#include "bench/score/suite.h"
#include "bench/score/table.h"
#include "mjcf/trace/table_writer.h"

namespace tauext {

/// What the suite is asked for.
struct SuiteRun {
  SuiteOptions suite;
  Selection selection;
  std::string filter;                       ///< Google Benchmark's: BenchmarkFlags::filter()
  bool list_tests = false;                  ///< whether Google Benchmark lists and runs nothing
  TableFormat format = TableFormat::kText;  ///< of the tables
  std::optional<std::string> display;       ///< Google Benchmark's own format on standard output
  std::optional<std::string> out;           ///< file for the results as JSON
};

/// What is there after a run.
struct SuiteResults {
  Suite& suite;
  const std::vector<Row>& rows;  ///< that ran
  std::string json;              ///< all of it
  std::string line;              ///< what they depend on, for provenance()
  std::FILE* words;              ///< where sentences go
};

/// Who is told of a run; each may be empty.
struct SuiteHooks {
  /// Every entry, once all else has been checked and before anything runs.
  std::function<void(const std::vector<Row>&)> begin;
  /// An entry that was scored, and what was judged. What it throws becomes the entry's error.
  std::function<void(const Row&, const Suite::Run&)> scored;
  /// An entry that is done, with its time if it was timed.
  std::function<void(const Row&)> through;
  std::function<void(const SuiteResults&)> printed;  ///< after the tables
  /// After that, and after the JSON if a file was asked for.
  std::function<void(const SuiteResults&)> written;
};

/// Scores and times the entries, and prints their tables.
/// @returns the exit code
/// @throws std::invalid_argument for a selection or a format that is unknown, and if nothing ran
int run_suite(const SuiteRun& run, const SuiteHooks& hooks = {});

}  // namespace tauext

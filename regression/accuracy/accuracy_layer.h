// SPDX-License-Identifier: Apache-2.0
/// @file
/// T0, T1 and T2: scores every entry by a program that was built, and compares with what was
/// committed.
#pragma once

#include <functional>
#include <string>

#include "regression/accuracy/accuracy.h"

namespace tauext::gate {

/// What is scored.
struct AccuracyOptions {
  std::string bench;                                 ///< program with --golden
  std::string entries;                               ///< regular expression; empty: all
  std::string baselines;                             ///< folder
  std::function<void(const std::string&)> progress;  ///< may be empty
};

/// Scores every entry, the first seed twice. Without a file of golden metrics: no_baseline.
/// @throws std::invalid_argument for a filter that matches nothing of the file, std::runtime_error
/// for files and programs
AccuracyReport score_and_compare(const AccuracyOptions& options);

/// A program's golden metrics of the entries that match, as it writes them.
/// @param seeds "" for the program's own
/// @throws std::runtime_error naming the program, if it fails
std::string run_bench(const std::string& bench, const std::string& entries,
                      const std::string& seeds = "");

/// Path of the golden metrics in a folder of baselines.
std::string golden_path(const std::string& folder);

}  // namespace tauext::gate

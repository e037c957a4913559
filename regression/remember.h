// SPDX-License-Identifier: Apache-2.0
/// @file
/// The subcommands append and history: what every commit measured, and what added up.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "bench/program/exit_code.h"
#include "regression/history/history.h"

namespace tauext::gate {

/// What they are asked for.
struct HistoryFlags {
  std::string file, markdown, charts;
  MeasureOptions measure;
  bool all = false;
};

/// Adds both; `f` has their defaults.
void add_history(CLI::App& app, HistoryFlags& f);

/// Measures a commit and adds its line to the file.
/// @return kGood  @throws as measure and read_history do
ExitCode append(const HistoryFlags& f);

/// Prints what the file says of its last commit.
/// @return kSlower if something drifted, else kLessAccurate if metrics did, else kGood
/// @throws std::runtime_error as read_history does, and for a file without a record
ExitCode show_history(const HistoryFlags& f);

}  // namespace tauext::gate

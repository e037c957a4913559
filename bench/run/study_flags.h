// SPDX-License-Identifier: Apache-2.0
/// @file
/// The studies that tauext-bench runs instead of its suite, by flags.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/score/suite.h"

namespace CLI {
class App;
}

namespace tauext {

/// What is studied, of which robot, and where it goes.
struct StudyFlags {
  std::vector<std::uint64_t> seeds;       ///< of the suite's scores over seeds; none: not asked for
  std::string against = "mo2";            ///< with whom they are compared
  bool pareto = false;                    ///< whether that study is asked for
  std::optional<double> equal_bandwidth;  ///< [rad/s]
  Selection selection;  ///< of seeds; its robot, else the first one, and estimators of the last two
  std::string filter;   ///< regular expression on the entries of seeds; "": all
  std::optional<std::string> format;  ///< of all tables, as table_format() knows it; else text
  std::optional<std::string> out;     ///< file, else standard output

  /// How many are asked for.
  int studies() const { return pareto + equal_bandwidth.has_value() + !seeds.empty(); }
};

/// Numbers and ranges apart by commas, like 1-30,40.
/// @param flag that has them, for errors
/// @throws std::invalid_argument for anything else, and for more than 10,000 of them
std::vector<std::uint64_t> seeds_of(const std::string& text, const char* flag = "--seeds");

/// Adds --equal-bandwidth, --pareto and --out of these, and --format of all tables.
void add_study_flags(CLI::App& app, StudyFlags& flags);

/// Whether a study was asked for.
/// @throws std::invalid_argument for a flag of the studies without a study, a format that is none,
/// and two studies in one file of another format than text
bool wants_study(const StudyFlags& flags);

/// Runs what was asked for, and writes it; the file appears whole or not at all.
/// @param suite of --seeds
/// @returns an ExitCode
/// @throws std::invalid_argument for sensors, a seed and model errors that a study would not use
int run_study(const StudyFlags& flags, const SuiteOptions& suite);

}  // namespace tauext

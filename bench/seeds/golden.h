// SPDX-License-Identifier: Apache-2.0
/// @file
/// Golden metrics: what every entry scores, seed by seed and to the last digit, as the text that
/// tauext-gate compares and regression/baselines/ keeps.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bench/score/suite.h"

namespace tauext {

/// What is scored.
struct GoldenOptions {
  SuiteOptions suite;   ///< its sensors, if they are not ideal, instead of golden_sensors()
  Selection selection;  ///< whose entries
  std::vector<std::uint64_t> seeds = {1, 2, 3, 4, 5};  ///< of the sensors
  std::string filter;                    ///< regular expression on the entries' names; "": all
  std::string built;                     ///< who made it, for people
  int threads = 0;                       ///< 0: one a core
  std::function<void(double)> progress;  ///< called with the share that is done; may be empty
};

/// What an entry's scenario has behind its name where its sensors are the degraded ones.
inline constexpr const char* kDegraded = "@degraded";

/// Sensors of a good robot, 1e-3 rad/s of velocity noise and an encoder of 17 bits: with ideal ones
/// nothing would depend on the seed, and a paired comparison needs seeds.
Sensors golden_sensors();

/// Sensors of a poor one: ten times the noise, 14 bits, a loadcell with all its faults, late and
/// lost samples.
Sensors degraded_sensors();

/// The entries of golden metrics: the suite's, and unless somebody selects, each detector that
/// stands in the studies alone behind the paper's first estimator.
std::vector<Entry> golden_entries(const Selection& selection = {});

/// Lines "# name: value" of what the numbers depend on, then a line for each entry and metric,
/// sorted: entry, metric and a value for each seed, apart by tabs. Values are %.17g, "never" where
/// the metric has none or is no number. "# contacts: .." names the scenarios in which something
/// stands in the arm's way. The metrics are those that the list calls gated
/// (bench/score/metric_list.h), of the worst joint and, where the list says so, of each. Scenarios
/// step and collision are there a second time with degraded_sensors(), named with kDegraded behind
/// them, unless the options have sensors or a model error of their own. The text does not depend on
/// the number of threads.
/// @throws std::invalid_argument for a filter that matches nothing or is no regular expression, and
/// for no seed
std::string golden_metrics(const GoldenOptions& options);

}  // namespace tauext

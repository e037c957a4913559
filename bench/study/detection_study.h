// SPDX-License-Identifier: Apache-2.0
/// @file
/// Every estimator with every detector on one robot, under conditions that it meets: what is
/// missed, how late, how often for nothing, and what a human's push or a slow clamping is taken
/// for.
///
/// Each run is simulated once and seen by all; each condition adds its own sensors. Every figure is
/// a count or a quantile over runs that are numbered, so it does not depend on the number of
/// threads.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bench/roster/thresholds.h"
#include "bench/study/study_counts.h"

namespace tauext::study {

/// How much is tried, and what of it.
struct StudyOptions {
  std::string robot;                    ///< "" for the first one that has runs
  std::vector<std::string> conditions;  ///< by name; empty: all
  std::vector<std::string> estimators;  ///< specifications; empty: all but the baselines
  std::vector<std::string> detectors;   ///< specifications; empty: all
  int blows = 500;                      ///< at least so many for each condition
  int brisk_pushes = 100;               ///< at least so many for each condition
  int clampings = 100;                  ///< at least so many for each condition
  int regions = 0;   ///< at least so many meetings of each of region_classes(), likewise
  double hours = 1;  ///< [h] of slow pushes and free motion, at least, for each condition
  std::uint64_t first_seed = 1;          ///< of the runs: first_seed, first_seed + 1, ...
  int threads = 0;                       ///< 0: one a core
  std::function<void(double)> progress;  ///< called with the share that is done; may be empty
};

/// @throws std::invalid_argument for a robot without runs, for unknown names, and for seeds that
/// reach those of calibration
void check_study(const StudyOptions& options);

/// Runs the study. Cells are ordered by condition, estimator, detector.
/// @throws std::invalid_argument as check_study does
std::vector<Cell> detection_study(const StudyOptions& options, const Thresholds& thresholds);

}  // namespace tauext::study

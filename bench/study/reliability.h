// SPDX-License-Identifier: Apache-2.0
/// @file
/// How reliable a detector is behind an estimator: many blows that it must mark, and hours of a
/// human's hand that it must leave in peace. On a robot whose scenarios can be drawn by a seed.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "mjcf/trace/sensors.h"
#include "mjcf/trace/table_writer.h"

namespace tauext::study {

/// One pair's record.
struct Reliability {
  std::string estimator, detector;  ///< specifications
  int blows = 0;                    ///< drawn by seeds 1, 2, ...
  int missed = 0;                   ///< without a mark until metrics::kGrace after the blow
  int stray = 0;                    ///< marks in these runs outside that window
  double delay_p50 = 0;             ///< [s] median delay of the marked ones; NaN without
  double delay_p95 = 0;             ///< [s] their 95th percentile
  double hours = 0;                 ///< [h] of a hand that moves the arm, drawn by seeds 1, 2, ...
  int alarms = 0;                   ///< marks in them
};

/// How much is tried, and through which sensors; the sensors' seed is that of the run.
struct Trials {
  std::string robot = "";  ///< "" for the first one that has such runs
  int blows = 200;         ///< to be run
  int manual_runs = 120;   ///< of 30 s each: an hour
  Sensors sensors;         ///< of the robot
};

/// Every estimator of the roster that is no baseline, with every detector of the suite.
/// @param progress called with the share that is done, 0 to 1; may be empty
/// @throws std::invalid_argument for an unknown robot, and for one without such runs
std::vector<Reliability> reliability(const Trials& trials,
                                     const std::function<void(double)>& progress = nullptr);

/// What was tried, and what came of it.
struct Tried {
  Trials trials;                  ///< what was run
  std::vector<Reliability> rows;  ///< of each pair
};

/// As text a table for each of them, and what the columns mean; else one table with a column of the
/// velocity noise.
std::string format_reliability(const std::vector<Tried>& all,
                               TableFormat format = TableFormat::kText);

}  // namespace tauext::study

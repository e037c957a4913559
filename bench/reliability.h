// SPDX-License-Identifier: Apache-2.0
/// @file
/// How reliable a detector is behind an estimator: many blows that it must mark, and hours of a human's
/// hand that it must leave in peace. On testbed1, whose scenarios can be drawn by a seed.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "mjcf/sensors.h"

namespace tauext {

/// One pair's record.
struct Reliability {
  std::string estimator, detector;
  int blows = 0;         ///< of blow_on_testbed1, seeds 1, 2, ...
  int missed = 0;        ///< without a mark until 0.2 s after the blow
  int stray = 0;         ///< marks in these runs outside that window
  double delay_p50 = 0;  ///< [s] median delay of the marked ones; NaN without
  double delay_p95 = 0;  ///< [s] their 95th percentile
  double hours = 0;      ///< [h] of manual_of_testbed1, seeds 1, 2, ...
  int alarms = 0;        ///< marks in them
};

/// How much is tried, and through which sensors; the sensors' seed is that of the run.
struct Trials {
  int blows = 200;
  int manual_runs = 120;  ///< of 30 s each: an hour
  Sensors sensors;
};

/// Every estimator of the roster that is no baseline, with every detector of the suite.
/// @param progress called with the share that is done, 0 to 1; may be empty
std::vector<Reliability> reliability(const Trials& trials,
                                     const std::function<void(double)>& progress = nullptr);

/// A table of them, one head above: what was tried.
std::string format_reliability(const Trials& trials, const std::vector<Reliability>& rows);

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Detector thresholds from training runs in which nothing is hit.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bench/roster/thresholds.h"

namespace tauext::study {

/// The first seed of calibration; test seeds stay below.
inline constexpr std::uint64_t kTrainingSeed = 1'000'000;

/// How thresholds are set.
struct CalibrationOptions {
  std::string robot;    ///< "" for the first one that has runs
  double margin = 1.3;  ///< [1] threshold over the largest value in training, as an amplitude
  std::vector<std::string> conditions;   ///< trained on; empty: those that the robot's runs name
  std::vector<std::string> estimators;   ///< specifications; empty: all but the baselines
  std::vector<std::string> detectors;    ///< specifications, beside all that can be calibrated
  int runs = 20;                         ///< of 30 s for each condition
  int threads = 0;                       ///< 0: one a core
  std::function<void(double)> progress;  ///< called with the share that is done; may be empty
};

/// Sets every calibratable detector's thresholds behind every estimator: `margin` times the largest
/// statistic of training runs, free motion and slow pushes alone, for each of the study's velocity
/// noises. A specification with keys is trained for itself.
/// @throws std::invalid_argument for a margin below 1, a robot without runs and unknown names
Thresholds calibrate(const CalibrationOptions& options);

}  // namespace tauext::study

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Detector thresholds from training runs, or from recordings, in which nothing is hit.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bench/roster/robot.h"
#include "bench/roster/thresholds.h"
#include "mjcf/trace/trace.h"

namespace tauext::study {

/// How thresholds are set.
struct CalibrationOptions {
  std::string robot;    ///< "" for the first one that has runs
  double margin = 1.3;  ///< [1] threshold over the largest value in training, as an amplitude
  std::vector<std::string> conditions;   ///< trained on; empty: those that the robot's runs name
  std::vector<std::string> estimators;   ///< specifications; empty: all but the baselines
  std::vector<std::string> detectors;    ///< with their parts; empty: all that can be calibrated
  int runs = 20;                         ///< of 30 s for each condition
  int threads = 0;                       ///< 0: one a core
  std::function<void(double)> progress;  ///< called with the share that is done; may be empty
};

/// Sets every calibratable detector's thresholds behind every estimator: `margin` times the largest
/// statistic of training runs, free motion and slow pushes alone, for each of the study's velocity
/// noises. A specification with keys is trained for itself.
/// @throws std::invalid_argument for a margin below 1, a robot without runs and unknown names
Thresholds calibrate(const CalibrationOptions& options);

/// A recording in which nothing touches the arm.
struct FreeRecording {
  std::string name;  ///< for errors
  Trace trace;       ///< what was recorded
};

/// Whether thresholds hold on what they have not seen; a detector's metric has seen all.
struct HeldOut {
  std::string estimator, detector;  ///< specifications
  int recordings = 0;               ///< that were held out, one by one
  int alarms = 0;                   ///< of them, where thresholds from all others would have marked
};

/// The same from recordings, which are all of one set of thresholds; their first kScoreFrom
/// (study_runs.h) do not count.
/// @param options whose robot, conditions and runs have no meaning here
/// @param held_out gets a row for each pair, if there is more than one recording
/// @throws std::invalid_argument also for a recording that is too short, that has a contact, or of
/// which most makes no estimate, naming it
Thresholds calibrate_on(const Robot& robot, const std::vector<FreeRecording>& recordings,
                        const CalibrationOptions& options, std::vector<HeldOut>& held_out);

}  // namespace tauext::study

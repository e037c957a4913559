// SPDX-License-Identifier: Apache-2.0
/// @file
/// Detector thresholds from training runs, or from recordings, in which nothing is hit.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/roster/robot.h"
#include "bench/roster/session/session.h"
#include "bench/roster/thresholds.h"
#include "bench/study/detection/training.h"
#include "mjcf/trace/trace.h"

namespace tauext::study {

/// Sets every calibratable detector's thresholds behind every estimator: `margin` times the largest
/// statistic of training runs, free motion and slow pushes alone, for each of the study's velocity
/// noises. A specification with keys is trained for itself.
/// @throws std::invalid_argument for a margin below 1, a robot without runs and unknown names
Thresholds calibrate(const CalibrationOptions& options);

/// Whether there is a set for this condition alone.
bool are_for(const Thresholds& thresholds, const Robot& robot, const std::string& condition);

/// What a study under these conditions needs, or those of the options, if they name some: a set for
/// each condition alone that trains itself; for others, and if none is named, those of calibrate().
Thresholds calibrate_for(const std::vector<std::string>& conditions,
                         const CalibrationOptions& options);

/// Runs that an estimator has seen: of one clock, and the session that has its estimates.
struct EstimatedRuns {
  std::span<const Trace> traces;     ///< what it saw
  std::unique_ptr<Session> session;  ///< of them
};

/// The same of runs that are there already.
/// @param batches all of them count
/// @param options its margin and its only pair
ThresholdSet calibrate_on(const Robot& robot, std::span<const EstimatedRuns> batches,
                          const CalibrationOptions& options);

/// A recording in which nothing touches the arm.
struct FreeRecording {
  std::string name;  ///< for errors
  Trace trace;       ///< what was recorded
};

/// [s] of a recording, without its gaps.
double watched(const Trace& t);

/// Thresholds from recordings, which are all of one set of thresholds; their first kScoreFrom
/// (study_runs.h) do not count.
/// @param options whose robot, conditions and runs have no meaning here
/// @param held_out gets a row for each pair, if there is more than one recording
/// @throws std::invalid_argument also for a recording that is too short, that has a contact, or of
/// which most makes no estimate, naming it
Thresholds calibrate_on(const Robot& robot, const std::vector<FreeRecording>& recordings,
                        const CalibrationOptions& options, std::vector<HeldOut>& held_out);

}  // namespace tauext::study

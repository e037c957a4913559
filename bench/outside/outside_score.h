// SPDX-License-Identifier: Apache-2.0
/// @file
/// What estimates that were made elsewhere are worth.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "bench/outside/estimates_file.h"
#include "bench/roster/pair.h"
#include "bench/score/score.h"
#include "bench/score/table.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// The run of which they are estimates.
struct OutsideRun {
  const Trace* trace = nullptr;        ///< with its truth, or labels
  std::string group;                   ///< ROBOT/SCENARIO, or the log's name
  const Robot* robot = nullptr;        ///< nullptr if nobody knows it
  const Scenario* scenario = nullptr;  ///< what the run is made of, likewise
  double score_from = 0;               ///< [s] errors count from this time on
  std::string log;                     ///< its name, for errors of one of several
};

/// Puts what a force sensor saw in the place of the vendor's estimate, if the trace has a force and
/// none of that: as the torques with the sign of (3) that such a force at the end effector takes.
void take_sensor(const Robot& robot, Trace& trace);

/// Their scores: errors where the truth is known, marks where contacts are, and with a scenario
/// what that asks for. No time, no noise and no allocations.
Row score_outside(const OutsideRun& run, const OutsideEstimates& estimates);

/// The same of one estimator's estimates of several logs, all samples and marks together.
/// @param runs of one robot and group, without scenarios
/// @param estimates of each of them
Row score_outside(const std::vector<OutsideRun>& runs,
                  const std::vector<OutsideEstimates>& estimates);

/// Estimates, and marks, of one log.
struct LogRun {
  const Trace* trace = nullptr;    ///< the log
  const Output* output = nullptr;  ///< of its samples
  double from = 0;                 ///< [s] samples before it do not count
};

/// What is left while nothing touches, by the labels of the logs: all the time in a log without.
/// Nothing where a log has forces and no labels, which would say when something touches.
void add_floor_metrics(const std::vector<LogRun>& runs, Score& score);

/// How the estimates compare with the vendor's own, joint by joint, where all of the logs have
/// them.
void add_vendor_metrics(const std::vector<LogRun>& runs, Score& score);

/// Marks against the labels of all logs together, with intervals; a log without labels has nothing
/// that touches. Nothing without a detector.
void add_label_metrics(const std::vector<LogRun>& runs, Score& score);

/// The rows as tauext-bench writes them, a benchmark for each.
/// @param context keys and texts that say where they come from
std::string results_json(const std::vector<Row>& rows,
                         const std::vector<std::pair<std::string, std::string>>& context);

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// What can be known of estimates without a truth: from logs in which mostly nothing touches, from
/// labels, and from what the robot's maker estimates.
#pragma once

#include <vector>

#include "bench/roster/stages.h"
#include "bench/score/score.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// Estimates, and marks, of one log.
struct LogRun {
  const Trace* trace = nullptr;    ///< the log
  const Output* output = nullptr;  ///< of its samples
  double from = 0;                 ///< [s] samples before it do not count
};

/// What is left while nothing touches, by the labels of the logs: all the time in a log without.
void add_floor_metrics(const std::vector<LogRun>& runs, Score& score);

/// How the estimates compare with the maker's own, joint by joint, where all of the logs have them.
void add_maker_metrics(const std::vector<LogRun>& runs, Score& score);

/// Marks against the labels of all logs together, with intervals; a log without labels has nothing
/// that touches. Nothing without a detector.
void add_label_metrics(const std::vector<LogRun>& runs, Score& score);

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Pairs of estimator and detector whose parameters were tuned for one condition of the study, as
/// tauext-tune --conditions writes them beside their thresholds.
#pragma once

#include <string>
#include <vector>

#include "bench/roster/robot.h"
#include "bench/roster/thresholds.h"

namespace tauext::study {

/// A pair that was tuned, and what that was worth on the runs on which it was tuned.
struct TunedRow {
  std::string robot, arm;            ///< its name, and Robot::fingerprint()
  std::string condition;             ///< for which it was tuned
  std::string estimator, detector;   ///< specifications, with what was found
  std::string before;                ///< what it was before, as estimator+detector
  double recall = 0;                 ///< [1] mean over kinds of regions, without a false alarm
  double recall_before = 0;          ///< [1] likewise; NaN if it made no estimates
  int evaluations = 0;               ///< that were made
  std::vector<std::string> at_ends;  ///< keys whose best value is at an end of its range
};

/// A file of them.
struct TunedStudy {
  Thresholds thresholds;       ///< a set for each condition
  std::vector<TunedRow> rows;  ///< sorted by robot, condition and what the pair was before
  std::string made_by;         ///< commands, apart by "; "
};

/// Whether a pair was tuned for this robot under that condition.
bool is_tuned(const TunedRow& row, const Robot& robot, const std::string& condition);

/// Adds what `more` has.
/// @throws std::invalid_argument if their margins differ
void append(const TunedStudy& more, TunedStudy& to);

/// The file appears whole or not at all.
/// @throws std::runtime_error naming the path
void write_tuned(const TunedStudy& tuned, const std::string& path);

/// Such a file; of one that has thresholds alone these.
/// @throws std::runtime_error naming the path and what is wrong
TunedStudy read_tuned(const std::string& path);

}  // namespace tauext::study

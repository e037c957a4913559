// SPDX-License-Identifier: Apache-2.0
/// @file
/// How thresholds come from runs, wherever these come from.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/roster/robot.h"
#include "bench/roster/session/session.h"
#include "bench/roster/thresholds.h"
#include "mjcf/trace/trace.h"

namespace tauext::study {

/// How thresholds are set.
struct CalibrationOptions {
  const Robot* robot = nullptr;  ///< null for the first one that has runs
  double margin = 1.3;  ///< [1] threshold over the largest value in training, as an amplitude
  std::vector<std::string> conditions;  ///< trained on; empty: those that the robot's runs name
  std::vector<std::string> estimators;  ///< specifications; empty: all but the baselines
  std::vector<std::string> detectors;   ///< with their parts; empty: all that can be calibrated
  /// Specifications of estimators, and of detectors behind them, instead of every one of the last
  /// two behind every other; empty: those.
  std::vector<std::pair<std::string, std::string>> pairs;
  int runs = 20;                         ///< of 30 s for each condition
  int threads = 0;                       ///< 0: one a core
  std::function<void(double)> progress;  ///< called with the share that is done; may be empty
};

/// Whether thresholds hold on what they have not seen; a detector's metric has seen all.
struct HeldOut {
  std::string estimator, detector;  ///< specifications
  int recordings = 0;               ///< that were held out, one by one
  int alarms = 0;                   ///< of them, where thresholds from all others would have marked
};

/// Training runs as sensors of one quality see them, for one session.
struct Seen {
  std::size_t set;                ///< of thresholds
  const Robot& robot;             ///< what its estimators believe in
  std::span<const Trace> traces;  ///< of one clock
  std::vector<int> runs;          ///< which ones these are
  const std::string& name;        ///< of a recording; else ""
  /// Of these traces, with the estimates of the only estimator that is asked for; null if there are
  /// none yet.
  Session* estimated = nullptr;
};
/// Shows them to whoever trains.
using Look = std::function<void(const Seen&)>;

/// Where training runs come from, batch by batch; several threads ask at once.
struct Source {
  int runs, batches;                                      ///< how many there are
  std::function<void(int batch, const Look& look)> show;  ///< shows a batch to each set
};

/// A set of thresholds: of sensors of one quality, or of one condition.
struct Quality {
  double velocity_noise = 0;  ///< [rad/s]
  std::string condition;      ///< ThresholdSet::condition
};

/// Trains in two passes over the runs: first what metrics have to undo, then what is the largest.
/// @param trained_on in words
/// @param held_out if not null, gets every run by the thresholds of all others
/// @throws std::invalid_argument for a margin below 1 and unknown names
Thresholds train(const CalibrationOptions& options, const Robot& robot, Source source,
                 const std::vector<Quality>& qualities, std::string trained_on,
                 std::vector<HeldOut>* held_out = nullptr);

}  // namespace tauext::study

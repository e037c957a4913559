// SPDX-License-Identifier: Apache-2.0
/// @file
/// Every pair of estimator and detector at its best under each condition of the detection study,
/// with the same budget for each, before anybody compares them.
///
/// Each detector's own numbers are searched (tune.h) behind the estimator as it is, and behind it
/// at five bandwidths from 5 to 450 rad/s. What counts is the share of meetings with regions of a
/// body that a pair finds, as the mean over their kinds, with thresholds that no training run
/// without a touch reaches. All of it happens on training seeds, on which the arm moves otherwise
/// than in a test (brisk_motion).
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/roster/thresholds.h"
#include "bench/study/detection/calibration.h"
#include "bench/study/detection/study_parts.h"
#include "bench/study/detection/tuned.h"
#include "bench/study/study_runs.h"
#include "bench/tune/keys.h"

namespace tauext {

/// Runs of one condition as its sensors see them: some without a touch, and some with meetings of
/// each of region_classes(). Simulated once, for all pairs; several threads may ask.
class TrainingRuns {
 public:
  /// @param free_runs of 30 s without a touch
  /// @param meetings of each kind, at least
  /// @param threads 0: one a core
  TrainingRuns(const study::StudyRuns& runs, const study::Condition& condition, int free_runs,
               int meetings, int threads);

  /// All of them as an estimator sees them; none if an estimate is missing.
  std::vector<study::EstimatedRuns> seen_by(const std::string& estimator) const;

  /// [1] share of the meetings that the pair finds, as the mean over their kinds, with thresholds
  /// `margin` times what the runs without a touch reach.
  /// @param seen by this estimator
  double recall(const std::vector<study::EstimatedRuns>& seen, const TunedPair& pair,
                double margin) const;

 private:
  void add_batches(const std::vector<study::Job>& jobs);

  const study::StudyRuns& runs_;
  const Robot& robot_;
  std::shared_ptr<const Robot> believer_;
  std::vector<std::vector<study::Job>> jobs_;  // by batch, those without a touch first
  std::size_t free_ = 0;                       // so many of these
  std::vector<std::vector<Trace>> batches_;
  std::vector<std::vector<std::vector<double>>> forces_;  // [N] by batch and run
};

/// What is tuned, and how long.
struct StudyTuning {
  const Robot* robot = nullptr;          ///< null for the first one that has runs
  std::vector<std::string> conditions;   ///< each for itself
  std::vector<std::string> estimators;   ///< specifications; empty: all but the baselines
  std::vector<std::string> detectors;    ///< specifications; empty: all
  study::Shard shard;                    ///< of the estimators of all conditions
  int evaluations = 60;                  ///< of each pair, at most; shared by its bandwidths
  int free_runs = 16;                    ///< of 30 s without a touch, for each evaluation
  int meetings = 3;                      ///< of each kind, at least, likewise
  int runs = 100;                        ///< of 30 s, which set the thresholds in the end
  double margin = 1.1;                   ///< CalibrationOptions::margin
  int threads = 0;                       ///< 0: one a core
  std::function<void(double)> progress;  ///< called with the share that is done; may be empty
  std::function<bool()> stop;            ///< whether to begin no more pairs; may be empty
  /// Called with the pairs of each condition that was done, or of what was done of it.
  std::function<void(const study::TunedStudy&)> found;
};

/// Tunes; a pair that makes no estimates under a condition is left out.
/// @param known pairs that are not tuned again
/// @throws std::invalid_argument for unknown names, a condition that does not train itself, an arm
/// on which regions find no place, and numbers out of range
void tune_study(const StudyTuning& options, const std::vector<study::TunedRow>& known);

/// Puts files of tuned pairs together, in any order: the file that one machine makes.
/// @returns kGood
/// @throws std::runtime_error naming the file for what is none, and for a pair that is there twice
int merge_tuned(const std::vector<std::string>& paths, const std::string& out);

}  // namespace tauext

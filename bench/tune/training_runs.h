// SPDX-License-Identifier: Apache-2.0
/// @file
/// What a pair of estimator and detector is worth on training runs of one condition of the study.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "bench/study/detection/calibration.h"
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

}  // namespace tauext

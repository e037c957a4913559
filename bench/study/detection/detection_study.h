// SPDX-License-Identifier: Apache-2.0
/// @file
/// Every estimator with every detector on one robot, under conditions that it meets: what is
/// missed, how late, how often for nothing, and what a human's push or a slow clamping is taken
/// for.
///
/// Each run is simulated once and seen by all; each condition adds its own sensors. Every figure is
/// a count or a quantile over runs that are numbered, so it does not depend on the number of
/// threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/roster/thresholds.h"
#include "bench/study/detection/study_counts.h"
#include "bench/study/detection/tuned.h"

namespace tauext::study {

/// How much is tried, and what of it.
struct StudyOptions {
  const Robot* robot = nullptr;         ///< null for the first one that has runs
  std::vector<std::string> conditions;  ///< by name; empty: the quick ones
  std::vector<std::string> estimators;  ///< specifications; empty: all but the baselines
  std::vector<std::string> detectors;   ///< specifications; empty: all
  /// Of a condition that is named here these pairs are tried, and no others. Of them `estimators`
  /// and `detectors` choose by specification or name.
  std::vector<TunedRow> tuned;
  int blows = 300;         ///< at least so many for each condition
  int brisk_pushes = 100;  ///< at least so many for each condition
  int clampings = 100;     ///< at least so many for each condition
  int regions = 0;         ///< at least so many meetings of each of region_classes(), likewise
  double hours = 1;        ///< [h] of slow pushes and free motion, at least, likewise
  std::uint64_t first_seed = 1;          ///< of the runs: first_seed, first_seed + 1, ...
  int threads = 0;                       ///< 0: one a core
  std::function<void(double)> progress;  ///< called with the share that is done; may be empty
  std::function<bool()> stop;            ///< whether to begin no more work; may be empty
};

/// @throws std::invalid_argument for a robot without runs, for unknown names, and for seeds that
/// reach those of calibration
void check_study(const StudyOptions& options);

/// What some runs add: cells by their index, and their counts.
using Added = std::vector<std::pair<std::size_t, Cell>>;

/// A study as a list of independent pieces of work.
class DetectionStudy {
 public:
  /// @throws std::invalid_argument as check_study does, and for a pair without thresholds
  DetectionStudy(const StudyOptions& options, const Thresholds& thresholds);
  ~DetectionStudy();

  /// What is counted, by condition, estimator and detector; nothing is counted yet.
  const std::vector<Cell>& cells() const;
  /// How many pieces there are.
  int pieces() const;
  /// What one of them adds; several threads may ask at once.
  /// @throws std::runtime_error if our dynamics and MuJoCo's differ
  Added run(int piece) const;

 private:
  class Study;
  std::unique_ptr<const Study> study_;
};

/// Adds what pieces added, in any order.
class StudySum {
 public:
  /// @param cells nothing is counted in them
  explicit StudySum(std::vector<Cell> cells) : cells_(std::move(cells)) {}

  void add(const Added& added);           ///< of one more piece
  int pieces() const { return pieces_; }  ///< that were added
  std::vector<Cell> sorted() const;       ///< what has been counted so far

 private:
  std::vector<Cell> cells_;
  int pieces_ = 0;
};

/// Adds what the study's pieces add, or those that there is time for until `stop`.
/// @param options its threads, progress and stop
void run_pieces(const DetectionStudy& study, const StudyOptions& options, StudySum& sum);

/// All of it at once.
/// @throws as DetectionStudy does
std::vector<Cell> detection_study(const StudyOptions& options, const Thresholds& thresholds);

}  // namespace tauext::study

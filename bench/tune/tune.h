// SPDX-License-Identifier: Apache-2.0
/// @file
/// The best parameters of an estimator and of the detector behind it, by their lists of parameters.
///
/// The objective is the geometric mean of a metric over runs, so that runs of N m and of mN m count
/// alike. A pair that misses a value or breaks a limit ranks behind every pair that does not;
/// among such pairs the smaller excess ranks first. NLopt searches in the logarithms: DIRECT-L
/// (Gablonsky and Kelley 2001) over the whole range, then Subplex (Rowan 1990) from the best place.
/// Both are deterministic.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "bench/roster/specification.h"
#include "bench/score/metric_list.h"
#include "bench/score/score.h"

namespace tauext {

/// A number to be found: of the estimator or of the detector. One of each joint is multiplied by
/// one factor, so that joints keep their proportions.
struct TunedKey {
  std::string key;            ///< as a specification has it
  double low = 0, high = 0;   ///< [unit] between which it is; of joints, the largest one's
  bool of_detector = false;   ///< else of the estimator
  std::vector<double> start;  ///< [unit] one, or one for each joint
};

/// A pair of specifications, without the keys that are tuned.
struct TunedPair {
  std::string estimator, detector;  ///< "" for no detector
};

/// A limit that a metric must keep: at most so much, or at least where more is better.
using Limit = std::pair<Metric, double>;

/// What is to be found.
struct TuneOptions {
  TunedPair pair;                   ///< what is tuned
  std::vector<TunedKey> keys;       ///< its numbers; not empty
  Metric minimize = Metric::kRmse;  ///< or maximize, where more is better
  std::vector<Limit> limits;        ///< of the mean over seeds, in each run
  int evaluations = 60;             ///< at most
  /// The scores of a pair: for each run, one for each seed. The first call is of the start.
  std::function<std::vector<std::vector<Score>>(const TunedPair&)> score;
  std::function<void(double)> progress;  ///< called with the share that is done; may be empty
};

/// What was found.
struct Tuned {
  TunedPair start, best;  ///< with all keys set
  double of_start = 0;    ///< [the metric's unit] the objective; NaN if something never comes, or a
                          ///< limit is broken
  double of_best = 0;     ///< likewise
  int evaluations = 0;    ///< that were made
  std::vector<std::string> at_bound;  ///< keys whose best value is at an end of their range
};

/// The keys by texts like "w" and "threshold=10:500": without a range a thirtieth to thirty times
/// the start, which is what the specification says, or else the key's default.
/// @param estimator_fields,detector_fields of the pair, as Robot has them
/// @throws std::invalid_argument for a key that neither has or both, a range that is none, and a
/// key without a known number to begin with
std::vector<TunedKey> keys_of(const std::vector<std::string>& texts, const TunedPair& pair,
                              const std::vector<FieldHelp>& estimator_fields,
                              const std::vector<FieldHelp>& detector_fields);

/// The pair without these keys.
TunedPair without(const TunedPair& pair, const std::vector<TunedKey>& keys);

/// @throws std::invalid_argument if no run has the metric, or that of a limit, at the start;
/// and what `score` throws
Tuned tune(const TuneOptions& options);

}  // namespace tauext

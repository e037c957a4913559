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

#include "bench/score/metric_list.h"
#include "bench/score/score.h"
#include "bench/tune/keys.h"

namespace tauext {

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
  /// Throws std::invalid_argument for a pair that cannot be made: asked at the ends of each range,
  /// before anything is scored; may be empty.
  std::function<void(const TunedPair&)> check;
  std::function<void(double)> progress;  ///< called with the share that is done; may be empty
};

/// What was found.
struct Tuned {
  TunedPair start, best;  ///< with all keys set
  double of_start = 0;    ///< [the metric's unit] the objective; NaN if something never comes, or a
                          ///< limit is broken
  double of_best = 0;     ///< likewise
  std::string start_breaks;  ///< what is missing or breaks a limit, in words; "" if nothing does
  std::string best_breaks;   ///< as start_breaks, of best
  int evaluations = 0;       ///< that were made
  std::vector<std::string> at_bound;  ///< keys whose best value is at an end of their range
};

/// @throws std::invalid_argument for a range with an end that cannot be made, and if no run has the
/// metric, or that of a limit, at the start; and what `score` throws
Tuned tune(const TuneOptions& options);

}  // namespace tauext

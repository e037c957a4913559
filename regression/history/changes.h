// SPDX-License-Identifier: Apache-2.0
/// @file
/// Where a series changed its level: steps that are too small to be seen one by one add up.
#pragma once

#include <cstddef>
#include <vector>

namespace tauext::gate {

/// The last point at which a series went to another level.
struct LevelChange {
  std::size_t at = 0;  ///< the first point that has it
  double by = 0;       ///< median from there on - median before, in the series' unit
};

/// What counts as a change of level.
struct ChangeLimits {
  double least = 0.01;         ///< smallest change that counts, in the series' unit
  double least_sd = 0.0015;    ///< smallest standard deviation that is assumed
  double false_alarms = 0.01;  ///< [1] at most in so many calls, over all series
  std::size_t points = 3;      ///< on each side
};

/// The last change of a series' level, or none (by = 0). Binary segmentation: the split that leaves
/// the least deviations from the medians of both sides counts if their difference over its standard
/// error exceeds Student's quantile for all splits of all series together, and then what is behind
/// it is split again.
/// Medians, since one run in some hundreds is far off. The noise is the median of the absolute
/// differences of neighbours / (0.6745 sqrt 2): steps and ramps leave it as it is.
/// @param series number of series that are judged together; the more, the surer each must be
LevelChange last_change(const std::vector<double>& values, const ChangeLimits& limits, int series);

}  // namespace tauext::gate

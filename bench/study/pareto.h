// SPDX-License-Identifier: Apache-2.0
/// @file
/// Noise against delay over all bandwidths: which estimator at which one is beaten by another.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/study/equal_bandwidth.h"

namespace tauext::study {

/// A point of an estimator's front of noise against delay. The delay is the settling time: who
/// reaches 90 % early and overshoots is not there yet.
struct ParetoPoint {
  std::string estimator;     ///< its specification
  double design = 0;         ///< [rad/s]; 0: as the roster has it
  NoiseAndDelay value;       ///< what is compared
  std::string dominated_by;  ///< who settles as quickly and is at least 2 % quieter; "" if nobody
  double excess = 0;         ///< [1] how much noisier this one is than that

  /// Whether it has a place at all: an estimate that never settles, or whose noise has no value,
  /// has none.
  bool has_value() const;
  /// Whether nobody is better in both.
  bool on_front() const { return has_value() && dominated_by.empty(); }
};

/// Sweeps every tunable estimator of the robot, and adds all as the roster has them, one point
/// each; or those that are asked for.
/// @throws std::invalid_argument for a robot without the scenarios `step` and `free`, and as
/// tunable_of (equal_bandwidth.h)
std::vector<ParetoPoint> pareto(const Robot& robot, int threads = 0,
                                const std::function<void(double)>& progress = nullptr,
                                const std::vector<std::string>& asked = {});

/// Marks who is dominated: the front of another estimator, on straight lines between its points in
/// the logarithms, lies below, or a point of its own does.
void mark_dominated(std::vector<ParetoPoint>& points);

/// As text with a head and with what the columns mean.
std::string format_pareto(const Robot& robot, const std::vector<ParetoPoint>& points,
                          TableFormat format = TableFormat::kText);

}  // namespace tauext::study

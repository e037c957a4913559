// SPDX-License-Identifier: Apache-2.0
/// @file
/// Detector thresholds that come from data: what --calibrate writes and the suite reads.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

namespace tauext {

/// What training says of one detector.
struct Trained {
  Eigen::VectorXd threshold;  ///< in the unit of its statistic, per joint
  Eigen::MatrixXd metric;     ///< [1] of a detector that has one; else empty
};

/// The detectors behind one estimator. One that is not in it keeps its defaults.
using DetectorThresholds = std::map<std::string, Trained>;

/// Thresholds of one robot behind sensors of one quality, by estimator.
struct ThresholdSet {
  std::string robot;
  double velocity_noise = 0;  ///< [rad/s] of the training traces
  std::map<std::string, DetectorThresholds> by_estimator;
};

/// A parameter file.
struct Thresholds {
  std::string trained_on;  ///< in words
  double margin = 1;       ///< [1] threshold over the largest value in training, as an amplitude
  std::vector<ThresholdSet> sets;

  /// The set of this robot for sensors of this quality: the least noisy one that is as noisy, or
  /// else the noisiest. Empty if there is none of this robot.
  ThresholdSet of(const std::string& robot, double velocity_noise) const;
};

/// Writes them as JSON; the file appears whole or not at all.
/// @throws std::runtime_error naming the path
void write_thresholds(const Thresholds& t, const std::string& path);

/// @throws std::runtime_error naming the path and what is wrong: unreadable, not JSON, a missing key, a
/// threshold that is not positive, a wrong number of joints, an unknown robot, estimator or detector
/// (a metric that is none is refused where the detector is built)
Thresholds read_thresholds(const std::string& path);

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Detector thresholds that come from data: what --calibrate writes and the suite reads.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tauext {

/// What training says of one detector.
struct Trained {
  Eigen::VectorXd threshold;  ///< in the unit of its statistic, per joint
  Eigen::MatrixXd metric;     ///< [1] of a detector that has one; else empty
};

/// The detectors behind one estimator.
using DetectorThresholds = std::map<std::string, Trained>;

/// How the detectors behind an estimator are set.
struct DetectorSettings {
  DetectorThresholds thresholds;  ///< of those that are in it; the others keep their defaults
  double start_up = 0;  ///< [s] without marks, while an estimator finds an unknown payload
  /// [1] up to which scores are told, of a detector that has to stop somewhere; else its own
  std::optional<double> most_score = {};
};

/// Thresholds of one robot behind sensors of one quality, by estimator.
struct ThresholdSet {
  std::string robot;          ///< its name
  std::string fingerprint;    ///< Robot::fingerprint()
  double velocity_noise = 0;  ///< [rad/s] of the training traces
  std::string condition;      ///< of the study that it is for alone; "" for any
  std::map<std::string, DetectorThresholds> by_estimator;  ///< by specification
};

/// A parameter file.
struct Thresholds {
  std::string path;        ///< of the file; "" before there is one
  std::string trained_on;  ///< in words
  double margin = 1;       ///< [1] threshold over the largest value in training, as an amplitude
  std::vector<ThresholdSet> sets;  ///< in no order

  /// The set of this robot for sensors of this quality: the least noisy one that is as noisy, or
  /// else the noisiest. Null if there is none of this robot.
  /// @param fingerprint Robot::fingerprint(); a robot that has one goes by it, whatever its name
  /// @param condition of the study: a set that is for this one alone comes before any other
  const ThresholdSet* of(const std::string& robot, double velocity_noise,
                         const std::string& fingerprint = "",
                         const std::string& condition = "") const;
};

inline const ThresholdSet* Thresholds::of(const std::string& robot, double velocity_noise,
                                          const std::string& fingerprint,
                                          const std::string& condition) const {
  const ThresholdSet* best = nullptr;
  for (const ThresholdSet& s : sets) {
    if (s.fingerprint != fingerprint || (fingerprint.empty() && s.robot != robot)) continue;
    if (!s.condition.empty()) {
      if (s.condition == condition) return &s;
      continue;
    }
    const bool enough = s.velocity_noise >= velocity_noise;
    const bool had_enough = best != nullptr && best->velocity_noise >= velocity_noise;
    const bool better =
        best == nullptr || (enough && !had_enough) ||
        (enough == had_enough && (s.velocity_noise < best->velocity_noise) == enough);
    if (better) best = &s;
  }
  return best;
}

}  // namespace tauext

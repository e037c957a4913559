// SPDX-License-Identifier: Apache-2.0
/// @file
/// The roster at run time: robots, estimators and detectors by name.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/stages.h"
#include "bench/thresholds.h"
#include "mjcf/record.h"

namespace tauext {

/// How the detectors behind an estimator are set.
struct DetectorSettings {
  DetectorThresholds thresholds;  ///< of those that are in it; the others keep their defaults
  double start_up = 0;  ///< [s] without marks, while an estimator finds an unknown payload
};

/// What calibrating a detector needs to know.
struct Calibration {
  int degree = 1;             ///< power of tau_ext that its statistic grows with
  Eigen::VectorXd threshold;  ///< its default, in the unit of its statistic
  bool has_metric = false;    ///< whether it weighs the joints by a metric, too
};

/// A robot with the estimators and detectors that run on it. Every call throws std::invalid_argument
/// for an unknown name, listing the known ones, and for a trace of another number of joints.
class Robot {
 public:
  std::string name;
  int dof = 0;
  std::vector<std::string> estimators;
  std::vector<std::string> tunable;  ///< estimators that can be set to a bandwidth
  std::vector<std::string> detectors;
  std::vector<std::string> calibratable;  ///< detectors with thresholds of their own, from data

  /// Binds an estimator, and a detector unless it is "", to a trace's samples.
  /// @throws std::invalid_argument for an estimator that needs a truth which the trace does not have
  std::unique_ptr<Runner> runner(std::string_view estimator, std::string_view detector,
                                 const Trace& trace, const DetectorSettings& settings = {}) const;

  /// The same for a live run. The trace is what an estimator that copies the truth copies; else it may be empty.
  /// @throws std::invalid_argument for an estimator that needs a truth which the trace does not have
  std::unique_ptr<Stepper> stepper(std::string_view estimator, std::string_view detector,
                                   const Trace& trace, const DetectorSettings& settings = {}) const;

  /// A tunable estimator at bandwidth w [rad/s] of its own formula.
  std::unique_ptr<Runner> tuned(std::string_view estimator, double w, const Trace& trace) const;

  /// The pair as the one who stops the motor: at the first mark. It never sees a truth.
  /// @throws std::invalid_argument for an estimator that copies the truth
  Supervisor supervisor(std::string_view estimator, std::string_view detector,
                        const DetectorSettings& settings = {}) const;

  /// What a detector says of estimates that an estimator made of the trace, sample by sample.
  std::vector<Detection> detect(std::string_view detector, const Trace& trace,
                                const Output& estimates, const DetectorSettings& settings) const;

  /// The largest statistic of a calibratable detector, joint by joint, over samples with t >= from [s].
  Eigen::VectorXd largest_statistic(std::string_view detector, const Trace& trace,
                                    const Output& estimates, const DetectorSettings& settings,
                                    double from) const;

  /// The mean of z z^T over samples with t >= from, z the change() of a detector with a metric.
  Eigen::MatrixXd covariance(std::string_view detector, const Trace& trace, const Output& estimates,
                             const DetectorSettings& settings, double from) const;

  /// How a calibratable detector's thresholds are set.
  const Calibration& calibration(std::string_view detector) const;

  /// The same behind the degrees of freedom, which are compile-time; bench/robot.cc.
  struct Stages;
  std::shared_ptr<const Stages> stages;
};

/// Every robot of bench/roster.h.
const std::vector<Robot>& robots();

/// The robot of that name.
/// @throws std::invalid_argument for an unknown name, listing the known ones
const Robot& robot(std::string_view name);

/// wallmobot3 whose estimators believe in a panel of so many kg; 150 is what robot("wallmobot3") believes.
Robot wallmobot3_believing(double panel);

/// Whether the estimator is one of bench/baselines.h, which stand outside the competition.
bool is_baseline(std::string_view estimator);

/// Whether it copies the recorded truth.
bool needs_truth(std::string_view estimator);

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Scoring: every entry is judged on a recorded trace before anything is timed.
#pragma once

#include <compare>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/roster/robot.h"
#include "bench/score/entry.h"
#include "bench/score/score.h"
#include "mjcf/arm_forces.h"
#include "mjcf/record.h"

namespace tauext {

/// What is the same for all entries of a run.
struct SuiteOptions {
  Sensors sensors;            ///< of the scored trace
  ModelError model_error;     ///< of the robot that is scored
  Recording recording;        ///< how the robot is simulated
  Thresholds thresholds;      ///< of the detectors; without sets all keep their defaults
  double noise_probe = 1e-3;  ///< [rad/s] velocity noise behind noise_Nm when `sensors` are ideal
};

/// The first estimate that is not finite, diverged or had a singular inertia, or that most samples
/// were left out; "" if none of it.
std::string bad_status(const Trace& trace, const Output& output);

/// Why the estimates of an ideal run cannot be those of a working estimator ("" if they can): one
/// is not finite, a status says so, or from time `from` [s] on some joint's rmse exceeds
/// 1.5 times that of an estimate of 0 by more than `slack` [N m], of each joint.
std::string failure(const Trace& ideal, const Output& output, double from,
                    const Eigen::VectorXd& slack);

/// [s] that this thread spends on a batch: what else runs beside it does not count.
double batch_seconds(Runner& runner);

/// Scores entries; records each robot's scenario once and shares it. A scenario that reacts is
/// recorded anew for each pair of estimator and detector, whose mark then stops the motor. Safe for
/// one thread.
class Suite {
 public:
  /// For scores of these sensors, errors and thresholds.
  explicit Suite(const SuiteOptions& options) : options_(options) {}

  /// Runs the entry and judges it. A scenario that cannot be recorded is an error of the score.
  Score score(const Entry& entry);

  /// What score() judges: the trace, and what the entry makes of it.
  struct Run {
    const Trace& trace;                 ///< kept by the suite
    Output output;                      ///< of the entry
    std::vector<Detection> detections;  ///< empty without a detector
  };
  /// Runs the entry.
  Run run(const Entry& entry);

  /// A runner over the trace that was scored, for the clock.
  Runner runner(const Entry& entry);

  const SuiteOptions& options() const { return options_; }  ///< as constructed, but for sensors

  /// From now on scores are of these sensors. Truths are kept, as no sensor moves an arm but in a
  /// closed loop, and so is what estimators made of them.
  void set_sensors(const Sensors& sensors);

 private:
  DetectorSettings settings(const Entry& entry) const;
  Pair pair(const Entry& entry, const Trace& trace) const;
  std::string error(const Entry& entry, const Output& of_ideal, const Output& of_noisy);
  const Trace& ideal(const Entry& entry);
  const Trace& noisy(
      const Entry& entry);  // by the sensors, or by the noise probe if they are ideal
  // whose truth an entry meets: its scenario's, or where its marks stop the motor, its own
  struct Truth {
    explicit Truth(const Entry& entry);
    bool closed_loop() const { return !detector.empty(); }
    friend auto operator<=>(const Truth&, const Truth&) = default;

    const Robot* robot;
    const Scenario* scenario;
    std::string estimator, detector;  // of a closed loop; else ""
  };
  using Outputs = std::map<std::pair<Truth, std::string>, Output>;  // by estimator, too
  const Output& estimate(const Entry& entry, const Trace& trace, Outputs& made);
  const Score& of_estimator(const Entry& entry);
  void add_force_metric(const Entry& entry, const Output& output, Score& to);
  bool is_ideal(const Entry& entry) const;
  const Trace& scored(const Entry& entry);

  SuiteOptions options_;
  std::map<Truth, Trace> ideal_, noisy_;
  Outputs of_ideal_, of_noisy_;                            // of one scenario
  std::map<std::pair<Truth, std::string>, Score> scores_;  // without a detector
  std::map<const Robot*, std::unique_ptr<const ArmForces>> forces_;
};

}  // namespace tauext

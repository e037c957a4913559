// SPDX-License-Identifier: Apache-2.0
/// @file
/// Scoring: every entry is judged on a recorded trace before anything is timed.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/robot.h"
#include "mjcf/record.h"

namespace tauext {

/// One row of the suite.
struct Entry {
  std::string robot, scenario, estimator;
  std::string detector;  ///< "" for none

  std::string name() const;   ///< <robot>/<scenario>/<estimator>[+<detector>]
  std::string group() const;  ///< <robot>/<scenario>: the entries that compete
};

/// Every robot x scenario x estimator, and with a detector where it has something to detect (or to
/// leave in peace).
std::vector<Entry> entries();

/// Whether a detector stands in the detection study alone: with all of them the tables would not end.
bool study_only(const std::string& detector);

/// What an entry was worth: metrics by their key `<quantity>_<unit>`; a key is missing if the metric
/// does not exist for the scenario, and NaN if it has no value ("never settles").
struct Score {
  std::map<std::string, double> metrics;
  std::string error;  ///< why the entry failed; "" if it did not

  std::optional<double> get(const std::string& key) const;
};

/// What is the same for all entries of a run.
struct SuiteOptions {
  Sensors sensors;         ///< of the scored trace
  ModelError model_error;  ///< of the robot that is scored
  Recording recording;
  Thresholds thresholds;      ///< of the detectors; those that are not in it keep their defaults
  double noise_probe = 1e-3;  ///< [rad/s] velocity noise behind noise_Nm when `sensors` are ideal
};

/// The scores of a trace's estimates, for one entry and for tauext-replay alike: errors per joint
/// and worst, and what scenario.response asks for. Joints count from 1.
void add_error_metrics(const Trace& trace, const Output& output, double from, Score& score);
void add_response_metrics(const Trace& trace, const Output& output, const Scenario& scenario,
                          Score& score);
void add_detection_metrics(const Trace& trace, const Output& output, Score& score);

/// What stopping at the mark was worth: overtravel, and the contact's peak force with and without.
void add_reaction_metrics(const Trace& stopped, const Trace& free, Score& score);

/// The first estimate that is not finite or whose status says that it is an old one; "" for none.
std::string bad_status(const Trace& trace, const Output& output);

/// Why the estimates of an ideal run cannot be those of a working estimator ("" if they can): one is
/// not finite, a status says so, or from time `from` [s] on some joint's rmse exceeds
/// 1.5 times that of an estimate of 0 by more than 5 N m.
std::string failure(const Trace& ideal, const Output& output, double from);

/// Scores entries; records each robot's scenario once and shares it. A scenario that reacts is recorded
/// anew for each pair of estimator and detector, whose mark then stops the motor. Safe for one thread.
class Suite {
 public:
  explicit Suite(const SuiteOptions& options) : options_(options) {}

  Score score(const Entry& entry);

  /// What score() judges: the trace, and what the entry makes of it.
  struct Run {
    const Trace& trace;
    Output output;
    std::vector<Detection> detections;  ///< empty without a detector
  };
  Run run(const Entry& entry);

  /// A runner over the trace that was scored, for the clock.
  std::unique_ptr<Runner> runner(const Entry& entry);

  const SuiteOptions& options() const { return options_; }

 private:
  struct Traces {
    Trace ideal, noisy;  // noisy: by `sensors`, or by the noise probe if these are ideal
  };
  // whether the entry's own marks stop its motor
  static bool closed_loop(const Entry& entry);
  DetectorSettings settings(const Entry& entry) const;
  const Traces& traces(const Entry& entry);
  const Trace& scored(const Entry& entry);

  SuiteOptions options_;
  std::map<std::string, Traces> traces_;  // by group; a closed loop's by name
};

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// The roster at run time: robots, estimators and detectors by name.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "bench/stages.h"
#include "mjcf/record.h"

namespace tauext {

/// A robot with the estimators and detectors that run on it.
struct Robot {
  std::string name;
  int dof = 0;
  std::vector<std::string> estimators;
  std::vector<std::string> detectors;
  /// Binds an estimator, and a detector unless it is "", to a trace's samples.
  /// @throws std::invalid_argument for an unknown name, listing the known ones; for a trace of
  /// another number of joints; for an estimator that needs a truth which the trace does not have
  std::function<std::unique_ptr<Runner>(std::string_view estimator, std::string_view detector,
                                        const Trace& trace)>
      runner;
  /// The pair as the one who stops the motor: at the first mark. It never sees a truth.
  /// @throws std::invalid_argument for an unknown name, or an estimator that copies the truth
  std::function<Supervisor(std::string_view estimator, std::string_view detector)> supervisor;
};

/// Every robot of bench/roster.h.
const std::vector<Robot>& robots();

/// The robot of that name.
/// @throws std::invalid_argument for an unknown name, listing the known ones
const Robot& robot(std::string_view name);

/// Whether the estimator is one of bench/baselines.h, which stand outside the competition.
bool is_baseline(std::string_view estimator);

/// Whether it copies the recorded truth.
bool needs_truth(std::string_view estimator);

}  // namespace tauext

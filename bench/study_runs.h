// SPDX-License-Identifier: Apache-2.0
/// @file
/// The simulated runs that the detection study and the calibration share. Not installed.
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/detection_study.h"
#include "mjcf/model.h"
#include "mjcf/record.h"
#include "mjcf/touch.h"

namespace tauext::study {

inline constexpr const char* kRobot = "wallmobot3";
inline constexpr double kScoreFrom = 4;  ///< [s] an estimator has found an unknown panel by then
inline constexpr double kStartUp = 3;    ///< [s] detectors stay silent

/// Conditions that differ in the sensors alone share their simulated runs.
struct PlantKey {
  double panel, friction;
  auto operator<=>(const PlantKey&) const = default;  // NOLINT(modernize-use-nullptr): not ours
};

PlantKey plant_of(const Condition& c);
Model model_of(const PlantKey& p);

/// One run to simulate.
struct Job {
  PlantKey plant;
  TouchKind kind;
  std::uint64_t seed;
};

Trace simulate(const Job& job, const Model& model);

/// What the sensors make of a run, with a seed of their own.
Trace measured(const Trace& truth, Sensors sensors, const Job& job);

/// Every estimator of the robot but the baselines.
std::vector<std::string> all_estimators();

std::vector<std::string> condition_names();

/// The names asked for, or all known ones.
/// @throws std::invalid_argument for an unknown name, listing the known ones
std::vector<std::string> chosen(const char* what, const std::vector<std::string>& asked,
                                const std::vector<std::string>& known);

}  // namespace tauext::study

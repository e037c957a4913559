// SPDX-License-Identifier: Apache-2.0
/// @file
/// Every estimator with every detector on wallmobot3, under conditions that a robot meets: what is
/// missed, how late, how often for nothing, and what a human's push or a slow clamping is taken for.
///
/// Each run is simulated once and seen by all; each condition adds its own sensors. Every figure is a
/// count or a quantile over runs that are numbered, so it does not depend on the number of threads.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "bench/degradation.h"
#include "bench/thresholds.h"

namespace tauext {

/// What the robot carries, what its estimators believe it does, and how well it measures.
struct Condition {
  std::string name, description;
  double panel = 150;         ///< [kg] carried
  double believed = 150;      ///< [kg] in the estimators' model
  Degradation degradation{};  ///< sensors' faults and model errors
};

/// All conditions of the study.
const std::vector<Condition>& conditions();

/// The condition of that name.
/// @throws std::invalid_argument for an unknown name, listing the known ones
const Condition& condition(const std::string& name);

/// How much is tried, and what of it.
struct StudyOptions {
  std::vector<std::string> conditions, estimators, detectors;  ///< by name; empty: all
  int blows = 500;                       ///< at least so many for each condition
  int brisk_pushes = 100;                ///< likewise
  int clampings = 100;                   ///< likewise
  double hours = 1;                      ///< [h] of slow pushes and free motion, likewise
  std::uint64_t first_seed = 1;          ///< of the runs: first_seed, first_seed + 1, ...
  int threads = 0;                       ///< 0: one a core
  std::function<void(double)> progress;  ///< called with the share that is done; may be empty
};

/// The first seed of calibration; test seeds stay below.
inline constexpr std::uint64_t kTrainingSeed = 1'000'000;

/// Multiples of the detector's threshold at which its score is judged, too.
inline constexpr std::array kLevels = {0.125, 0.25, 0.5, 0.71, 1.0, 1.41, 2.0, 4.0, 8.0};

/// One estimator and detector under one condition.
struct Cell {
  std::string condition, estimator, detector;
  int runs = 0, failed_runs = 0;  ///< failed: an estimate was missing (any status but ok)
  int blows = 0, detected = 0;    ///< by a mark until 0.2 s after the blow
  int stray = 0;                  ///< marks in these runs outside such windows
  std::vector<double> delays;     ///< [s] from a detected blow's begin to its mark, sorted
  long quiet_samples = 0;         ///< of slow pushes and free motion, at 1 kHz
  long alarmed_samples = 0;       ///< of them, where the score is 1 or more
  int alarms = 0;                 ///< marks in them
  int collision_alarms = 0;       ///< those that say collision
  int brisk = 0, brisk_flagged = 0;
  int clampings = 0, clampings_flagged = 0;                    ///< by any mark while it holds
  int clampings_named = 0;                                     ///< by a mark that says clamping
  std::array<int, kLevels.size()> detected_at{}, alarms_at{};  ///< with thresholds times kLevels

  double hours() const { return quiet_samples * 1e-3 / 3600; }
  double recall() const { return blows == 0 ? 0 : static_cast<double>(detected) / blows; }
};

/// @throws std::invalid_argument for unknown names, and for seeds that reach kTrainingSeed
void check_study(const StudyOptions& options);

/// Runs the study. Cells are ordered by condition, estimator, detector.
/// @throws std::invalid_argument as check_study does
std::vector<Cell> detection_study(const StudyOptions& options, const Thresholds& thresholds);

/// How thresholds are set.
struct CalibrationOptions {
  double margin = 1.3;  ///< [1] threshold over the largest value in training, as an amplitude
  std::vector<std::string> conditions;   ///< trained on; empty: training_conditions()
  std::vector<std::string> estimators;   ///< empty: all
  int runs = 20;                         ///< of 30 s for each condition
  int threads = 0;                       ///< 0: one a core
  std::function<void(double)> progress;  ///< called with the share that is done; may be empty
};

/// What thresholds are trained on unless said: the paper's range, 0 to 150 kg, known and unknown.
const std::vector<std::string>& training_conditions();

/// Sets every calibratable detector's thresholds behind every estimator: `margin` times the largest
/// statistic of training runs, free motion and slow pushes alone, for each of the study's velocity noises.
/// @throws std::invalid_argument for a margin below 1 and for unknown names
Thresholds calibrate(const CalibrationOptions& options);

}  // namespace tauext

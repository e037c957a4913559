// SPDX-License-Identifier: Apache-2.0
/// @file
/// What a robot brings to the studies: conditions that it meets, and runs that a seed draws. All
/// that belongs to one robot stands in study_runs.cc; the studies themselves know no robot by name.
/// Any other robot has those that every arm has.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/roster/robot.h"
#include "bench/score/degradation.h"
#include "mjcf/plant/model.h"
#include "mjcf/scenarios/region_runs.h"
#include "mjcf/scenarios/touch.h"

namespace tauext::study {

/// The first seed of calibration; test seeds stay below.
inline constexpr std::uint64_t kTrainingSeed = 1'000'000;

inline constexpr double kScoreFrom = 4;  ///< [s] an estimator has found an unknown panel by then
inline constexpr double kStartUp = 3;    ///< [s] detectors stay silent

/// How the arm of a study moves.
enum class Motions : std::uint8_t {
  kSlow,   ///< 0.1 rad about a pose
  kBrisk,  ///< up to 2 rad/s: for training sines, else from place to place
};

/// What the robot carries, what its estimators believe it does, and how well it measures.
struct Condition {
  std::string name, description;     ///< a word, and a line
  double panel = 0;                  ///< [kg] carried
  double believed = 0;               ///< [kg] in the estimators' model
  Degradation degradation{};         ///< faults of sensors, models and drives
  Motions motions = Motions::kSlow;  ///< how the arm moves
  int every = 1;                     ///< of so many samples at 1 kHz one is seen
  bool trains_itself = false;        ///< thresholds come from itself; else from StudyRuns::training
};

/// Conditions that differ in the sensors alone share their simulated runs.
struct PlantKey {
  double panel;                                       ///< [kg]
  ModelError error;                                   ///< what the estimators do not know
  Drives drives;                                      ///< likewise
  Motions motions;                                    ///< how it moves
  auto operator<=>(const PlantKey&) const = default;  // NOLINT(modernize-use-nullptr): not ours
};

/// What of a condition changes the simulation.
PlantKey plant_of(const Condition& c);

/// The runs of one robot. A function that is empty stands for runs that the robot does not have.
struct StudyRuns {
  const Robot* robot;  ///< that has them
  double carries = 0;  ///< [kg] the panel that its own model has

  // of the detection study and of calibration
  std::vector<Condition> conditions;  ///< all that there are
  std::vector<std::string> quick;     ///< those with blows and good sensors
  std::vector<std::string> honest;    ///< those with joints as people have measured them, at 1 kHz
  std::vector<std::string> training;  ///< conditions for calibration unless others are named
  std::function<Model(const PlantKey&)> model;                         ///< the simulated robot
  std::function<std::shared_ptr<const Robot>(double panel)> believer;  ///< estimators believe in it
  /// A run with touches.
  std::function<Scenario(TouchKind, std::uint64_t seed, Motions)> touched;
  std::function<std::vector<Touch>(TouchKind, std::uint64_t seed)> touches;  ///< those in that run
  /// Where regions of a body touch it; made when it is first asked for, and may throw.
  std::function<const TouchPoints&()> points;
};

/// The runs of a robot for the detection study; null stands for the first robot that has some.
/// @throws std::invalid_argument for one without such runs, naming those with
const StudyRuns& touched_runs(const Robot* robot = nullptr);

/// @throws std::invalid_argument for an unknown name, listing the known ones
const Condition& condition(const StudyRuns& runs, const std::string& name);

/// One run to simulate.
struct Job {
  PlantKey plant;      ///< the robot
  TouchKind kind;      ///< what touches it
  std::uint64_t seed;  ///< of the touches
  int region = -1;     ///< of region_classes(), which meet it instead of `kind`; -1: none do
};

/// Of a job with a region: its meetings, of which the first begins at kScoreFrom or later.
std::vector<RegionTouch> meetings_of(const StudyRuns& runs, const Job& job);

/// The true traces of runs of one robot.
std::vector<Trace> simulated(const StudyRuns& runs, std::span<const Job> jobs, const Model& model);

/// That MuJoCo simulates that run likewise, to 1e-9 of its largest values.
/// @param truth our simulation of that job
/// @throws std::runtime_error if it does not
void require_mujoco_agrees(const StudyRuns& runs, const Job& job, const Model& model,
                           const Trace& truth);

/// Every n-th sample; what was held between them is then read at instants.
Trace thinned(const Trace& trace, int n);

/// What the sensors make of a run, with a seed of their own.
Trace measured(const Trace& truth, Sensors sensors, const Job& job);

/// Runs as any sensors see them: measured(), with noise that is drawn once for all sensors.
class Views {
 public:
  /// Of true traces of these jobs.
  Views(std::vector<Trace> truths, std::span<const Job> jobs);

  /// What they see of each run, without its truth: of `every` samples one.
  std::vector<Trace> by(const Sensors& sensors, int every = 1);
  /// [N] on the arm at each sample of that run.
  const std::vector<double>& contact_force(std::size_t run) const { return forces_[run]; }

 private:
  std::vector<Trace> readings_;  // what can be measured
  std::vector<std::vector<double>> forces_;
  std::vector<std::uint64_t> seeds_;  // of the sensors
  std::vector<std::vector<Normals>> drawn_;
};

/// The names asked for, or those that stand for none.
/// @throws std::invalid_argument for an unknown name, listing the known ones
std::vector<std::string> chosen_conditions(const StudyRuns& runs,
                                           const std::vector<std::string>& asked,
                                           const std::vector<std::string>& otherwise);
/// The specifications asked for, or every estimator but the baselines.
/// @throws std::invalid_argument for an unknown name or key and for a value out of range
std::vector<std::string> chosen_estimators(const Robot& r, const std::vector<std::string>& asked);
/// The specifications asked for, or every detector.
/// @throws std::invalid_argument as chosen_estimators does
std::vector<std::string> chosen_detectors(const Robot& r, const std::vector<std::string>& asked);

}  // namespace tauext::study

// SPDX-License-Identifier: Apache-2.0
/// @file
/// A robot at run time: estimators and detectors by name.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/roster/detectors.h"
#include "bench/roster/estimators.h"
#include "bench/roster/pair.h"
#include "bench/roster/specification.h"
#include "bench/roster/thresholds.h"
#include "mjcf/arm_forces.h"
#include "mjcf/record.h"

namespace tauext {

/// The most coordinates of a robot from a file. Each number of joints is compiled for itself:
/// builds with sanitizers have fewer.
inline constexpr int kMaxFileJoints = TAUEXT_FILE_JOINTS;

/// Between the path of a robot's file and the joints that are fixed (ImportOptions), in its name.
inline constexpr std::string_view kLock = ":lock=";

/// Whether a robot of that name is a file, by its path, [:lock=REGEX] or not.
bool is_robot_file(std::string_view name);

/// A robot with the estimators and detectors that run on it. Wherever an estimator or a detector is
/// asked for, a specification (bench/roster/specification.h) is understood. Every call throws
/// std::invalid_argument for an unknown name or key, listing the known ones, and for a trace of
/// another number of joints.
class Robot {
 public:
  /// With these estimators, beside the baselines.
  /// @param file the model, if it is from a file
  /// @throws std::invalid_argument for a name that is taken
  Robot(std::string name, int dof, std::vector<EstimatorType> estimators,
        const Model& file = nullptr);
  /// With one more.
  /// @throws std::invalid_argument if its name is taken
  void add_detector(const DetectorType& type);
  /// Lists a specification among the estimators.
  /// @throws std::invalid_argument if it means nothing here, or is listed already
  void add_specification(const std::string& text);
  /// [1] factor of each joint on the torques of detectors' defaults.
  const JointVec<>& torques() const { return torques_; }

  const std::string& name() const { return name_; }  ///< by which robot() finds it
  /// Its name, or its file's without folder and, unless it is a .json or another robot is called
  /// so, ending.
  std::string label() const;
  int dof() const { return dof_; }  ///< joints
  /// Their names in a robot's file, by which recordings call them, too; else empty, and where q
  /// mixes joints.
  std::vector<std::string> joints() const;

  /// [N m] that matters little, of each joint: 5, or of a file's robot 1/240 of
  /// ArmScale::usual_torque.
  Eigen::VectorXd small_torque() const;
  /// The dry friction that studies hide from its estimators: 5 N m, or of a file's robot 5 % of
  /// what each joint is used to (ArmScale::usual_torque).
  ModelError hidden_friction() const;
  /// The same, like "5 N m of dry friction".
  std::string hidden_friction_in_words() const;

  /// Whether it is known by its MJCF alone: from a file, or of kRobotsByMjcf (roster.h).
  bool is_from_file() const { return file_ != nullptr; }
  /// Whether a joint of a file's robot slides: N and m stand for N m and rad.
  bool slides() const { return slides_; }
  /// Of a file's robot a number, as text, that tells two arms apart; else "".
  const std::string& fingerprint() const { return fingerprint_; }
  /// What acts on it where tau_ext is so: the force at a point of it, with the moment if asked, and
  /// the link that is touched, where a torque exceeds small_torque().
  /// @throws std::invalid_argument for an unknown point, listing the known ones, and as arm_forces
  std::unique_ptr<const ArmForces> forces_at(const std::string& site, bool moment) const;
  /// Makes torques of currents, by the gains of the robot's file, and adds gravity to those without
  /// it.
  /// @throws std::invalid_argument as tauext::make_torques() and add_gravity()
  void make_torques(Trace& trace) const;
  /// @throws std::invalid_argument for samples of another number of joints, naming the log unless
  /// it is ""
  void require_joints(int joints, const std::string& log = "") const;
  /// @throws std::invalid_argument naming the log where its q, from least to most [rad], goes far
  /// outside the range of a joint
  void require_range(const Eigen::VectorXd& least, const Eigen::VectorXd& most,
                     const std::string& log) const;
  /// Both of a log's trace; of one that is no log ("") the number of joints alone.
  void require_joints(const Trace& trace, const std::string& log) const;
  /// [N m/A] of each drive; 0 where nobody says.
  Eigen::VectorXd gains() const;
  /// [rad] or [m] a bent pose: ArmScale::home of a file's robot; else 0.
  Eigen::VectorXd home() const;

  /// What happens to it; the generic ones (mjcf/scenarios/generic.h) if it is from a file.
  /// @throws std::invalid_argument if it is from a file and too_stiff() to be simulated
  const std::vector<Scenario>& scenarios() const;
  /// What it looks like, and is; not always fit to be simulated.
  Model model() const;
  /// The simulated robot as the scenario needs it, with errors that its estimators do not know of.
  /// @throws std::invalid_argument for an error out of range, and as scenarios() does
  Model load_for(const Scenario& scenario, const ModelError& error = {}) const;

  /// simulate_plain() (mjcf/record_plain.h): the truth of runs of this arm, or of one that is
  /// changed from it.
  std::vector<Trace> simulate(const Model& arm, std::span<const Scenario> scenarios,
                              const Recording& recording) const;

  std::vector<std::string> estimators() const;    ///< by name, or specification
  std::vector<std::string> detectors() const;     ///< by name
  std::vector<std::string> tunable() const;       ///< estimators with the key `bandwidth`
  std::vector<std::string> calibratable() const;  ///< detectors with thresholds from data
  /// The specifications of the detectors whose thresholds one takes: itself, those that it is made
  /// of, or none.
  std::vector<std::string> trained_parts(std::string_view detector) const;

  /// What can be set in an estimator or a detector.
  const std::vector<FieldHelp>& estimator_fields(std::string_view name) const;
  const std::vector<FieldHelp>& detector_fields(std::string_view name) const;  ///< of a detector

  /// An estimator, with a detector behind it unless that is "".
  /// @param trace which it will see; an estimator that copies the truth copies this one's, and
  /// where its torques were read at instants, estimators take them so; else it may be empty
  /// @throws std::invalid_argument for an estimator that needs a truth which the trace does not
  /// have
  Pair pair(std::string_view estimator, std::string_view detector, const Trace& trace,
            const DetectorSettings& settings = {}) const;
  /// What an estimator makes of a trace.
  Output run(std::string_view estimator, const Trace& trace) const {
    return pair(estimator, "", trace).run(trace);
  }

  /// Nothing, if the specifications of an estimator and of a detector (or "") are good ones: to be
  /// asked before any work begins.
  void check(std::string_view estimator, std::string_view detector) const;

  /// The pair as the one who stops the motor: at the first mark. It never sees a truth.
  /// @param drives of the arm that it stops: where they are elastic, torques are read at instants
  /// @throws std::invalid_argument for an estimator that copies the truth
  Supervisor supervisor(std::string_view estimator, std::string_view detector, const Drives& drives,
                        const DetectorSettings& settings = {}) const;

  /// So many runs are done at once, by stages of runs.
  static int runs_at_once();

  /// What a detector says of estimates that an estimator made of the trace, sample by sample.
  std::vector<Detection> detect(std::string_view detector, const Trace& trace,
                                const Output& estimates, const DetectorSettings& settings) const;

  /// How a calibratable detector's thresholds are set.
  const Calibration& calibration(std::string_view detector) const;
  /// The type that a detector's specification names.
  const DetectorType& detector_type(std::string_view specification) const;

  /// The stage of an estimator, for pair()'s trace.
  /// @throws std::invalid_argument as pair()
  std::unique_ptr<EstimatorStage<>> estimator(std::string_view specification,
                                              const Trace& trace) const;
  /// The same for as many runs as runs_at_once(), of which the trace is one; null where it cannot.
  /// @param terms of these runs, or null
  std::unique_ptr<EstimatorStage<EstimatorType::Lanes>> estimator_of_runs(
      std::string_view specification, const Trace& trace, SharedTerms* terms) const;
  /// The stage of a detector.
  std::unique_ptr<DetectorStage<>> detector(std::string_view specification,
                                            const DetectorSettings& settings) const;
  /// The same for several runs; null where it cannot.
  std::unique_ptr<DetectorStage<EstimatorType::Lanes>> detector_of_runs(
      std::string_view specification, const DetectorSettings& settings) const;

 private:
  void require_fit() const;
  void add_estimator(EstimatorType type);
  const EstimatorType& estimator_type(std::string_view specification) const;

  std::string name_;
  int dof_;
  Model file_;         // to be simulated
  std::string unfit_;  // why it cannot be
  std::string fingerprint_;
  bool slides_ = false;
  Eigen::VectorXd usual_torque_;  // ArmScale::usual_torque [N m] of a file's robot; else empty
  JointVec<> torques_;            // [1] factor of each joint on those of detectors' defaults
  std::vector<EstimatorType> estimators_;
  std::vector<std::string> specifications_;  // that are listed beside them
  std::vector<DetectorType> detectors_;
  mutable std::once_flag listed_;
  mutable std::vector<Scenario> scenarios_;  // of a file's robot
};

/// Adds a scenario to the robot's list, before that is first asked for.
/// @throws std::invalid_argument if the name is taken or empty
void register_scenario_of(const Robot& robot, const Scenario& scenario);

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// What happens to an arm: how it is told to move, and what the outside does to it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mjcf/model_error.h"
#include "mjcf/motion.h"
#include "mjcf/plant.h"

namespace tauext {

/// How the estimates of a scenario are judged beyond their error.
enum class Response {
  kNone,       ///< nothing but the error
  kStep,       ///< rise, settling and overshoot, from the largest jump of the truth
  kLag,        ///< the delay of the estimate behind a truth that moves all the time
  kDetection,  ///< marks against the recorded contact
  kBandwidth,  ///< where the estimate of a swept sine falls to -3 dB
};

/// The tracking controller: computed torque, tau = B (qdd_ref + Kp e + Kd edot) + C qd + D qd + g with
/// the exact model, dry friction left to the feedback. The paper names no controller, but its runs
/// presuppose one: under gravity compensation alone wallmobot3 falls over within 2 s of the step.
struct Tracking {
  double Kp = 400;  ///< [1/s^2]
  double Kd = 40;   ///< [1/s]
};

/// A load that hangs on the end effector: a body of its own on a tether (scene "load").
struct Load {
  double mass = 1;                                           ///< [kg]
  double hang_at = 0;                                        ///< [s]
  double drop_at = std::numeric_limits<double>::infinity();  ///< [s]
  std::function<Eigen::Vector3d(double)> push;  ///< [N] world, on the load while it hangs
};

/// A run of a robot. Functions are of time [s]; what they return is held over one sample.
struct Scenario {
  std::string name;
  std::string description;  ///< one line, with numbers and units
  double duration = 30;     ///< [s]
  double score_from = 0;    ///< [s] errors before this are not counted
  Response response = Response::kNone;
  bool start_on_reference = false;  ///< else the arm starts at rest at q = 0
  bool floats = false;  ///< manual mode: tau = C qd + g alone, so that a hand can move the arm
  Tracking tracking;
  std::function<Reference(double)> reference;  ///< of every joint
  std::function<double(double)> tau_ext;       ///< [N m] on every joint, sign of (3)
  /// [N] world, on the end effector, which is where the second argument says
  std::function<Eigen::Vector3d(double, const Point&)> force;
  std::function<bool(double)> contact;  ///< whether a collision acts; the obstacle's adds to it
  std::string scene;         ///< what stands around the arm: a name of mjcf/scene_*.xml, or ""
  std::optional<Load> load;  ///< with the scene "load"
  bool reacts = false;       ///< whether a detector's mark stops the motor: a closed loop
};

/// All scenarios of a robot, in the order in which they are listed.
/// @throws std::invalid_argument for a robot without scenarios
const std::vector<Scenario>& scenarios(std::string_view robot);

/// The scenario of that name.
/// @throws std::invalid_argument for an unknown name, listing the known ones
const Scenario& scenario(std::string_view robot, std::string_view name);

/// A scenario in which nothing happens: 30 s at rest at q = 0. Start from here for one of your own.
Scenario quiet();

/// Adds a scenario to a robot's list; before the list is first asked for, else std::logic_error.
/// @throws std::invalid_argument if the name is empty or taken
void register_scenario(const std::string& robot, const Scenario& scenario);

/// The robot as the scenario needs it: with its scene, and the load as heavy as it says; and with errors
/// that its estimators do not know of.
/// @throws std::invalid_argument for an error out of range
Model load_for(std::string_view robot, const Scenario& scenario, const ModelError& error = {});

/// `manual` of testbed1 with other moves of the hand; seed 1 is the one in the list.
Scenario manual_of_testbed1(std::uint64_t seed);

/// A blow on testbed1's tip while it moves up, down or rests: upwards or downwards, a half sine of 100
/// to 300 N and 10 to 50 ms, each drawn by the seed. 2 s long.
Scenario blow_on_testbed1(std::uint64_t seed);

}  // namespace tauext

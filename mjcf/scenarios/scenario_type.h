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
#include <vector>

#include "mjcf/plant/model_error.h"
#include "mjcf/plant/plant.h"
#include "mjcf/scenarios/motion.h"
#include "mjcf/scenarios/regions.h"
#include "mjcf/trace/sensors.h"

namespace tauext {

/// How the estimates of a scenario are judged beyond their error.
enum class Response {
  kNone,       ///< nothing but the error
  kStep,       ///< rise, settling and overshoot, from the largest jump of the truth
  kLag,        ///< the delay of the estimate behind a truth that moves all the time
  kDetection,  ///< marks against the recorded contact
  kBandwidth,  ///< where the estimate of a swept sine falls to -3 dB
};

/// The tracking controller: computed torque, tau = B (qdd_ref + Kp e + Kd edot) + C qd + D qd + g
/// with the exact model, dry friction left to the feedback. The paper names no controller, but its
/// runs presuppose one: under gravity compensation alone wallmobot3 falls over within 2 s of the
/// step.
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

/// A run of a robot. Functions are of time [s], some also of a joint, counted from 0; what they
/// return is held over one sample.
struct Scenario {
  std::string name;                     ///< unique among those of the robot
  std::string description;              ///< one line, with numbers and units
  double duration = 30;                 ///< [s]
  double score_from = 0;                ///< [s] errors before this are not counted
  Response response = Response::kNone;  ///< what is asked beyond the error
  bool start_on_reference = false;      ///< else the arm starts at rest at q = 0
  bool floats = false;  ///< manual mode: tau = C qd + g alone, so that a hand can move the arm
  Tracking tracking;    ///< of the controller
  std::function<Reference(double, int)> reference;  ///< of that joint
  std::function<double(double, int)> tau_ext;       ///< [N m] on that joint, sign of (3)
  /// [N] world, on the end effector, which is where the second argument says
  std::function<Eigen::Vector3d(double, const Point&)> force;
  /// Whether a collision acts, the end effector being there; the obstacle's adds to it.
  std::function<bool(double, const Point&)> contact;
  std::vector<RegionTouch> regions;  ///< of a person's body that the arm meets, in their order
  std::string scene;            ///< what stands around the arm: a name of mjcf/scene_*.xml, or ""
  std::optional<Load> load;     ///< with the scene "load"
  bool reaches_limits = false;  ///< of joints, whose torque is tau_ext then; else they end the run
  Sensors sensors;              ///< of this scenario, where nobody asks for others
  ModelError model_error;       ///< what the estimators do not know in it, likewise
  bool reacts = false;          ///< whether a detector's mark stops the motor: a closed loop

  /// Whether something stands in the arm's way: the names of such scenes end in "obstacle".
  bool has_obstacle() const { return scene.ends_with("obstacle"); }
};

/// A scenario in which nothing happens: 30 s at rest at q = 0. Start from here for one of your own.
Scenario quiet();

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// What an estimator does not know about its robot. The errors change the simulated robot; its
/// controller knows them, the estimators keep the model of the files.
#pragma once

#include <compare>

#include "mjcf/plant/model.h"

namespace tauext {

/// Changes of a robot against the model that the estimators have of it.
struct ModelError {
  double mass = 1;      ///< [1] factor on mass and inertia of the arm's last link, panel included
  double com = 0;       ///< [m] by which that link's centre of mass lies farther from its joint
  double friction = 0;  ///< [N m] dry friction, on top of what the robot has, on every joint
  double friction_share = 0;  ///< [1] of ArmTree::usual_torque of each joint, likewise
  double viscous = 0;         ///< [N m s/rad] viscous friction, likewise
  double armature = 0;        ///< [kg m^2] inertia of a rotor on every joint, likewise

  auto operator<=>(const ModelError&) const = default;  // NOLINT(modernize-use-nullptr): not ours

  bool none() const { return *this == ModelError(); }  ///< the robot is as its file says
};

/// A copy of the robot, scene included, with these errors. "Every joint" means MuJoCo's that follow
/// no other: on wallmobot3 the second one turns by q3 - q2.
/// @throws std::invalid_argument for an error out of range, naming it
Model with_errors(const Model& robot, const ModelError& error);

}  // namespace tauext

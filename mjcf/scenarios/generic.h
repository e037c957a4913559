// SPDX-License-Identifier: Apache-2.0
/// @file
/// Scenarios for any arm, scaled to it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mjcf/scenarios/scenario_type.h"
#include "mjcf/scenarios/touch.h"

namespace tauext {

/// What the generic scenarios of an arm are scaled by, joint by joint [rad or m, N m or N].
struct ArmScale {
  Eigen::VectorXd home;       ///< a bent pose about the middle of the joints' ranges
  Eigen::VectorXd amplitude;  ///< of slow motions about it: 0.1 rad, or less in a short range
  Eigen::VectorXd reach;      ///< of brisk ones: 0.8 rad, or three quarters of the way to a limit
  /// What each joint is used to: ArmTree::usual_torque, or three times what `force` does to it, or,
  /// of a joint without the armature of a rotor, the effort that the file states
  /// (ArmTree::rated_torque), up to 10 times ArmTree::usual_torque. An effort counts below 1e5 N m,
  /// and from what the joint is used to on; and none does where all are above 10 times that.
  Eigen::VectorXd usual_torque;
  bool by_effort = false;  ///< whether some effort counts
  /// Of loads on the joints: a fifth of usual_torque, or what moves a joint by 0.05 rad against the
  /// tracking controller; by effort they are nowhere less than without it.
  Eigen::VectorXd torque;
  /// The two directions, world frame, in which a force on the end effector moves the arm most, or
  /// twice the only one.
  Eigen::Matrix<double, 3, 2> directions;
  double mass = 0;  ///< [kg] of the end effector between these directions, by B at home
  /// [N] of what is caught, pushes being smaller: 20 m/s^2 of that mass, 300 N, what moves a joint
  /// by 0.05 rad, or what the drives can hold where the file says it (ArmTree::rated_torque). 0 if
  /// no force on the end effector moves the arm.
  double force = 0;
  /// [N] of blows: the same; or, where `by_effort`, what the drives can hold, 300 N, or what moves
  /// a joint by 0.05 rad in the 20 ms of a blow.
  double blow = 0;
  bool gives_way = false;  ///< whether that joint limits the blow
};

/// @throws std::invalid_argument if the model cannot be simulated (mjcf/mujoco/layout.h)
ArmScale scale_of(const Model& model);

/// free, step, ramp, sine, chirp, in_motion, and, where a force on the end effector moves the arm,
/// push, blow, clamp and contact.
/// @throws std::invalid_argument as scale_of does
std::vector<Scenario> generic_scenarios(const Model& model);

/// A run for studies: about home by half to all of the amplitude and 0.5 to 1 rad/s as the seed
/// draws them, 30 s, with touches of one kind from 4 s on, in the plane of the directions. A blow
/// has a third to all of `blow`, other touches of `force` in proportion.
Scenario touched_arm(const ArmScale& scale, TouchKind kind, std::uint64_t seed);

/// The touches in that run.
std::vector<Touch> touches_of(const ArmScale& scale, TouchKind kind, std::uint64_t seed);

}  // namespace tauext

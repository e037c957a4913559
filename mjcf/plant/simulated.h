// SPDX-License-Identifier: Apache-2.0
/// @file
/// An arm as its ArmTree has it, made fit for MuJoCo, or for a simulation without.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "mjcf/plant/tree.h"
#include "mjcf/trace/screw.h"

namespace tauext {

/// Whether the damping of some joint is too quick for samples of 1 ms, and for RK4: stops the joint
/// faster than 500 1/s. Then why, and what helps; else "".
/// @throws std::invalid_argument as tree_of does
std::string too_stiff(const Model& model);

/// The arm to be simulated as its ArmTree has it: by RK4, ideal motors of gain 1 on the joints
/// that follow no other, in their order, rigid ties, and the same smooth dry friction, so that
/// nothing is left to the estimators but what a scenario or a model error hides from them. Without
/// contacts, which shapes that somebody drew would have with each other: what touches it is a
/// scenario's force.
Model simulated(const Model& model);

/// Dry friction by MuJoCo's solver, of each of its joints: of rho, it brakes by D (d2rho + rate
/// drho), within +-most.
struct SolverFriction {
  Eigen::VectorXd most;  ///< [N m] frictionloss; 0 without
  Eigen::VectorXd D;     ///< [kg m^2] large: a joint that it holds hardly moves
  Eigen::VectorXd rate;  ///< [1/s]
};

/// What its simulation needs of an arm, in plain numbers.
struct PlainArm {
  ArmTree tree;                     ///< its joints
  std::vector<Screw> screws;        ///< of the joints; empty if the robot has none
  Eigen::VectorXd least, most;      ///< [N m] what the motors can do
  Eigen::VectorXd lowest, highest;  ///< [rad] or [m] of MuJoCo's joints, short of their limits
  SolverFriction dry;               ///< beside the tree's
  double timestep = 0;              ///< [s] for which that holds
};

/// Nothing for an arm that needs MuJoCo: with something around it, with shapes that may touch each
/// other, joints that follow others, or another integrator; with dry friction by the solver, with
/// another one than Newton's, or a tolerance of that above 1e-15: it is inexact then.
std::optional<PlainArm> plain_arm(const Model& model);

}  // namespace tauext

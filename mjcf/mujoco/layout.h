// SPDX-License-Identifier: Apache-2.0
/// @file
/// Which parts of a MuJoCo model are the arm, its screws and its load.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjcf/mujoco/handles.h"
#include "mjcf/trace/screw.h"

namespace tauext {

/// Actuators, in this order:
///  - one motor of unit gain on a joint or a fixed tendon for each joint: its length is q_i, its
///    force tau_i. So q = S rho + const, rho the positions of the arm's degrees of freedom; Joints
///    that rigidly follow others (mjcf/mujoco/ties.h) have no motor; rho = T q + const holds for all.
///  - none, or one motor of unit gain on a spatial tendon for each joint: a linear screw, which is
///    never driven here but says what a loadcell at its end feels.
///  - with the scene "load", the switch of the tether.
/// Further degrees of freedom are the scene's: bodies that meet the arm by contacts and tethers
/// only.
struct Layout {
  int dof = 0;                ///< joints
  std::vector<int> arm;       ///< the arm's degrees of freedom in the model
  std::vector<int> leaders;   ///< those of them that follow no other
  Eigen::MatrixXd S;          ///< dq/drho
  Eigen::MatrixXd T;          ///< drho/dq; S T = 1
  Eigen::VectorXd q0;         ///< [rad] or [m] q at rho = 0
  Eigen::VectorXd rho0;       ///< [rad] or [m] rho at q = 0
  std::vector<Screw> screws;  ///< of the joints; empty if the robot has none
  int load_dof = -1;          ///< first of the load's three; -1: no load
  int tether = -1;            ///< its actuator
};

/// A point that a body carries.
struct BodyPoint {
  int body = 0;                                  ///< its number in the model
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< [m] in its frame
  std::string what;                              ///< in words
};

/// The name of the point that touches the outside, in every arm.
inline constexpr const char* kEndEffector = "end_effector";

/// The site `end_effector`, else the body of that name (a link of URDF, which has no sites), else
/// the site `attachment_site`, else the centre of mass of the body behind the last of the arm's
/// degrees of freedom that moves alone: joints that follow each other are a gripper's.
BodyPoint end_effector_of(const mjModel& m, int last);

/// @param d at any state of m, after mj_forward
/// @throws std::invalid_argument if the model is not laid out like that, naming what is not
Layout layout_of(const mjModel& m, const mjData& d);

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// estimators/force/ for an arm of any number of joints, from its model.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

#include "estimators/force/touch_place.h"
#include "mjcf/mujoco/layout.h"
#include "mjcf/plant/model.h"

namespace tauext {

/// What is looked for.
struct ArmForceOptions {
  std::string site = kEndEffector;  ///< where the force acts: a site or a body
  bool moment = false;              ///< SiteForceParameters::moment
  Eigen::VectorXd limits;  ///< [N m] of TouchFinder, per joint; empty: touch() is not asked
};

/// From the joints' torques to what acts on an arm. q [rad] and tau_ext [N m, sign of (3)] point to
/// a number for each joint.
class ArmForces {
 public:
  virtual ~ArmForces() = default;

  /// The force at the site.
  virtual SiteForce at_site(const double* q, const double* tau_ext) const noexcept = 0;
  /// Where the arm is touched; link -1 without limits.
  virtual TouchPlace touch(const double* q, const double* tau_ext) const noexcept = 0;
  /// tau_ext = -J^T f [N m] of a force f [N] at the site, in the axes of the base.
  virtual Eigen::VectorXd torque(const Eigen::VectorXd& q, const Vec<3>& f) const = 0;
};

/// Of an arm of 1 to 8 joints.
/// @throws std::invalid_argument as tree_of, ArmTree::point and ForceAtSite do, and for more joints
std::unique_ptr<const ArmForces> arm_forces(const Model& arm, const ArmForceOptions& options = {});

/// In words: which link is touched.
/// @param link the joint, from 1, that carries it; 0: none
/// @param dof joints of the arm
std::string touched_link(int link, int dof);

}  // namespace tauext

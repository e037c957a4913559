// SPDX-License-Identifier: Apache-2.0
/// @file
/// From an arm in MJCF to the plain numbers of the estimators' own model of it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "estimators/force/site_force.h"
#include "estimators/tree/tree_model.h"
#include "mjcf/plant/model.h"

namespace tauext {

/// The joints of an arm and the bodies behind them.
///
/// Coordinates: MuJoCo's own, one for each hinge or slide in the file's order, whatever gears its
/// actuators have; but where motors on fixed tendons say what the joint coordinates are
/// (mjcf/plant/layout.h, wallmobot3), these. Friction is the file's damping and frictionloss of
/// joints, the latter smooth over 0.01 rad/s (estimators/friction.h says why), or over more where
/// its slope would stop the joint faster than 500 1/s. Bodies without a joint belong to the body
/// that carries them.
struct ArmTree {
  std::vector<TreeJoint> joints;    ///< in the file's order
  Vec<3> gravity = Vec<3>::Zero();  ///< [m/s^2]
  Eigen::MatrixXd coordinates;      ///< dq/drho, rho being MuJoCo's
  Eigen::VectorXd offset;           ///< [rad] q at rho = 0
  Eigen::VectorXd lower;  ///< [rad] or [m] of q's range; infinite without one, or if q is mixed
  Eigen::VectorXd upper;  ///< likewise
  /// [N m] or [N] what each joint is used to: the larger of its gravity torque, over poses in all
  /// of its range, and of 10 rad/s^2 of its own inertia.
  Eigen::VectorXd usual_torque;
  /// [1/(kg m^2)] or [1/kg] how easily each of MuJoCo's joints moves: the largest diagonal of the
  /// inverse of its inertia, over these poses.
  Eigen::VectorXd mobility;
  Vec<3> base = Vec<3>::Zero();  ///< [m] the tree's origin in the world, whose axes it has
  /// Sites, and origins of bodies, that joints move; and kEndEffector.
  std::map<std::string, ArmPoint> points;

  std::string end_effector;  ///< what kEndEffector is, in words

  /// A point by its name.
  /// @throws std::invalid_argument listing the known ones
  const ArmPoint& point(const std::string& name) const;
};

/// @throws std::invalid_argument for what it would have to ignore: free or ball joints, springs,
/// equality constraints, forces of tendons, a fluid; and for motors on tendons with gears
ArmTree tree_of(const Model& model);

/// Whether the damping of some joint is too quick for samples of 1 ms, and for RK4: stops the joint
/// faster than 500 1/s. Then why, and what helps; else "".
/// @throws std::invalid_argument as tree_of does
std::string too_stiff(const Model& model);

/// The arm to be simulated as its ArmTree has it: by RK4, ideal motors of gain 1 on the joints, in
/// their order, and the same smooth dry friction, so that nothing is left to the estimators but
/// what a scenario or a model error hides from them. Without contacts, which shapes that somebody
/// drew would have with each other: what touches it is a scenario's force.
Model simulated(const Model& model);

namespace detail {
/// @throws std::invalid_argument unless they are equal
void require_equal_joints(std::size_t have, int want);
}  // namespace detail

/// The model of an arm of N joints, without MuJoCo in it.
/// @throws std::invalid_argument as tree_of does, and for another number of joints
template <int N>
TreeModel<N> tree_model(const Model& model) {
  const ArmTree tree = tree_of(model);
  detail::require_equal_joints(tree.joints.size(), N);
  typename TreeModel<N>::Parameters p;
  for (std::size_t i = 0; i < N; ++i) p.joints[i] = tree.joints[i];
  p.gravity = tree.gravity;
  p.coordinates = tree.coordinates;
  p.offset = tree.offset;
  return TreeModel<N>(p);
}

}  // namespace tauext

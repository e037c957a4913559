// SPDX-License-Identifier: Apache-2.0
/// @file
/// From an arm in MJCF to the plain numbers of the estimators' own model of it.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "estimators/force/site_force.h"
#include "estimators/tree/tree_model.h"
#include "mjcf/plant/model.h"

namespace tauext {

/// The most coordinates of an arm from a file.
inline constexpr int kMostCoordinates = 8;
/// The most joints of it that follow others.
inline constexpr int kMostFollowers = 8;

/// [1/s] the quickest friction that samples of 1 ms show: it stops 40 % of a speed within one.
inline constexpr double kQuickestFriction = 500;

/// The joints of an arm and the bodies behind them.
///
/// Coordinates: MuJoCo's own, one for each hinge or slide in the file's order that follows no
/// other (mjcf/mujoco/ties.h), whatever gears its actuators have; but where motors on fixed
/// tendons say what the joint coordinates are (mjcf/mujoco/layout.h, wallmobot3), these. Friction
/// is the file's damping and frictionloss of joints, the latter smooth over 0.01 rad/s
/// (estimators/math/friction.h says why), or over more where its slope would stop the joint faster
/// than kQuickestFriction. Bodies without a joint belong to the body that carries them.
struct ArmTree {
  std::vector<TreeJoint> joints;    ///< in the file's order
  std::vector<std::string> names;   ///< of these joints; "" without one
  std::vector<std::string> bodies;  ///< likewise, of those behind them, in whose axes they are
  Vec<3> gravity = Vec<3>::Zero();  ///< [m/s^2]
  Eigen::MatrixXd drho;             ///< drho/dq, rho being MuJoCo's
  Eigen::VectorXd rho0;             ///< [rad] or [m] rho at q = 0
  /// For each coordinate the number, from 0, of the joint whose position it is; with motors on
  /// tendons, where q mixes joints, of the one of its own number.
  std::vector<int> leaders;
  /// [rad] or [m] of q's range and those of joints that follow; infinite without one, or where q
  /// is mixed
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;  ///< likewise
  /// [N m] or [N] what each coordinate is used to: the larger of its gravity torque, over poses in
  /// all of its range, and of 10 rad/s^2 of its own inertia.
  Eigen::VectorXd usual_torque;
  /// [1/(kg m^2)] or [1/kg] how easily each of MuJoCo's joints moves: the largest diagonal of the
  /// inverse of its inertia, over these poses.
  Eigen::VectorXd mobility;
  /// [1/s] how fast damping stops each of MuJoCo's joints, with those that move with it.
  Eigen::VectorXd friction_rate;
  /// [N m/A] of the drive of each coordinate; 0 if nobody knows
  Eigen::VectorXd gain;
  /// [N m] or [N] what the drive of each coordinate can do; 0 where the file does not say
  Eigen::VectorXd rated_torque;
  Eigen::VectorXd rated_speed;   ///< [rad/s] or [m/s] likewise
  Vec<3> base = Vec<3>::Zero();  ///< [m] the tree's origin in the world, whose axes it has
  /// Sites, and origins of bodies, that joints move; and kEndEffector.
  std::map<std::string, ArmPoint> points;

  std::string end_effector;  ///< what kEndEffector is, in words

  int dof() const { return static_cast<int>(drho.cols()); }  ///< coordinates
  bool slides(int i) const;                                  ///< whether q_i is one of a slide
  /// Of each coordinate its joint's name; empty where one has none, or is no joint's position.
  std::vector<std::string> joint_names() const;
  /// A point by its name.
  /// @throws std::invalid_argument listing the known ones
  const ArmPoint& point(const std::string& name) const;
};

/// @throws std::invalid_argument for what it would have to ignore: free or ball joints, springs,
/// forces of tendons, a fluid; for motors on tendons with gears, or beside joints that follow
/// others; for joints whose ranges leave them no way; and as ties_of does
ArmTree tree_of(const Model& model);

namespace detail {
/// @throws std::invalid_argument unless it has that many coordinates, and joints that fit
void require_size(const ArmTree& tree, int coordinates);

/// The model of an arm in the estimators' numbers, filled up as TiedTree (any_tree.h) says.
/// @throws std::invalid_argument for an arm that is larger than that type
template <class Tree>
Tree filled(const ArmTree& tree) {
  const auto joints = static_cast<Eigen::Index>(tree.joints.size());
  typename Tree::Parameters p;
  if (tree.joints.size() > p.joints.size() || tree.dof() > Tree::kDof)
    throw std::invalid_argument("the arm has too many joints; --lock REGEX fixes some");
  std::copy(tree.joints.begin(), tree.joints.end(), p.joints.begin());
  p.gravity = tree.gravity;
  p.drho.setZero();
  p.drho.topLeftCorner(joints, tree.dof()) = tree.drho;
  for (int i = tree.dof(); i < Tree::kDof; ++i) {
    const Eigen::Index at = joints + i - tree.dof();
    p.drho(at, i) = p.joints[static_cast<std::size_t>(at)].armature = 1;
  }
  p.rho0.head(joints) = tree.rho0;
  return Tree(p);
}
}  // namespace detail

/// The model of an arm of N joints, of which none follows another, without MuJoCo in it.
/// @throws std::invalid_argument as tree_of does, and for another number of joints
template <int N>
TreeModel<N> tree_model(const Model& model) {
  const ArmTree tree = tree_of(model);
  detail::require_size(tree, N);
  if (tree.joints.size() != N)
    throw std::invalid_argument("joints follow others; any_tree() takes such arms");
  return detail::filled<TreeModel<N>>(tree);
}

}  // namespace tauext

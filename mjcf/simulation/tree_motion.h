// SPDX-License-Identifier: Apache-2.0
/// @file
/// The motion of an arm that nothing but prescribed torques acts on, by the estimators' own
/// dynamics: equation (3), and RK4.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>

#include "mjcf/plant/plant.h"
#include "mjcf/plant/simulated.h"

namespace tauext {

/// Where such an arm is, and what moves it.
struct TreeState {
  /// A number of each joint, without a heap.
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostCoordinates, 1>;
  /// Over the joints.
  using Matrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostCoordinates, kMostCoordinates>;

  /// At rest where q is 0, with so many joints.
  explicit TreeState(int joints)
      : q(Vector::Zero(joints)),
        qd(q),
        tau(q),
        tau_ext(q),
        qdd(q),
        bias(q),
        damping(q),
        friction(q) {
    B.setZero(joints, joints);
  }

  Vector q, qd;         ///< [rad], [rad/s]
  Vector tau, tau_ext;  ///< [N m] what acts, sign of (3)
  // what follows from these
  Vector qdd;       ///< [rad/s^2]; NaN where none was found
  Vector bias;      ///< [N m] C qd + g
  Vector damping;   ///< [N m] of F what is smooth
  Vector friction;  ///< [N m] F
  Matrix B;         ///< [kg m^2]
};

/// The dynamics of such an arm, whatever its number of joints.
class TreeMotion {
 public:
  virtual ~TreeMotion() = default;
  virtual void look(TreeState& s) const = 0;        ///< sets what follows
  virtual void accelerate(TreeState& s) const = 0;  ///< sets qdd, where only torques are new
  /// h [s] on, with these torques, of as many runs as there are; looks.
  virtual void step(std::span<TreeState* const> runs, double h) const = 0;
  virtual Point point(const TreeState& s, const ArmPoint& at) const = 0;  ///< in the tree's axes
  /// -J^T f [N m] of a force f [N] on the arm at that point.
  virtual TreeState::Vector tau_ext_of(const TreeState& s, const ArmPoint& at,
                                       const Vec<3>& f) const = 0;
};

/// The dynamics of an arm whose joints do not follow each other; null for more joints than are
/// compiled.
std::unique_ptr<const TreeMotion> tree_motion(const PlainArm& arm);

}  // namespace tauext

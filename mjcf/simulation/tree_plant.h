// SPDX-License-Identifier: Apache-2.0
/// @file
/// An arm that nothing but prescribed forces acts on, simulated by the estimators' own dynamics, in
/// a tenth of the time.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "mjcf/plant/plant.h"
#include "mjcf/plant/simulated.h"
#include "mjcf/simulation/tree_motion.h"
#include "mjcf/trace/screw.h"

namespace tauext {

/// As Plant; functions of the same name mean the same.
class TreePlant {
 public:
  using Vector = TreeState::Vector;  ///< a number of each joint

  /// The motion is that of the arm.
  TreePlant(PlainArm arm, std::shared_ptr<const TreeMotion> motion);

  int dof() const { return arm_.tree.dof(); }  ///< joints
  /// Empty if the robot has none.
  const std::vector<Screw>& screws() const { return arm_.screws; }

  /// At q [rad], qd [rad/s], at rest from inputs.
  void set_state(const Vector& q, const Vector& qd);
  /// Applies tau [N m], clipped, and tau_ext [N m, sign of (3)] from now on.
  void set_input(const Vector& tau, const Vector& tau_ext);

  const Vector& q() const { return s_.q; }                   ///< [rad]
  const Vector& qd() const { return s_.qd; }                 ///< [rad/s]
  const Vector& tau() const { return s_.tau; }               ///< [N m] as applied, clipped
  const Vector& tau_ext() const { return s_.tau_ext; }       ///< [N m] the input
  const Vector& qdd() const { return s_.qdd; }               ///< [rad/s^2] under the present input
  const TreeState::Matrix& inertia() const { return s_.B; }  ///< B [kg m^2]
  const Vector& bias() const { return s_.bias; }             ///< C qd + g [N m]
  const Vector& damping() const { return s_.damping; }       ///< of F what is smooth [N m]
  const Vector& friction() const { return s_.friction; }     ///< F [N m]
  double contact_force() const { return 0; }                 ///< [N] nothing touches it

  using Place = ArmPoint;                             ///< a point of the arm
  Place place(const std::string& name) const;         ///< ArmTree::point, with its errors
  Point point(const Place& at) const;                 ///< where it is
  Point end_effector() const { return point(end_); }  ///< the point that touches the outside
  /// -J^T f [N m] of a force f [N, world frame] on the arm at its end effector.
  Vector tau_ext_of(const Eigen::Vector3d& f) const { return tau_ext_of(f, end_); }
  /// The same at another point.
  Vector tau_ext_of(const Eigen::Vector3d& f, const Place& at) const {
    return motion_->tau_ext_of(s_, at, f);
  }

  /// Whether MuJoCo has to take over: near a limit of a joint, or far from anywhere.
  bool is_lost() const;

  /// Integrates over h [s] by RK4, input held.
  void step(double h) {
    TreeState* const run = &s_;
    motion_->step({&run, 1}, h);
  }
  /// The same of several of one arm, in less time.
  static void step(std::span<TreePlant* const> all, double h);

 private:
  PlainArm arm_;
  std::shared_ptr<const TreeMotion> motion_;
  TreeState s_;
  ArmPoint end_;
  Vector least_, most_;      // [N m] what the motors can do
  TreeState::Matrix drho_;   // of the tree
  Vector lowest_, highest_;  // [rad] or [m] of rho - rho0
};

}  // namespace tauext

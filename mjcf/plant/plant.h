// SPDX-License-Identifier: Apache-2.0
/// @file
/// A robot in MuJoCo, in the joint coordinates q of its actuators, as the equation (3) sees it.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjcf/mujoco/layout.h"
#include "mjcf/plant/model.h"
#include "mjcf/trace/screw.h"

namespace tauext {

/// A point of the arm in the world frame.
struct Point {
  Eigen::Vector3d position;  ///< [m]
  Eigen::Vector3d velocity;  ///< [m/s]
};

/// A simulated arm, and what stands around it, as mjcf/mujoco/layout.h reads them from the model.
/// MuJoCo's coordinates rho of the arm are mapped to q = S rho + q0, and back by rho = T q + rho0;
/// generalised forces by force = T^T rho_force.
///
/// Everything but `step` speaks of the present state and input, and equation (3) holds there:
///     B qdd + bias + friction + tau_ext = tau.
class Plant {
 public:
  using Vector = Eigen::VectorXd;  ///< a number of each joint

  /// @throws std::invalid_argument if the model's actuators do not give such coordinates
  explicit Plant(Model model);

  int dof() const { return layout_.dof; }           ///< joints
  const mjModel& model() const { return *model_; }  ///< MuJoCo's
  const mjData& data() const { return *data_; }     ///< MuJoCo's, of the present state

  /// The screws of the joints, in their order; empty if the robot has none.
  const std::vector<Screw>& screws() const { return layout_.screws; }

  /// Puts the arm at q [rad], qd [rad/s], at rest from inputs, and the scene at its begin: a load
  /// is held beside the arm.
  void set_state(const Eigen::VectorXd& q, const Eigen::VectorXd& qd);
  /// Puts the arm at q [rad] for position() alone, which costs a fraction.
  void set_pose(const Eigen::VectorXd& q);

  /// Applies tau [N m] and tau_ext [N m, sign of (3)] from now on. tau beyond what the motors can
  /// do is clipped.
  void set_input(const Eigen::VectorXd& tau, const Eigen::VectorXd& tau_ext);

  Eigen::VectorXd q() const;         ///< [rad]
  Eigen::VectorXd qd() const;        ///< [rad/s]
  Eigen::VectorXd tau() const;       ///< [N m] as applied, clipped
  Eigen::MatrixXd inertia() const;   ///< B [kg m^2]
  Eigen::VectorXd bias() const;      ///< C qd + g [N m]
  Eigen::VectorXd damping() const;   ///< the part of F that is smooth [N m]
  Eigen::VectorXd friction() const;  ///< F [N m], damping and dry friction
  Eigen::VectorXd qdd() const;       ///< [rad/s^2] MuJoCo's acceleration under the present input

  /// All that acts on the arm from outside [N m, sign of (3)]: the input, the tether, contacts.
  Eigen::VectorXd tau_ext() const;
  /// Sum of the normal forces of the contacts on the arm [N].
  double contact_force() const;

  /// A point of the arm that a body carries.
  using Place = BodyPoint;
  /// A site, the origin of a body, or kEndEffector.
  /// @throws std::invalid_argument for an unknown name
  Place place(const std::string& name) const;
  /// Where such a point is [m].
  Eigen::Vector3d position(const Place& c) const;
  /// The same, and how it moves.
  Point point(const Place& c) const;
  /// place(name), there.
  Point site(const std::string& name) const { return point(place(name)); }
  /// The point that touches the outside: end_effector_of in layout.h.
  Point end_effector() const { return point(end_effector_); }
  /// Its Jacobian [m per joint coordinate] in the world frame.
  Eigen::MatrixXd end_effector_jacobian() const;

  /// The joints, counted from 0, that press against a limit of theirs.
  std::vector<int> joints_at_limits() const;
  /// What the limits do to the arm [N m, sign of (3)]; no part of tau_ext().
  Eigen::VectorXd limit_torque() const;
  /// Whether joints rigidly follow others. The force of a limit would break the ties, so such an
  /// arm must stay off its limits.
  bool is_tied() const { return is_tied_; }

  /// tau_ext = -J^T f [N m] of a force f [N, world frame] that acts on the arm at its end effector.
  Eigen::VectorXd tau_ext_of(const Eigen::Vector3d& f) const {
    return tau_ext_of(f, end_effector_);
  }
  /// The same at another point.
  Eigen::VectorXd tau_ext_of(const Eigen::Vector3d& f, const Place& c) const;

  /// Hangs the load on the end effector, below it and moving with it, its tether stretched by its
  /// weight. @throws std::invalid_argument without the scene "load"
  void hang_load();
  /// Lets it fall.
  void drop_load();
  /// Pushes it with f [N, world frame] from the next set_input on.
  void push_load(const Eigen::Vector3d& f) { push_ = f; }

  /// Integrates over one step h [s] by RK4, input held.
  /// @throws std::runtime_error when MuJoCo warns (bad state, too many contacts, ...)
  void step(double h);

 private:
  enum class LoadState { kNone, kHeld, kHung, kDropped };

  void put_arm(const Eigen::VectorXd& q, const Eigen::VectorXd& qd);
  void apply_to_load();
  Eigen::MatrixXd jacobian(const BodyPoint& c) const;  // by MuJoCo's degrees of freedom
  Eigen::VectorXd of_arm(const double* force) const;   // a generalised force, in joint coordinates
  template <class Counts>
  Eigen::VectorXd constraint_force(Counts&& counts) const;

  Model model_;
  State data_;
  Layout layout_;
  bool is_tied_;
  BodyPoint end_effector_;
  Eigen::VectorXd tau_ext_;  // of set_input
  LoadState load_ = LoadState::kNone;
  Eigen::Vector3d push_ = Eigen::Vector3d::Zero();
};

}  // namespace tauext

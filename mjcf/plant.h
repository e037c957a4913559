// SPDX-License-Identifier: Apache-2.0
/// @file
/// A robot in MuJoCo, in the joint coordinates q of its actuators, as the equation (3) sees it.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <memory>

#include "mjcf/model.h"

namespace tauext {

/// A simulated arm. MuJoCo's own coordinates rho are mapped to q = S rho, S constant: actuator i
/// must be a motor of unit gain whose length is q_i (on a joint or on a fixed tendon), one for each
/// degree of freedom. Generalised forces map by rho_force = S^T force.
///
/// Everything but `step` speaks of the present state and input, and equation (3) holds there:
///     B qdd + bias + friction + tau_ext = tau.
class Plant {
 public:
  /// @throws std::invalid_argument if the model's actuators do not give such coordinates
  explicit Plant(Model model);

  int dof() const { return model_->nu; }
  const mjModel& model() const { return *model_; }

  /// Puts the arm at q [rad], qd [rad/s], at rest from inputs.
  void set_state(const Eigen::VectorXd& q, const Eigen::VectorXd& qd);

  /// Applies tau [N m] and tau_ext [N m, sign of (3)] from now on.
  void set_input(const Eigen::VectorXd& tau, const Eigen::VectorXd& tau_ext);

  Eigen::VectorXd q() const;         ///< [rad]
  Eigen::VectorXd qd() const;        ///< [rad/s]
  Eigen::MatrixXd inertia() const;   ///< B [kg m^2]
  Eigen::VectorXd bias() const;      ///< C qd + g [N m]
  Eigen::VectorXd friction() const;  ///< F [N m], damping and dry friction
  Eigen::VectorXd qdd() const;       ///< [rad/s^2] MuJoCo's acceleration under the present input

  /// tau_ext = -J^T f [N m] of a force f [N, world frame] that acts on the arm at the site.
  /// @throws std::invalid_argument for an unknown site
  Eigen::VectorXd tau_ext_of(const Eigen::Vector3d& f, const std::string& site) const;

  /// Integrates over one step h [s] by RK4, input held.
  /// @throws std::runtime_error when MuJoCo warns (bad state, too many contacts, ...)
  void step(double h);

 private:
  Model model_;
  std::unique_ptr<mjData, decltype(&mj_deleteData)> data_;
  Eigen::MatrixXd S_;                           // q = S rho + q0
  Eigen::PartialPivLU<Eigen::MatrixXd> S_lu_;   // of S
  Eigen::PartialPivLU<Eigen::MatrixXd> St_lu_;  // of S^T
  Eigen::VectorXd q0_;
};

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// A recorded run: what the sensors said, and what was true.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "estimators/types.h"
#include "mjcf/trace/screw.h"

namespace tauext {

/// What the sensors read at one time.
struct Sample {
  double t = 0;         ///< [s]
  Eigen::VectorXd q;    ///< [rad]
  Eigen::VectorXd qd;   ///< [rad/s]
  Eigen::VectorXd tau;  ///< [N m]
};

/// Samples of an arm with n joints; column k of a matrix is sample k. Signs and sampling
/// convention: estimators/types.h.
struct Trace {
  std::vector<double> t;              ///< [s]
  Eigen::MatrixXd q;                  ///< [rad] measured
  Eigen::MatrixXd qd;                 ///< [rad/s] measured
  Eigen::MatrixXd tau;                ///< [N m] measured
  Eigen::MatrixXd tau_ext;            ///< [N m] true; no columns if unknown
  std::vector<std::uint8_t> contact;  ///< 1 while a collision acts (2: kIntended); empty: unknown
  bool torque_at_instants = false;    ///< tau was read at t and does not hold (samples/options.h)
  bool tau_is_current = false;        ///< tau is in A, and make_torques() has to be asked
  bool tau_without_gravity = false;  ///< g(q) is to be added: add_gravity() (mjcf/plant/any_tree.h)
  /// [N m] what the robot's own controller estimated, as a driver's log has it; no columns if
  /// unknown. Never written to a CSV.
  Eigen::MatrixXd tau_ext_of_driver;
  /// [N] on the arm at its end effector, axes of the world: a sensor's, or in a simulation the true
  /// one, if nothing else makes tau_ext; else no columns. Never written to a CSV.
  Eigen::Matrix3Xd force;

  // known to the simulation alone, never written to a file
  Eigen::MatrixXd qdd;                ///< [rad/s^2] MuJoCo's acceleration at t_k
  Eigen::MatrixXd friction;           ///< [N m] F of (3) at t_k
  std::vector<double> contact_force;  ///< [N] sum of the normal forces on the arm at t_k
  std::vector<Screw> screws;          ///< of the joints; empty if the robot has none
  Eigen::MatrixXd motor_q;       ///< [rad] of the motors behind elastic drives; else no columns
  Eigen::MatrixXd motor_qd;      ///< [rad/s] likewise
  Eigen::VectorXd usual_torque;  ///< [N m] ArmTree::usual_torque; empty if nobody asked for it
  int stopped_at = -1;           ///< sample at which a supervisor stopped the motor; -1: never

  int dof() const { return static_cast<int>(q.rows()); }   ///< joints
  int size() const { return static_cast<int>(t.size()); }  ///< samples
  bool has_truth() const { return tau_ext.cols() > 0; }    ///< whether tau_ext is known

  /// [rad] where the encoders are: on the motors of elastic drives, else on the links.
  const Eigen::MatrixXd& encoder_q() const { return motor_q.cols() > 0 ? motor_q : q; }
  /// [rad/s] likewise
  const Eigen::MatrixXd& encoder_qd() const { return motor_qd.cols() > 0 ? motor_qd : qd; }

  /// What an estimator sees of sample k. N must be dof().
  template <int N>
  Measurement<N> measurement(int k) const {
    return {t[k], q.col(k), qd.col(k), tau.col(k)};
  }
};

/// The samples of these indices alone, in increasing order.
Trace select_samples(const Trace& trace, const std::vector<int>& samples);

/// @throws std::invalid_argument unless there are as many gains [N m/A] as joints, and none is 0,
/// which nobody knows, saying where it may stand
void require_gains(const Eigen::VectorXd& gain, int joints);

/// Makes torques of a trace whose tau is in A, by these gains [N m/A]; else does nothing.
/// @throws std::invalid_argument as require_gains does
void make_torques(Trace& trace, const Eigen::VectorXd& gain);

/// Writes t,q1..,qd1..,tau1..[,tau_ext1..][,contact] with a header line, %.17g, SI units; to
/// standard output if the path is "-". A tau read at instants is called tau_instant1... The file
/// appears whole or not at all. mjcf/trace/read/ reads it.
/// @throws std::runtime_error naming the path
void write_csv(const Trace& trace, const std::string& path);

}  // namespace tauext

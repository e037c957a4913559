// SPDX-License-Identifier: Apache-2.0
/// @file
/// The terms of (3) of any arm in MJCF, for estimators: what a closed form is for our own robots.
#pragma once

#include <memory>

#include "estimators/types.h"
#include "mjcf/plant/model.h"

namespace tauext {

/// MuJoCo asked for inertia and torques at states that need not be its own. Every argument and
/// result has dof() numbers, matrices dof() times that; nothing is allocated after construction.
/// Not for two threads at once.
///
/// Coordinates: MuJoCo's own, one for each hinge or slide in the file's order, whatever gears its
/// actuators have; but where motors on fixed tendons say what the joint coordinates are
/// (mjcf/mujoco/layout.h, wallmobot3), these. Friction is the file's damping and frictionloss of
/// joints, the latter smooth as ArmTree says.
class ArmDynamics {
 public:
  /// @throws std::invalid_argument for what it would have to ignore: free or ball joints, springs,
  /// equality constraints, forces of tendons, a fluid; and for motors on tendons with gears
  explicit ArmDynamics(Model model);
  ArmDynamics(const ArmDynamics& other);  ///< with a state of its own
  ArmDynamics& operator=(const ArmDynamics&) = delete;
  ~ArmDynamics();

  int dof() const noexcept;                                                  ///< joints
  void inertia(const double* q, double* B) const noexcept;                   ///< [kg m^2]
  void bias(const double* q, const double* qd, double* out) const noexcept;  ///< C qd + g [N m]
  void gravity(const double* q, double* out) const noexcept;                 ///< g [N m]
  /// C^T qd - g [N m], C^T qd being dB/dt qd - C qd; dB/dt along qd by central differences of
  /// fourth order.
  void momentum_bias(const double* q, const double* qd, double* out) const noexcept;
  void friction(const double* qd, double* out) const noexcept;  ///< F [N m]

 private:
  struct Workspace;
  std::unique_ptr<Workspace> work_;
};

/// An ArmDynamics of N joints as a RobotModel.
template <int N>
class MjcfArm {
 public:
  static constexpr int kDof = N;

  /// @throws std::invalid_argument as ArmDynamics does
  explicit MjcfArm(const Model& model) : arm_(model) {}

  /// B [kg m^2].
  Mat<N> inertia(const Vec<N>& q) const noexcept {
    Mat<N> B;
    arm_.inertia(q.data(), B.data());
    return B;
  }
  /// C qd + g [N m].
  Vec<N> bias(const Vec<N>& q, const Vec<N>& qd) const noexcept {
    Vec<N> out;
    arm_.bias(q.data(), qd.data(), out.data());
    return out;
  }
  /// g [N m].
  Vec<N> gravity(const Vec<N>& q) const noexcept {
    Vec<N> out;
    arm_.gravity(q.data(), out.data());
    return out;
  }
  /// C^T qd - g [N m].
  Vec<N> momentum_bias(const Vec<N>& q, const Vec<N>& qd) const noexcept {
    Vec<N> out;
    arm_.momentum_bias(q.data(), qd.data(), out.data());
    return out;
  }
  /// F [N m].
  Vec<N> friction(const Vec<N>& qd) const noexcept {
    Vec<N> out;
    arm_.friction(qd.data(), out.data());
    return out;
  }

 private:
  ArmDynamics arm_;
};

}  // namespace tauext

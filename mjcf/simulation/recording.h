// SPDX-License-Identifier: Apache-2.0
/// @file
/// How a scenario is run and sampled, and who may stop it.
#pragma once

#include <functional>
#include <optional>

#include "mjcf/trace/trace.h"

namespace tauext {

/// Springs between motors and links, and friction of the links, of which no model knows. Encoders
/// sit on the motors, torque sensors on the links; this friction is beside that of the robot's
/// file. u is the torque that a joint is used to (ArmTree::usual_torque), so that one set of
/// numbers fits small and large joints; for slides read m where it says rad.
struct Drives {
  double stiffness = 0;   ///< [u/rad] of the spring between motor and link; 0: rigid
  double rotor = 0.01;    ///< [u s^2/rad] inertia of the motor
  double damping = 0.05;  ///< [1] share of the damping that is critical for the motor on its spring
  double coulomb = 0;     ///< [u] dry friction
  double stribeck = 0;    ///< [1] dry friction near rest is 1 + stribeck times coulomb
  double viscous = 0;     ///< [u s/rad] viscous friction
  double drift = 0;       ///< [1] friction goes from 1 + drift times itself to 1 - drift in a run

  bool operator==(const Drives&) const = default;
  auto operator<=>(const Drives&) const = default;  // NOLINT(modernize-use-nullptr): not ours

  bool elastic() const { return stiffness != 0; }            ///< whether there are springs
  bool rub() const { return coulomb != 0 || viscous != 0; }  ///< whether there is friction
  bool any() const { return elastic() || rub(); }            ///< or anything
};

/// [rad/s] The dry friction of Drives changes its sign as tanh(qd / kFrictionTurns).
inline constexpr double kFrictionTurns = 0.01;
/// [rad/s] Stribeck speed: 1/e of the additional friction near rest is left at it.
inline constexpr double kStribeckSpeed = 0.05;

/// How a scenario is run and sampled.
struct Recording {
  std::optional<double> Kp;  ///< [1/s^2] of the tracking controller; else the scenario's
  std::optional<double> Kd;  ///< [1/s]
  double Ts = 1e-3;          ///< [s] sampling time; tau and tau_ext are held over it
  int substeps = 1;          ///< RK4 steps per sample
  Drives drives;             ///< between motors and links
};

/// Asked at every sample, with what the sensors read: whether to stop the motor. From the next
/// sample on the controller holds the arm where it was at this one.
using Supervisor = std::function<bool(const Sample&)>;

}  // namespace tauext

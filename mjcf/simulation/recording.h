// SPDX-License-Identifier: Apache-2.0
/// @file
/// How a scenario is run and sampled, and who may stop it.
#pragma once

#include <functional>
#include <optional>

#include "mjcf/trace/trace.h"

namespace tauext {

/// What stands between motors and links, and rubs there, of which no model knows: springs, with the
/// encoders on the motors' side and the torque sensors on the links', and friction of the links
/// beside that of the robot's file. u is what a joint is used to (ArmTree::usual_torque), so that
/// one set of numbers is a small joint's and a large one's; slides have m for rad.
struct Drives {
  double stiffness = 0;   ///< [u/rad] of the spring between motor and link; 0: rigid
  double rotor = 0.01;    ///< [u s^2/rad] inertia of the motor behind it
  double damping = 0.05;  ///< [1] of the critical one, of this inertia on the spring
  double coulomb = 0;     ///< [u] dry friction
  double stribeck = 0;    ///< [1] by which it is more near rest
  double viscous = 0;     ///< [u s/rad]
  double drift = 0;  ///< [1] all friction is 1 + drift times itself at first, 1 - drift at last

  bool operator==(const Drives&) const = default;
  auto operator<=>(const Drives&) const = default;  // NOLINT(modernize-use-nullptr): not ours

  bool elastic() const { return stiffness != 0; }            ///< whether there are springs
  bool rub() const { return coulomb != 0 || viscous != 0; }  ///< whether there is friction
  bool any() const { return elastic() || rub(); }            ///< or anything
};

/// [rad/s] within which dry friction of Drives turns, as tanh(qd / this).
inline constexpr double kFrictionTurns = 0.01;
/// [rad/s] Stribeck's: at this speed 1/e of what is more near rest is left.
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

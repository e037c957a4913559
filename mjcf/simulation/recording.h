// SPDX-License-Identifier: Apache-2.0
/// @file
/// How a scenario is run and sampled, and who may stop it.
#pragma once

#include <functional>
#include <optional>

#include "mjcf/trace/trace.h"

namespace tauext {

/// How a scenario is run and sampled.
struct Recording {
  std::optional<double> Kp;  ///< [1/s^2] of the tracking controller; else the scenario's
  std::optional<double> Kd;  ///< [1/s]
  double Ts = 1e-3;          ///< [s] sampling time; tau and tau_ext are held over it
  int substeps = 1;          ///< RK4 steps per sample
};

/// Asked at every sample, with what the sensors read: whether to stop the motor. From the next
/// sample on the controller holds the arm where it was at this one.
using Supervisor = std::function<bool(const Sample&)>;

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Ground truth: a scenario, run on a robot, sampled.
#pragma once

#include "mjcf/plant.h"
#include "mjcf/scenario.h"
#include "mjcf/sensors.h"
#include "mjcf/trace.h"

namespace tauext {

/// The tracking controller: computed torque, tau = B (qdd_ref + Kp e + Kd edot) + C qd + F + g with
/// the exact model. The paper names none, but its runs presuppose one: under gravity compensation
/// alone the arm falls over within 2 s of the step.
struct Tracking {
  double Kp = 400;  ///< [1/s^2]
  double Kd = 40;   ///< [1/s]
};

/// How a scenario is run and sampled.
struct Recording {
  Tracking tracking;
  double Ts = 1e-3;  ///< [s] sampling time; tau and tau_ext are held over it
  int substeps = 1;  ///< RK4 steps per sample
};

/// Runs the scenario from its start and samples t_k = k Ts before the end.
///
/// tau_ext acts as a generalised force and the force on the end effector as J(q_k)^T f, both held
/// over [t_k, t_k+1), so the recorded tau_ext is exact by construction.
/// @throws std::invalid_argument for a Recording that is out of range, std::runtime_error if MuJoCo warns
Trace record(const Model& model, const Scenario& scenario, const Sensors& sensors = {},
             const Recording& recording = {});

}  // namespace tauext

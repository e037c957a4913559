// SPDX-License-Identifier: Apache-2.0
/// @file
/// Ground truth: a scenario, run on a robot, sampled.
#pragma once

#include "mjcf/plant/model.h"
#include "mjcf/scenarios/scenario.h"    // IWYU pragma: export
#include "mjcf/simulation/recording.h"  // IWYU pragma: export
#include "mjcf/trace/sensors.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// Runs the scenario from its start and samples t_k = k Ts before the end; the supervisor, if there
/// is one, sees it through the sensors. The trace returned is the truth: ideal sensors.
///
/// tau_ext acts as a generalised force and the force on the end effector as J(q_k)^T f, both held
/// over [t_k, t_k+1), so their recorded tau_ext is exact by construction. What a tether or a
/// contact does to the arm changes within a sample; recorded is its value at t_k.
/// @throws std::invalid_argument for a Recording that is out of range, or a model without the
/// scenario's scene (load_for gives one with it); std::runtime_error if MuJoCo warns
Trace simulate(const Model& model, const Scenario& scenario, const Recording& recording = {},
               const Sensors& sensors = {}, const Supervisor& supervisor = nullptr);

/// measure(simulate(...)) without a supervisor.
Trace record(const Model& model, const Scenario& scenario, const Sensors& sensors = {},
             const Recording& recording = {});

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Hours of ground truth, by the estimators' own dynamics.
#pragma once

#include <optional>
#include <utility>

#include "mjcf/plant/simulated.h"
#include "mjcf/record.h"
#include "mjcf/simulation/run.h"
#include "mjcf/simulation/tree_plant.h"

namespace tauext {

/// simulate() without a supervisor, of an arm of N joints that nothing but the scenario acts on: by
/// the estimators' own dynamics, which takes a tenth of the time. Its truth is MuJoCo's to
/// rounding, 1e-9 of the largest value of each quantity. Where the arm needs MuJoCo (plain_arm), or
/// comes near a limit of a joint, it is simulate().
/// @throws as simulate does
template <int N>
Trace simulate_plain(const Model& model, const Scenario& scenario,
                     const Recording& recording = {}) {
  std::optional<PlainArm> arm = plain_arm(model);
  if (arm && arm->tree.dof() == N && !scenario.load && scenario.scene.empty()) {
    TreePlant<N> plant(*std::move(arm));
    std::optional<Trace> trace =
        detail::Run<TreePlant<N>>(std::move(plant), scenario, recording, {})(nullptr);
    if (trace) return *std::move(trace);
  }
  return simulate(model, scenario, recording);
}

/// The largest difference between two runs, of q, qd, qdd, tau, tau_ext and friction, each as a
/// share of its largest value, or of 1e-3 of its unit if that is more; infinite if one is longer.
double difference(const Trace& a, const Trace& b);

}  // namespace tauext

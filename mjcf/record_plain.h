// SPDX-License-Identifier: Apache-2.0
/// @file
/// Hours of ground truth, by the estimators' own dynamics.
#pragma once

#include <memory>

#include "mjcf/record.h"
#include "mjcf/simulation/tree_motion.h"

namespace tauext {

/// Makes the dynamics of an arm: tree_motion<N> for N joints.
using MakeTreeMotion = std::unique_ptr<const TreeMotion> (*)(const ArmTree& tree);

/// simulate() without a supervisor, of an arm of so many joints that nothing but the scenario acts
/// on: by the estimators' own dynamics, which takes a tenth of the time. Its truth is MuJoCo's to
/// rounding, 1e-9 of the largest value of each quantity. Where the arm needs MuJoCo (plain_arm), or
/// comes near a limit of a joint, it is simulate().
/// @throws as simulate does
Trace simulate_plain(const Model& model, const Scenario& scenario, int joints,
                     MakeTreeMotion motion, const Recording& recording = {});

/// The same of N joints.
template <int N>
Trace simulate_plain(const Model& model, const Scenario& scenario,
                     const Recording& recording = {}) {
  return simulate_plain(model, scenario, N, tree_motion<N>, recording);
}

/// The largest difference between two runs, of q, qd, qdd, tau, tau_ext and friction, each as a
/// share of its largest value, or of 1e-3 of its unit if that is more; infinite if one is longer.
double difference(const Trace& a, const Trace& b);

}  // namespace tauext

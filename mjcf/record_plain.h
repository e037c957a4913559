// SPDX-License-Identifier: Apache-2.0
/// @file
/// Hours of ground truth, by the estimators' own dynamics.
#pragma once

#include <span>
#include <vector>

#include "mjcf/record.h"

namespace tauext {

/// simulate() of scenarios without a supervisor, of an arm that nothing but the scenario acts on:
/// by the estimators' own dynamics, which takes a tenth of the time, and a third of that for each
/// of several runs of one length. Its truth is MuJoCo's to rounding, 1e-9 of the largest value of
/// each quantity. Where the arm needs MuJoCo (plain_arm), or comes near a limit of a joint, it is
/// simulate().
/// @throws as simulate does
std::vector<Trace> simulate_plain(const Model& model, std::span<const Scenario> scenarios,
                                  const Recording& recording = {});

/// The same of one scenario.
Trace simulate_plain(const Model& model, const Scenario& scenario, const Recording& recording = {});

/// The largest difference between two runs, of q, qd, qdd, tau, tau_ext and friction, each as a
/// share of its largest value, or of 1e-3 of its unit if that is more; infinite if one is longer.
double difference(const Trace& a, const Trace& b);

}  // namespace tauext

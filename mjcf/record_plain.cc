// SPDX-License-Identifier: Apache-2.0
#include "mjcf/record_plain.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "mjcf/plant/simulated.h"
#include "mjcf/simulation/run.h"
#include "mjcf/simulation/tree_plant.h"

namespace tauext {

Trace simulate_plain(const Model& model, const Scenario& scenario, int joints,
                     MakeTreeMotion motion, const Recording& recording) {
  std::optional<PlainArm> arm = plain_arm(model);
  if (arm && arm->tree.dof() == joints && !scenario.load && scenario.scene.empty()) {
    auto dynamics = motion(arm->tree);
    TreePlant plant(*std::move(arm), std::move(dynamics));
    std::optional<Trace> trace =
        detail::Run<TreePlant>(std::move(plant), scenario, recording, {})(nullptr);
    if (trace) return *std::move(trace);
  }
  return simulate(model, scenario, recording);
}

double difference(const Trace& a, const Trace& b) {
  if (a.t != b.t) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (const auto of :
       {&Trace::q, &Trace::qd, &Trace::qdd, &Trace::tau, &Trace::tau_ext, &Trace::friction}) {
    const double size = std::max((a.*of).cwiseAbs().maxCoeff(), 1e-3);
    const double off = (a.*of - b.*of).cwiseAbs().maxCoeff<Eigen::PropagateNaN>() / size;
    if (!(off <= largest)) largest = off;
  }
  return largest;
}

}  // namespace tauext

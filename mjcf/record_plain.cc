// SPDX-License-Identifier: Apache-2.0
#include "mjcf/record_plain.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "mjcf/plant/simulated.h"
#include "mjcf/simulation/run.h"
#include "mjcf/simulation/tree_plant.h"

namespace tauext {

namespace {

bool is_plain(const Scenario& s) {
  return !s.load && s.scene.empty();
}

// MuJoCo makes dry friction that is too stiff for its steps softer
bool holds_for(const PlainArm& arm, const Recording& r) {
  return arm.dry.most.isZero(0) || arm.timestep == r.Ts / r.substeps;
}

// those with as many steps in a sample step at once
void step_together(std::vector<detail::Run<TreePlant>*> runs, double Ts) {
  std::vector<TreePlant*> plants;
  while (!runs.empty()) {
    const int parts = runs.front()->parts();
    const auto others = std::stable_partition(
        runs.begin(), runs.end(), [parts](const auto* run) { return run->parts() == parts; });
    plants.clear();
    for (auto run = runs.begin(); run != others; ++run) plants.push_back(&(*run)->plant());
    for (int i = 0; i < parts; ++i) {
      for (auto run = runs.begin(); run != others; ++run) (*run)->push(Ts / parts);
      TreePlant::step(plants, Ts / parts);
      for (auto run = runs.begin(); run != others; ++run) (*run)->move(Ts / parts);
    }
    runs.erase(runs.begin(), others);
  }
}

// nothing of a run that got lost
std::vector<std::optional<Trace>> run_together(std::vector<detail::Run<TreePlant>> runs,
                                               const Recording& r) {
  const Supervisor nobody;
  std::vector<bool> lost(runs.size());
  std::vector<detail::Run<TreePlant>*> going;
  for (int k = 0; k < runs.front().size(); ++k) {
    going.clear();
    for (std::size_t i = 0; i < runs.size(); ++i) {
      lost[i] = lost[i] || !runs[i].sample(k, nobody);
      if (!lost[i]) going.push_back(&runs[i]);
    }
    step_together(going, r.Ts);
  }
  std::vector<std::optional<Trace>> traces(runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!lost[i] && !runs[i].plant().is_lost()) traces[i] = std::move(runs[i]).trace();
  }
  return traces;
}

}  // namespace

std::vector<Trace> simulate_plain(const Model& model, std::span<const Scenario> scenarios,
                                  const Recording& recording) {
  const std::optional<PlainArm> arm = plain_arm(model);
  std::shared_ptr<const TreeMotion> dynamics;
  if (arm && holds_for(*arm, recording)) dynamics = tree_motion(*arm);
  std::vector<Trace> traces;
  for (std::size_t from = 0, n = 0; from < scenarios.size(); from += n) {
    std::vector<detail::Run<TreePlant>> runs;
    for (n = 0; from + n < scenarios.size(); ++n) {
      const Scenario& s = scenarios[from + n];
      if (!dynamics || !is_plain(s) || s.duration != scenarios[from].duration) break;
      runs.emplace_back(TreePlant(*arm, dynamics), s, recording, Sensors(), arm->tree.usual_torque);
    }
    std::vector<std::optional<Trace>> done;
    if (!runs.empty()) done = run_together(std::move(runs), recording);
    n = std::max<std::size_t>(n, 1);
    done.resize(n);
    for (std::size_t i = 0; i < n; ++i)
      traces.push_back(done[i] ? *std::move(done[i])
                               : simulate(model, scenarios[from + i], recording));
  }
  return traces;
}

Trace simulate_plain(const Model& model, const Scenario& scenario, const Recording& recording) {
  return std::move(simulate_plain(model, {&scenario, 1}, recording).front());
}

double difference(const Trace& a, const Trace& b) {
  if (a.t != b.t || a.motor_q.cols() != b.motor_q.cols())
    return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (const auto of : {&Trace::q, &Trace::qd, &Trace::qdd, &Trace::tau, &Trace::tau_ext,
                        &Trace::friction, &Trace::motor_q, &Trace::motor_qd}) {
    if ((a.*of).size() == 0) continue;  // drives are rigid
    const double size = std::max((a.*of).cwiseAbs().maxCoeff(), 1e-3);
    const double off = (a.*of - b.*of).cwiseAbs().maxCoeff<Eigen::PropagateNaN>() / size;
    if (!(off <= largest)) largest = off;
  }
  return largest;
}

}  // namespace tauext

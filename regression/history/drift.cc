// SPDX-License-Identifier: Apache-2.0
#include "regression/history/drift.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "bench/score/metric_list.h"
#include "regression/accuracy/accuracy.h"

namespace tauext::gate {
namespace {

// a kernel's levels, as KernelDrift has them
std::vector<double> levels_of(const std::vector<Record>& history, const std::string& kernel) {
  std::vector<double> level;
  std::map<std::string, double> of_commit;  // what is known of the commits that may be references
  std::string reference;
  double offset = 0;
  for (std::size_t i = 0; i < history.size(); ++i) {
    const auto it = history[i].kernels.find(kernel);
    if (it == history[i].kernels.end()) continue;
    if (history[i].reference != reference) {
      const auto known = of_commit.find(history[i].reference);
      const bool chained = known != of_commit.end();
      offset = chained ? known->second : 0;
      if (!chained) level.clear(), of_commit.clear();  // nothing leads from the old one to this
      reference = history[i].reference;
    }
    level.push_back(offset + std::log(it->second.ratio));
    of_commit[history[i].commit] = level.back();
  }
  return level;
}

// by how much a finding may be larger than at the reference: what was accepted since, each once,
// though trees keep what is stale
double accepted(const std::vector<Record>& history, const std::string& layer,
                const std::string& subject) {
  std::set<std::tuple<std::string, std::string>> seen;
  double sum = 0;
  for (const Record& r : history) {
    for (const Acceptance& a : r.accepted) {
      if (a.layer != layer || a.subject != subject || !seen.emplace(a.base, a.reason).second)
        continue;
      if (r.reference == history.back().reference) sum += a.at_most;
    }
    if (r.commit == history.back().reference) sum = 0;
  }
  return sum;
}

KernelDrift kernel_drift(const std::vector<Record>& history, const std::string& kernel,
                         const DriftLimits& limits) {
  const Record& last = history.back();
  KernelDrift d{
      .kernel = kernel, .level = levels_of(history, kernel), .last = last.kernels.at(kernel)};
  d.accepted = accepted(history, kTimeLayer, kernel);
  d.drifted = d.last.surely > limits.time + d.accepted;
  d.undecided = !d.drifted && d.last.ratio > 1 + limits.time + d.accepted;
  return d;
}

// how much worse, as a share of before; 0 where it is not worse or nobody can say
double worse_by(const std::string& metric, double before, double after) {
  const MetricRow& row = metric_row(metric);
  if (row.better == Better::kNeither) return 0;
  if (std::isnan(after) != std::isnan(before)) {
    return std::isnan(after) == row.is(MetricRow::kNeverIsBest) ? 0 : HUGE_VAL;
  }
  const double worse = row.better == Better::kMore ? before - after : after - before;
  const bool visible = std::abs(worse) > kOfContacts * row.tolerance;
  return visible ? worse / std::abs(before) : 0;
}

void compare_metrics(const std::vector<Record>& history, const DriftLimits& limits, Drift& d) {
  const std::string& reference = history.back().reference;
  auto at = std::find_if(history.begin(), history.end(),
                         [&](const Record& r) { return r.commit == reference; });
  if (at == history.end()) {  // then the first that ran beside it is the next best
    at = std::find_if(history.begin(), history.end(),
                      [&](const Record& r) { return r.reference == reference; });
  }
  const auto before = metrics_after(history, static_cast<std::size_t>(at - history.begin()) + 1);
  std::vector<std::pair<double, MetricDrift>> worse;
  for (const auto& [name, after] : metrics_after(history, history.size())) {
    const auto it = before.find(name);
    if (it == before.end()) continue;
    const double was = it->second;
    if (was == after || (std::isnan(was) && std::isnan(after))) continue;
    ++d.metrics_moved;
    const double by = worse_by(name.substr(name.rfind(' ') + 1), was, after);
    if (by > limits.metric + accepted(history, kAccuracyLayer, name)) {
      worse.push_back({by, {name, was, after}});
    }
  }
  std::stable_sort(worse.begin(), worse.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (auto& [by, metric] : worse) d.metrics.push_back(std::move(metric));
}

}  // namespace

bool Drift::slower() const {
  return std::any_of(kernels.begin(), kernels.end(),
                     [](const KernelDrift& k) { return k.drifted; });
}

Drift drift_of(const std::vector<Record>& history, const DriftLimits& limits) {
  Drift d;
  for (const auto& [kernel, record] : history.back().kernels) {
    d.kernels.push_back(kernel_drift(history, kernel, limits));
  }
  compare_metrics(history, limits, d);
  return d;
}

}  // namespace tauext::gate

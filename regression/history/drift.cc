// SPDX-License-Identifier: Apache-2.0
#include "regression/history/drift.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "bench/score/metric_list.h"
#include "mjcf/trace/table_writer.h"
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

constexpr std::size_t kBars = 40, kMetricsShown = 20, kOfACommit = 12;

std::string percent(double ratio) {
  return fmt::format("{:+.2f}", 100 * (ratio - 1));
}

std::vector<std::string> cells_of(const KernelDrift& k) {
  return {k.kernel,
          k.last.ns ? fmt::format("{:.1f}", *k.last.ns) : "-",
          percent(k.last.ratio),
          fmt::format("{} to {}", percent(k.last.low), percent(k.last.high)),
          percent(k.last.instructions_ratio),
          sparkline(k.level, kBars),
          k.drifted        ? "SLOWER"
          : k.accepted > 0 ? "accepted"
          : k.undecided    ? "undecided"
                           : "ok"};
}

bool ever_changed(const KernelDrift& k) {
  return std::any_of(k.level.begin(), k.level.end(), [&](double x) { return x != k.level[0]; }) ||
         k.last.instructions_ratio != 1 || k.last.ratio != 1;
}

// in words, what is worse
std::string findings(const Drift& d) {
  std::string text;
  for (const KernelDrift& k : d.kernels) {
    const std::string meant =
        k.accepted > 0 ? fmt::format(", of which {:.1f} % are accepted", 100 * k.accepted) : "";
    if (k.drifted) {
      text += fmt::format("{}: {} % beside the reference, surely more than {:+.1f} %{}\n", k.kernel,
                          percent(k.last.ratio), 100 * k.last.surely, meant);
    }
  }
  for (std::size_t i = 0; i < d.metrics.size(); ++i) {
    if (i == kMetricsShown) {
      return text + fmt::format("and {} metrics more\n", d.metrics.size() - i);
    }
    const MetricDrift& m = d.metrics[i];
    text += fmt::format("{}: {} at the reference, now {}\n", m.name, said(m.before), said(m.after));
  }
  return text;
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

std::string sparkline(const std::vector<double>& values, std::size_t most) {
  constexpr const char* kBarsOf8[] = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  if (values.empty()) return "";
  const auto begin = values.end() - static_cast<std::ptrdiff_t>(std::min(most, values.size()));
  const auto [low, high] = std::minmax_element(begin, values.end());
  const double range = std::max(*high - *low, 0.01);
  std::string bars;
  for (auto it = begin; it != values.end(); ++it) {
    bars += kBarsOf8[std::min(static_cast<int>(8 * (*it - *low) / range), 7)];
  }
  return bars;
}

std::string format_drift(const std::vector<Record>& history, const Drift& d, bool all,
                         bool markdown) {
  const Record& last = history.back();
  std::string text =
      fmt::format("{}commits on record: {}; the last is {} of {} ({}), beside {}\n\n",
                  markdown ? "## tauext-gate history\n\n" : "", history.size(),
                  last.commit.substr(0, kOfACommit), last.date.substr(0, 10), last.title,
                  last.reference.substr(0, kOfACommit));
  TableWriter table({{"kernel", "", true},
                     {"step", "ns"},
                     {"beside reference", "%"},
                     {"interval", "%"},
                     {"instructions", "%"},
                     {"time", "commit by commit", true},
                     {"", "", true}});
  int same = 0;
  for (const KernelDrift& k : d.kernels) {
    if (all || ever_changed(k)) {
      table.add(cells_of(k));
    } else {
      ++same;
    }
  }
  if (!table.empty()) {
    text += table.format(markdown ? TableFormat::kMarkdown : TableFormat::kText) + "\n";
  }
  if (same > 0) text += fmt::format("kernels that are as fast as the reference's: {}\n", same);
  if (d.metrics_moved > 0)
    text += fmt::format("metrics that differ from the reference's: {}\n", d.metrics_moved);
  const std::string worse = findings(d);
  if (worse.empty()) return text + "nothing is worse than the reference\n";
  return text + "\n" + (markdown ? "```\n" + worse + "```\n" : worse);
}

std::string format_for_charts(const Record& last) {
  auto all = nlohmann::ordered_json::array();
  for (const auto& [kernel, k] : last.kernels)
    all.push_back({{"name", kernel},
                   {"unit", "% of the time of " + last.reference.substr(0, kOfACommit)},
                   {"value", 100 * k.ratio},
                   {"range", fmt::format("{:.2f} to {:.2f}", 100 * k.low, 100 * k.high)}});
  return all.dump(2) + "\n";
}

}  // namespace tauext::gate

// SPDX-License-Identifier: Apache-2.0
#include "regression/history/show.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "mjcf/trace/table_writer.h"
#include "regression/accuracy/accuracy.h"

namespace tauext::gate {
namespace {

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

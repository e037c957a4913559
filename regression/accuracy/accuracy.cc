// SPDX-License-Identifier: Apache-2.0
#include "regression/accuracy/accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <regex>
#include <sstream>
#include <tuple>
#include <utility>

#include "bench/score/metric_list.h"

namespace tauext::gate {
namespace {

bool differs(double a, double b, double tolerance) {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) != std::isnan(b);
  return std::abs(a - b) > tolerance * std::max({1., std::abs(a), std::abs(b)});
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

double sign_of(const std::string& metric) {
  return larger_is_better(metric) ? -1 : 1;
}

// what T2 knows of a line: seeds with a value on both sides, and how many lost or gained one
struct Paired {
  std::vector<double> before, worse;  // worse: by how much, in the metric's own direction
  int lost = 0, gained = 0;
};

Paired paired(const std::string& metric, const GoldenLine& before, const GoldenLine& after) {
  const double sign = sign_of(metric);
  Paired p;
  for (std::size_t i = 0; i < before.values.size(); ++i) {
    const double b = before.values[i], a = after.values[i];
    p.lost += std::isnan(a) && !std::isnan(b);
    p.gained += std::isnan(b) && !std::isnan(a);
    if (std::isnan(a) || std::isnan(b)) continue;
    p.before.push_back(b);
    p.worse.push_back(sign * (a - b));
  }
  return p;
}

// in units of its standard error; infinite if all values are the same
double standard_errors(const std::vector<double>& d) {
  if (d.empty()) return 0;
  const double m = mean(d);
  double square = 0;
  for (const double x : d) square += (x - m) * (x - m);
  const auto n = static_cast<double>(d.size());
  if (n < 2 || square == 0) return m == 0 ? 0 : std::numeric_limits<double>::infinity();
  return std::abs(m) / std::sqrt(square / (n - 1) / n);
}

// "never" is worse than every value, unless it is the best; one seed's step over that edge is no
// verdict
Change judge(const std::string& metric, const Paired& p, std::size_t seeds) {
  if (metric_row(metric).better == Better::kNeither) return Change::kChanged;
  const int lost = p.lost - p.gained;
  if (!metric_row(metric).is(MetricRow::kNeverIsBest) &&
      2 * static_cast<std::size_t>(std::abs(lost)) > seeds) {
    return lost > 0 ? Change::kWorse : Change::kBetter;
  }
  if (p.worse.empty()) return Change::kChanged;
  const double m = mean(p.worse);
  if (metric_row(metric).is(MetricRow::kOneSeedIsWorse) && m > 0) return Change::kWorse;
  if (std::abs(m) <= kWorseBy * std::abs(mean(p.before))) return Change::kChanged;
  if (standard_errors(p.worse) < kStandardErrors) return Change::kChanged;
  return m > 0 ? Change::kWorse : Change::kBetter;
}

// the seed that got worse most, or lost its value
std::size_t worst_seed(const std::string& metric, const GoldenLine& before,
                       const GoldenLine& after) {
  const double sign = sign_of(metric);
  std::size_t worst = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < before.values.size(); ++i) {
    double by = sign * (after.values[i] - before.values[i]);
    if (std::isnan(by)) {
      by = std::isnan(before.values[i]) ? -std::numeric_limits<double>::infinity()
                                        : std::numeric_limits<double>::infinity();
    }
    if (by > most) most = by, worst = i;
  }
  return worst;
}

std::string seconds_of(const Golden& g, const std::string& entry, std::size_t seed) {
  const auto it = g.lines.find({entry, key_of(Metric::kMaxAt)});
  if (it == g.lines.end() || seed >= it->second.values.size()) return "";
  return fmt::format("{:.6g}", it->second.values[seed]);
}

bool same_values_in_another_order(const GoldenLine& a, const GoldenLine& b) {
  std::vector<double> x = a.values, y = b.values;
  const auto nan = [](double v) { return std::isnan(v); };
  if (std::any_of(x.begin(), x.end(), nan) || std::any_of(y.begin(), y.end(), nan)) return false;
  std::sort(x.begin(), x.end());
  std::sort(y.begin(), y.end());
  return x == y;
}

// why two files cannot be compared; "" if they can
std::string incomparable(const Golden& baseline, const Golden& head) {
  for (const std::string name : {"mujoco", "sensors", "degraded"}) {
    const auto value = [&](const Golden& g) {
      const auto it = g.header.find(name);
      return it == g.header.end() ? std::string("unknown") : it->second;
    };
    if (value(baseline) == value(head)) continue;
    // files of before there were any
    if (name == "degraded" && !baseline.header.contains(name)) continue;
    return fmt::format("the baseline was made with {} '{}', this is '{}'", name, value(baseline),
                       value(head));
  }
  return baseline.seeds == head.seeds ? "" : "the baseline has other seeds";
}

// what may change in a line; a contact, of which head's program speaks, lets it grow
double tolerance_of(const std::pair<std::string, std::string>& key, const Golden& head) {
  const auto contacts = head.header.find("contacts");
  const double tolerance = metric_row(key.second).tolerance;
  if (contacts == head.header.end()) return tolerance;
  std::istringstream words(contacts->second);
  for (std::string scenario; words >> scenario;) {
    if (key.first.starts_with(scenario + "/")) return kOfContacts * tolerance;
  }
  return tolerance;
}

bool unchanged(const GoldenLine& before, const GoldenLine& after, double tolerance) {
  for (std::size_t i = 0; i < before.values.size(); ++i) {
    if (differs(before.values[i], after.values[i], tolerance)) return false;
  }
  return true;
}

MetricChange change_of(const std::pair<std::string, std::string>& key, const GoldenLine& before,
                       const GoldenLine& after, const Golden& head) {
  MetricChange c{.entry = key.first, .metric = key.second};
  const Paired p = paired(c.metric, before, after);
  c.before = mean(before.values);
  c.after = mean(after.values);
  c.standard_errors = standard_errors(p.worse);
  c.change = judge(c.metric, p, before.values.size());
  const std::size_t worst = worst_seed(c.metric, before, after);
  c.worst_seed = head.seeds[worst];
  c.largest_error_at = seconds_of(head, c.entry, worst);
  if (p.lost + p.gained > 0) {
    c.note = fmt::format("{} seeds lost their value, {} gained one", p.lost, p.gained);
  } else if (same_values_in_another_order(before, after)) {
    c.note = "the same values, the seeds swapped";
  }
  return c;
}

// by how much of the value; what is worse, or not there any more, first
bool worse_first(const MetricChange& a, const MetricChange& b) {
  const auto key = [](const MetricChange& c) {
    const double change = std::abs(c.after - c.before) / std::max(std::abs(c.before), 1e-12);
    return std::tuple(c.change != Change::kWorse, c.change != Change::kGone,
                      std::isnan(change) ? -std::numeric_limits<double>::infinity() : -change);
  };
  return key(a) < key(b);
}

}  // namespace

const MetricRow& metric_row(const std::string& metric) {
  static constexpr MetricRow kUnknown{};
  const MetricRow* row = find_metric(metric.substr(0, metric.find("_joint")));
  return row != nullptr ? *row : kUnknown;
}

std::string said(double value) {
  return std::isnan(value) ? "never" : fmt::format("{:.6g}", value);
}

bool larger_is_better(const std::string& metric) {
  return metric_row(metric).better == Better::kMore;
}

int AccuracyReport::worse() const {
  return static_cast<int>(std::count_if(changes.begin(), changes.end(), [](const MetricChange& c) {
    return c.change == Change::kWorse && c.accepted.empty();
  }));
}

AccuracyReport compare_accuracy(const Golden& baseline, const Golden& head,
                                const std::string& filter) {
  AccuracyReport report;
  report.no_baseline = incomparable(baseline, head);
  if (!report.no_baseline.empty()) return report;
  const std::regex wanted(filter);
  for (const auto& [key, before] : baseline.lines) {
    if (!std::regex_search(key.first, wanted)) continue;
    const auto after = head.lines.find(key);
    if (after == head.lines.end()) {
      report.changes.push_back({.entry = key.first,
                                .metric = key.second,
                                .change = Change::kGone,
                                .before = mean(before.values),
                                .after = kNever});
      continue;
    }
    ++report.lines;
    if (unchanged(before, after->second, tolerance_of(key, head))) continue;
    report.changes.push_back(change_of(key, before, after->second, head));
  }
  for (const auto& [key, line] : head.lines) {
    if (baseline.lines.contains(key)) continue;
    report.changes.push_back({.entry = key.first,
                              .metric = key.second,
                              .change = Change::kNew,
                              .before = kNever,
                              .after = mean(line.values)});
  }
  std::stable_sort(report.changes.begin(), report.changes.end(), worse_first);
  return report;
}

std::vector<std::string> not_repeated(const Golden& once, const Golden& again) {
  std::vector<std::string> all;
  for (const auto& [key, line] : again.lines) {
    const auto first = once.lines.find(key);
    for (std::size_t i = 0; i < again.seeds.size(); ++i) {
      const auto seed = std::find(once.seeds.begin(), once.seeds.end(), again.seeds[i]);
      if (first == once.lines.end() || seed == once.seeds.end()) {
        all.push_back(fmt::format("{} {}: there the second time alone", key.first, key.second));
        continue;
      }
      const double a = first->second.values[static_cast<std::size_t>(seed - once.seeds.begin())];
      const double b = line.values[i];
      if (std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) ||
          (std::isnan(a) && std::isnan(b)))
        continue;
      all.push_back(fmt::format("{} {}, {}: {:.17g}, then {:.17g}", key.first, key.second,
                                again.seeds[i], a, b));
    }
  }
  return all;
}

}  // namespace tauext::gate

// SPDX-License-Identifier: Apache-2.0
#include "bench/study/detection/comparison.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <utility>

#include "bench/roster/specification.h"
#include "bench/score/metric_list.h"
#include "bench/score/table.h"
#include "mjcf/scenarios/region_runs.h"
#include "mjcf/trace/table_writer.h"

namespace tauext::study {
namespace {

constexpr const char* kRegionLegend = R"(
Meetings with regions of a body (--regions): share that was marked until {:g} s after the contact
[%], by the speed at which they met [m/s] or that at which the region's limit would be reached by so
much. moved: how far the touched point of the arm moved on until the mark, in half of those that
were marked. exceeded: the share in which the limit was exceeded before anything was marked. The
JSON has each region by itself.
)";

constexpr const char* kComparisonLegend = R"(
The last table compares pairs where each raises at most {:g} false alarm an hour in these very runs: with
its own thresholds times one factor, the same for all joints. `as good` pairs have 95 % intervals (Wilson)
that reach the best pair's. groups: how many there are, the best of each being worse than the best of the
one before, with 95 % each. too loud: pairs that no factor up to 8 makes so quiet.
)";

// "0.10", "25%", .. without the regions
std::vector<std::string> region_kinds() {
  std::vector<std::string> all;
  for (const RegionClass& c : region_classes()) {
    if (std::count(all.begin(), all.end(), c.kind) == 0) all.push_back(c.kind);
  }
  return all;
}

// how many touches a cell has of a kind, and how many of them it finds at a level
struct Count {
  int touches, found;
};
using CountAt = std::function<Count(const Cell&, std::size_t level)>;
using IsIn = std::function<bool(const RegionClass&)>;

CountAt of_regions(IsIn is_in) {
  return [is_in = std::move(is_in)](const Cell& c, std::size_t level) {
    Count sum{0, 0};
    for (std::size_t i = 0; i < c.regions.size(); ++i) {
      if (!is_in(region_classes()[i])) continue;
      sum.touches += c.regions[i].touches;
      sum.found += c.regions[i].found_at[level];
    }
    return sum;
  };
}

Comparison compared(const std::string& what, std::span<const Cell> cells, const CountAt& count) {
  Comparison c{what, false, count(cells.front(), kOwnLevel).touches, {}, {}};
  std::vector<Standing> all;
  for (const Cell& cell : cells) {
    const auto level = cell.level_with(kCommonAlarms);
    if (!level) {
      c.loud.push_back(&cell);
      continue;
    }
    const Count n = count(cell, *level);
    all.push_back(
        {&cell, kLevels[*level], n.found, n.touches, metrics::share_interval(n.found, n.touches)});
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Standing& a, const Standing& b) { return a.recall() > b.recall(); });
  for (Standing& s : all) {
    if (c.groups.empty() || s.interval.high < c.groups.back().front().interval.low)
      c.groups.emplace_back();
    c.groups.back().push_back(s);
  }
  return c;
}

}  // namespace

std::vector<Comparison> compare(std::span<const Cell> cells) {
  std::vector<Comparison> all;
  const auto add = [&](const std::string& what, const CountAt& count) {
    if (!cells.empty() && cells.front().quiet_samples > 0 &&
        count(cells.front(), kOwnLevel).touches > 0)
      all.push_back(compared(what, cells, count));
  };
  add("blows", [](const Cell& c, std::size_t level) {
    return Count{c.blows, c.detected_at[level]};
  });
  add("all regions", of_regions([](const RegionClass&) { return true; }));
  std::vector<const BodyRegion*> regions;
  for (const RegionClass& r : region_classes()) {
    if (std::count(regions.begin(), regions.end(), r.region) == 0) regions.push_back(r.region);
  }
  for (const BodyRegion* region : regions)
    add(std::string(region->name), of_regions([region](const RegionClass& r) {
          return r.region == region && r.meeting != Meeting::kClamped;
        }));
  add("clamped", of_regions([](const RegionClass& r) { return r.meeting == Meeting::kClamped; }));
  const std::size_t wide = all.size();
  for (const RegionClass& one : region_classes())
    add(one.name, of_regions([&one](const RegionClass& r) { return &r == &one; }));
  for (std::size_t i = wide; i < all.size(); ++i) all[i].of_class = true;
  return all;
}

std::string short_name(const Cell& cell, std::span<const Cell> cells) {
  const auto bare = [](const Cell& c) {
    return fmt::format("{}+{}", name_of_specification(c.estimator),
                       name_of_specification(c.detector));
  };
  const std::string name = bare(cell);
  const auto same =
      std::count_if(cells.begin(), cells.end(), [&](const Cell& c) { return bare(c) == name; });
  return same == 1 ? name : cell.name();
}

std::string format_regions(std::span<const Cell> cells) {
  std::vector<TableWriter::Column> columns = {{"estimator+detector", "", true}};
  for (const std::string& kind : region_kinds()) columns.push_back({kind, "%"});
  columns.push_back({"moved", "mm"});
  columns.push_back({"exceeded", "%"});
  TableWriter table(columns);
  for (const Cell& c : cells) {
    std::vector<std::string> row = {short_name(c, cells)};
    double exceeded = 0, all = 0;
    std::vector<double> moved;
    for (const std::string& kind : region_kinds()) {
      int found = 0, touches = 0;
      for (std::size_t i = 0; i < c.regions.size(); ++i) {
        const RegionCount& r = c.regions[i];
        if (region_classes()[i].kind != kind) continue;
        found += r.found, touches += r.touches;
        exceeded += r.exceeded() * r.touches, all += r.touches;
        moved.insert(moved.end(), r.moved.begin(), r.moved.end());
      }
      row.push_back(percent(found, touches));
    }
    std::sort(moved.begin(), moved.end());
    row.push_back(moved.empty() ? "-" : fmt::format("{:.1f}", 1e3 * metrics::quantile(moved, 0.5)));
    row.push_back(percent(exceeded, all));
    table.add(row);
  }
  return table.format();
}

std::string region_legend() {
  return fmt::format(kRegionLegend, metrics::kGrace);
}

std::string comparison_legend() {
  return fmt::format(kComparisonLegend, kCommonAlarms);
}

std::string format_comparisons(std::span<const Cell> cells) {
  TableWriter table({{"touches", "", true},
                     {"of each", ""},
                     {"best", "%"},
                     {"at least", "%"},
                     {"at most", "%"},
                     {"groups", ""},
                     {"as good", "pairs"},
                     {"too loud", "pairs"},
                     {"the best", "", true}});
  for (const Comparison& c : compare(cells)) {
    if (c.of_class) continue;  // the JSON has these
    std::vector<std::string> row = {c.what, fmt::to_string(c.touches)};
    if (c.groups.empty()) {
      row.insert(row.end(), {"-", "-", "-", "0", "0", fmt::to_string(c.loud.size()), "-"});
      table.add(row);
      continue;
    }
    const std::vector<Standing>& best = c.groups.front();
    const metrics::Interval i = best.front().interval;
    for (const double share : {best.front().recall(), i.low, i.high})
      row.push_back(fmt::format("{:.1f}", 100 * share));
    for (const std::size_t n : {c.groups.size(), best.size(), c.loud.size()})
      row.push_back(fmt::to_string(n));
    std::vector<std::string> names;
    for (const Standing& s : best) {
      if (names.size() < 3) names.push_back(short_name(*s.cell, cells));
    }
    row.push_back(fmt::format("{}{}", fmt::join(names, ", "), best.size() > 3 ? ", .." : ""));
    table.add(row);
  }
  return table.format();
}

nlohmann::ordered_json comparisons_json(std::span<const Cell> cells) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const Comparison& c : compare(cells)) {
    nlohmann::ordered_json j = {{"condition", cells.front().condition},
                                {"touches_of", c.what},
                                {"touches", c.touches},
                                {key_of(Metric::kFalseAlarmsPerHour), kCommonAlarms}};
    j["groups"] = j["too_loud"] = nlohmann::ordered_json::array();
    for (const std::vector<Standing>& group : c.groups) {
      auto& of_group = j["groups"].emplace_back(nlohmann::ordered_json::array());
      for (const Standing& s : group)
        of_group.push_back({{"pair", s.cell->name()},
                            {"threshold_factor", std::round(1e4 * s.factor) / 1e4},
                            {"found", s.found},
                            {"recall", s.recall()},
                            {key_of(Metric::kRecallLow), s.interval.low},
                            {key_of(Metric::kRecallHigh), s.interval.high}});
    }
    for (const Cell* const cell : c.loud) j["too_loud"].push_back(cell->name());
    all.push_back(std::move(j));
  }
  return all;
}

std::vector<std::span<const Cell>> by_condition(const std::vector<Cell>& cells) {
  std::vector<std::span<const Cell>> all;
  for (auto first = cells.begin(); first != cells.end();) {
    const auto last = std::find_if(first, cells.end(),
                                   [&](const Cell& c) { return c.condition != first->condition; });
    all.emplace_back(first, last);
    first = last;
  }
  return all;
}

}  // namespace tauext::study

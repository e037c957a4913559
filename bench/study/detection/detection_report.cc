// SPDX-License-Identifier: Apache-2.0
#include "bench/study/detection/detection_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/score/detection_metrics.h"
#include "bench/score/metric_list.h"
#include "bench/score/table.h"
#include "bench/study/detection/comparison.h"
#include "bench/study/study_runs.h"

namespace tauext::study {
namespace {

using metrics::poisson_upper;
using metrics::quantile;
using Json = nlohmann::ordered_json;

constexpr const char* kDetectionLegend = R"(
recall: share of the blows that were marked until {:g} s after their end; with 95 % confidence it is
`at least` that (Wilson). p50, p95: half, and 95 % of these marks come within this time from the
blow's begin. stray: other marks in the same runs.
alarms: marks in free motion and slow pushes, where nothing is hit; with 95 % confidence there are
fewer of them per hour than `fewer than`. on: share of that time in which the detector is in
alarm. called: marks there that are called a collision. brisk: share of the pushes of a third of
the largest blow, in 0.1 s, that were marked. clamping: share of the soft clampings that
were marked while they held. named: share that was also called a clamping. failed: runs in which
an estimate was missing; they count like the others. Keys of specifications stand in the JSON where
pairs are told apart without them.
)";

std::string per_hour(double alarms, const Cell& c) {
  return c.quiet_samples == 0 ? "-" : fmt::format("{:.1f}", alarms / c.hours());
}

std::vector<TableWriter::Column> detection_columns() {
  return {{"estimator+detector", "", true},
          {"recall", "%"},
          {"at least", "%"},
          {"p50", "ms"},
          {"p95", "ms"},
          {"stray", "marks"},
          {"alarms", "1/h"},
          {"fewer than", "1/h"},
          {"on", "%"},
          {"called", "collision"},
          {"brisk", "%"},
          {"clamping", "%"},
          {"named", "%"},
          {"failed", "runs"}};
}

std::vector<std::string> cells_of(const Cell& c, const std::string& name) {
  return {name,
          percent(c.detected, c.blows),
          percent(metrics::share_interval(c.detected, c.blows).low, c.blows == 0 ? 0 : 1),
          milliseconds(quantile(c.delays, 0.5)),
          milliseconds(quantile(c.delays, 0.95)),
          fmt::to_string(c.stray),
          per_hour(c.alarms, c),
          per_hour(poisson_upper(c.alarms), c),
          percent(static_cast<double>(c.alarmed_samples), static_cast<double>(c.quiet_samples)),
          fmt::to_string(c.collision_alarms),
          percent(c.brisk_flagged, c.brisk),
          percent(c.clampings_flagged, c.clampings),
          percent(c.clampings_named, c.clampings),
          fmt::to_string(c.failed_runs)};
}

std::string text(const StudyRuns& runs, const std::vector<Cell>& cells) {
  std::string out;
  bool regions = false, compares = false;
  for (const std::span<const Cell> of_one : by_condition(cells)) {
    const Cell& first = of_one.front();
    if (first.runs == 0) continue;  // it was stopped before
    out += fmt::format("{}{}: {}; {} blows, {:.2f} h, {} brisk pushes, {} clampings\n",
                       out.empty() ? "" : "\n", first.condition,
                       condition(runs, first.condition).description, first.blows, first.hours(),
                       first.brisk, first.clampings);
    TableWriter table(detection_columns());
    for (const Cell& c : of_one) table.add(cells_of(c, short_name(c, of_one)));
    out += table.format();
    if (!first.regions.empty()) out += "\n" + format_regions(of_one);
    regions = regions || !first.regions.empty();
    if (of_one.size() < 2 || first.quiet_samples == 0 || first.blows + first.regions.size() == 0)
      continue;
    compares = true;
    out += "\n" + format_comparisons(of_one);
  }
  return out + fmt::format(kDetectionLegend, metrics::kGrace) + (regions ? region_legend() : "") +
         (compares ? comparison_legend() : "");
}

Json number(double x) {
  return std::isnan(x) ? Json(nullptr) : Json(x);
}

// a share with its 95 % interval; nothing of nothing
void put_recall(Json& j, int found, int of) {
  if (of == 0) return;
  const metrics::Interval recall = metrics::share_interval(found, of);
  j[key_of(Metric::kRecall)] = static_cast<double>(found) / of;
  j[key_of(Metric::kRecallLow)] = recall.low;
  j[key_of(Metric::kRecallHigh)] = recall.high;
}

Json roc_of(const Cell& c) {
  Json roc;
  for (std::size_t i = 0; i < kLevels.size(); ++i) {
    Json point;
    point["threshold_factor"] = std::round(1e4 * kLevels[i]) / 1e4;
    point[key_of(Metric::kRecall)] = 0.;
    put_recall(point, c.detected_at[i], c.blows);
    if (c.quiet_samples > 0)
      point[key_of(Metric::kFalseAlarmsPerHour)] = c.alarms_at[i] / c.hours();
    int touches = 0, found = 0;
    for (const RegionCount& r : c.regions) touches += r.touches, found += r.found_at[i];
    if (touches > 0) {
      const metrics::Interval share = metrics::share_interval(found, touches);
      point["region_recall"] = static_cast<double>(found) / touches;
      point["region_recall_low"] = share.low;
      point["region_recall_high"] = share.high;
    }
    roc.push_back(point);
  }
  return roc;
}

Json regions_of(const Cell& c) {
  Json all = Json::array();
  for (std::size_t i = 0; i < c.regions.size(); ++i) {
    const RegionClass& of = region_classes()[i];
    const RegionCount& r = c.regions[i];
    if (r.touches == 0) continue;
    Json j = {{"class", of.name},      {"region", of.region->name}, {"kind", of.kind},
              {"limit_N", of.limit()}, {"touches", r.touches},      {"found", r.found}};
    put_recall(j, r.found, r.touches);
    j["delay_p50_s"] = number(quantile(r.delays, 0.5));
    j["delay_p95_s"] = number(quantile(r.delays, 0.95));
    j["moved_p50_m"] = number(quantile(r.moved, 0.5));
    j["moved_p95_m"] = number(quantile(r.moved, 0.95));
    j["exceeded"] = r.exceeded();
    const auto rounded = [](double x) {
      return std::round(x * 1e5) / 1e5;
    };  // a file of 1 MB, not 10
    for (int k = 0; k <= 20; ++k) {
      j["peak_of_limit_quantiles"].push_back(rounded(quantile(r.peaks, k / 20.)));
      j["until_found_of_limit_quantiles"].push_back(rounded(quantile(r.until_found, k / 20.)));
    }
    all.push_back(j);
  }
  return all;
}

Json to_json(const Cell& c) {
  Json j;
  j["condition"] = c.condition;
  j["estimator"] = c.estimator;
  j["detector"] = c.detector;
  j["runs"] = c.runs;
  j["failed_runs"] = c.failed_runs;
  j["collisions"] = c.blows;
  j["detected"] = c.detected;
  j[key_of(Metric::kRecall)] = c.recall();
  put_recall(j, c.detected, c.blows);
  j["delay_p50_s"] = number(quantile(c.delays, 0.5));
  j["delay_p95_s"] = number(quantile(c.delays, 0.95));
  if (!c.delays.empty()) {
    for (int i = 0; i <= 20; ++i) j["delay_quantiles_s"].push_back(quantile(c.delays, i / 20.));
  }
  j["stray_marks"] = c.stray;
  j["quiet_h"] = c.hours();
  j[key_of(Metric::kFalseAlarms)] = c.alarms;
  j["quiet_time_in_alarm_h"] = static_cast<double>(c.alarmed_samples) * c.Ts / 3600;
  j["false_alarms_called_collision"] = c.collision_alarms;
  if (c.quiet_samples > 0) {
    j[key_of(Metric::kFalseAlarmsPerHour)] = c.alarms / c.hours();
    j["false_alarms_per_hour_upper95"] = poisson_upper(c.alarms) / c.hours();
  }
  j["brisk_pushes"] = c.brisk;
  j["brisk_pushes_flagged"] = c.brisk_flagged;
  j["clampings"] = c.clampings;
  j["clampings_flagged"] = c.clampings_flagged;
  j["clampings_named"] = c.clampings_named;
  j["roc"] = roc_of(c);
  if (!c.regions.empty()) j["regions"] = regions_of(c);
  return j;
}

Json to_json(const Condition& c) {
  Json j;
  j["description"] = c.description;
  j["panel_kg"] = c.panel;
  j["believed_kg"] = c.believed;
  j["degradation"] = describe(c.degradation);
  return j;
}

}  // namespace

std::string format_study(const StudyRuns& runs, const std::vector<Cell>& cells,
                         TableFormat format) {
  if (format == TableFormat::kText) return text(runs, cells);
  std::vector<TableWriter::Column> all = detection_columns();
  all.insert(all.begin(), {"condition", "", true});
  TableWriter table(all);
  for (const Cell& c : cells) {
    std::vector<std::string> row = cells_of(c, c.name());
    row.insert(row.begin(), c.condition);
    table.add(row);
  }
  return table.format(format);
}

std::string study_json(const StudyRuns& runs, const std::vector<Cell>& cells,
                       const Thresholds& thresholds,
                       const std::vector<std::pair<std::string, std::string>>& context) {
  Json j;
  j["format"] = "tauext-detection-1";
  j["context"] = Json::object();
  for (const auto& [key, text] : context) j["context"][key] = text;
  j["robot"] = runs.robot->name();
  j["thresholds_trained_on"] = thresholds.trained_on;
  j["margin"] = thresholds.margin;
  for (const Condition& c : runs.conditions) {
    const bool used = std::any_of(cells.begin(), cells.end(),
                                  [&](const Cell& cell) { return cell.condition == c.name; });
    if (used) j["conditions"][c.name] = to_json(c);
  }
  j["cells"] = Json::array();
  for (const Cell& c : cells) j["cells"].push_back(to_json(c));
  j["comparisons"] = Json::array();
  for (const std::span<const Cell> of_one : by_condition(cells)) {
    for (Json& c : comparisons_json(of_one)) j["comparisons"].push_back(std::move(c));
  }
  return j.dump(1) + "\n";
}

}  // namespace tauext::study

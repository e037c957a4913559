// SPDX-License-Identifier: Apache-2.0
#include "bench/detection_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/metrics.h"

namespace tauext {
namespace {

using Json = nlohmann::ordered_json;

std::string name_of(const Cell& c) {
  return c.estimator + "+" + c.detector;
}

std::string percent(int part, int of) {
  return of == 0 ? "-" : fmt::format("{:.1f}", 100. * part / of);
}

std::string milliseconds(double s) {
  return std::isnan(s) ? "-" : fmt::format("{:.0f}", 1e3 * s);
}

// alarms an hour, and what 95 % of such hours stay below
std::string rate(const Cell& c) {
  if (c.quiet_samples == 0) return "-";
  return fmt::format("{:.1f} (<{:.1f})", c.alarms / c.hours(), poisson_upper(c.alarms) / c.hours());
}

// how much of that time it is in alarm
std::string on(const Cell& c) {
  if (c.quiet_samples == 0) return "-";
  return fmt::format("{:.1f}", 100. * static_cast<double>(c.alarmed_samples) /
                                   static_cast<double>(c.quiet_samples));
}

constexpr const char* kRow =
    "{:<34} {:>7} {:>5} {:>5} {:>6} {:>17} {:>9} {:>6} {:>8} {:>7} {:>6}\n";

std::string head() {
  return fmt::format(fmt::runtime(kRow), "estimator+detector", "recall", "p50", "p95", "stray",
                     "alarms", "on", "called", "brisk", "clamping", "named", "failed") +
         fmt::format(fmt::runtime(kRow), "", "%", "ms", "ms", "marks", "1/h", "%", "collision", "%",
                     "%", "%", "runs");
}

std::string line(const Cell& c) {
  return fmt::format(fmt::runtime(kRow), name_of(c), percent(c.detected, c.blows),
                     milliseconds(quantile(c.delays, 0.5)), milliseconds(quantile(c.delays, 0.95)),
                     c.stray, rate(c), on(c), c.collision_alarms, percent(c.brisk_flagged, c.brisk),
                     percent(c.clampings_flagged, c.clampings),
                     percent(c.clampings_named, c.clampings), c.failed_runs);
}

Json number(double x) {
  return std::isnan(x) ? Json(nullptr) : Json(x);
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
  j["recall"] = c.recall();
  j["delay_p50_s"] = number(quantile(c.delays, 0.5));
  j["delay_p95_s"] = number(quantile(c.delays, 0.95));
  j["stray_marks"] = c.stray;
  j["quiet_h"] = c.hours();
  j["false_alarms"] = c.alarms;
  j["quiet_time_in_alarm_h"] = static_cast<double>(c.alarmed_samples) * 1e-3 / 3600;
  j["false_alarms_called_collision"] = c.collision_alarms;
  if (c.quiet_samples > 0) {
    j["false_alarms_per_hour"] = c.alarms / c.hours();
    j["false_alarms_per_hour_upper95"] = poisson_upper(c.alarms) / c.hours();
  }
  j["brisk_pushes"] = c.brisk;
  j["brisk_pushes_flagged"] = c.brisk_flagged;
  j["clampings"] = c.clampings;
  j["clampings_flagged"] = c.clampings_flagged;
  j["clampings_named"] = c.clampings_named;
  for (std::size_t i = 0; i < kLevels.size(); ++i) {
    Json point;
    point["threshold_factor"] = kLevels[i];
    point["recall"] = c.blows == 0 ? 0. : static_cast<double>(c.detected_at[i]) / c.blows;
    if (c.quiet_samples > 0) point["false_alarms_per_hour"] = c.alarms_at[i] / c.hours();
    j["roc"].push_back(point);
  }
  return j;
}

}  // namespace

std::string format_study(const std::vector<Cell>& cells) {
  std::string out, before;
  for (const Cell& c : cells) {
    if (c.condition != before) {
      const Condition& now = condition(c.condition);
      out += fmt::format("{}{}: {}; {} blows, {:.2f} h, {} brisk pushes, {} clampings\n{}",
                         before.empty() ? "" : "\n", c.condition, now.description, c.blows,
                         c.hours(), c.brisk, c.clampings, head());
    }
    before = c.condition;
    out += line(c);
  }
  return out +
         "\nrecall: blows marked until 0.2 s after them; p50, p95: delay from the blow's begin to "
         "its\n"
         "mark. stray: other marks in these runs. alarms: marks in free motion and slow pushes, "
         "and the\n"
         "rate that is excluded at 95 %; on: share of that time in alarm; called collision: marks "
         "that\n"
         "say so. brisk: pushes of 100 N in 0.1 s that were marked. clamping: soft clampings "
         "marked while\n"
         "they hold; named: as clampings. failed: runs in which an estimate was missing; they "
         "count.\n";
}

std::string study_json(const std::vector<Cell>& cells, const Thresholds& thresholds) {
  Json j;
  j["format"] = "tauext-detection-1";
  j["robot"] = "wallmobot3";
  j["thresholds_trained_on"] = thresholds.trained_on;
  j["margin"] = thresholds.margin;
  for (const Condition& c : conditions()) {
    const bool used = std::any_of(cells.begin(), cells.end(),
                                  [&](const Cell& cell) { return cell.condition == c.name; });
    if (!used) continue;
    Json known;
    known["description"] = c.description;
    known["panel_kg"] = c.panel;
    known["believed_kg"] = c.believed;
    known["degradation"] = describe(c.degradation);
    j["conditions"][c.name] = known;
  }
  j["cells"] = Json::array();
  for (const Cell& c : cells) j["cells"].push_back(to_json(c));
  return j.dump(1) + "\n";
}

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
#include "bench/study/reliability.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/roster/baselines.h"
#include "bench/roster/robots.h"
#include "bench/score/degradation.h"
#include "bench/score/detection_metrics.h"
#include "bench/score/suite.h"
#include "bench/score/table.h"
#include "bench/study/study_runs.h"
#include "mjcf/record.h"

namespace tauext::study {
namespace {

using metrics::detection_score;
using metrics::DetectionScore;
using metrics::quantile;

constexpr const char* kReliabilityLegend =
    R"(missed: blows without a mark until {:g} s after their end. stray: other marks in these runs. p50,
p95: half, and 95 % of the marks come within this time from the blow's begin. manual: marks while
the hand moves the arm.
)";

Trace run_of(const std::string& robot, const Scenario& s, Sensors sensors, std::uint64_t seed) {
  sensors.seed = seed;
  return record(load_for(robot, s), s, sensors);
}

std::vector<Reliability> pairs_of(const Robot& r) {
  std::vector<Reliability> rows;
  for (const std::string& e : r.estimators()) {
    if (is_baseline(e)) continue;
    for (const std::string& d : r.detectors()) {
      if (!study_only(d)) rows.push_back({.estimator = e, .detector = d});
    }
  }
  return rows;
}

void add_blow(const Robot& r, const Trace& t, Reliability& row, std::vector<double>& delays) {
  const Output out = r.runner(row.estimator, row.detector, t)->run();
  const DetectionScore score = detection_score(t.t, t.contact, out.marks);
  ++row.blows;
  row.missed += score.collisions - score.detected;
  row.stray += score.false_alarms;
  if (score.detected > 0) delays.push_back(score.delay);
}

void add_hand(const Robot& r, const Trace& t, Reliability& row) {
  const Output out = r.runner(row.estimator, row.detector, t)->run();
  row.alarms += static_cast<int>(std::count(out.marks.begin(), out.marks.end(), 1));
  const double n = t.size();
  row.hours += (t.t.back() - t.t.front()) * n / (n - 1) / 3600;  // the last sample's period, too
}

std::vector<TableWriter::Column> reliability_columns() {
  return {{"estimator+detector", "", true},
          {"missed", "blows"},
          {"stray", "marks"},
          {"p50", "ms"},
          {"p95", "ms"},
          {"manual", "marks"}};
}

std::vector<std::string> cells_of(const Reliability& r) {
  return {r.estimator + "+" + r.detector, fmt::to_string(r.missed),  fmt::to_string(r.stray),
          milliseconds(r.delay_p50),      milliseconds(r.delay_p95), fmt::to_string(r.alarms)};
}

std::string text(const Tried& tried) {
  TableWriter table(reliability_columns());
  for (const Reliability& r : tried.rows) table.add(cells_of(r));
  return fmt::format(
      R"({}, sensors with {}: {} blows of 100 to 300 N and 10 to 50 ms, up or down, while it
moves or rests, and {:.2g} h of a hand that moves the arm
{}
)",
      drawn_runs(tried.trials.robot).robot, describe({tried.trials.sensors, {}, {}}),
      tried.trials.blows, tried.rows.empty() ? 0 : tried.rows[0].hours, table.format());
}

}  // namespace

std::vector<Reliability> reliability(const Trials& trials,
                                     const std::function<void(double)>& progress) {
  const StudyRuns& runs = drawn_runs(trials.robot);
  const Robot& r = robot(runs.robot);
  std::vector<Reliability> rows = pairs_of(r);
  std::vector<std::vector<double>> delays(rows.size());
  const double work = 2. * trials.blows + 30. * trials.manual_runs;  // [s] of runs
  const auto report = [&](int blows, int manual_runs) {
    if (progress) progress((2. * blows + 30. * manual_runs) / work);
  };
  for (int seed = 1; seed <= trials.blows; ++seed) {
    const Trace t = run_of(runs.robot, runs.blow(seed), trials.sensors, seed);
    for (std::size_t i = 0; i < rows.size(); ++i) add_blow(r, t, rows[i], delays[i]);
    report(seed, 0);
  }
  for (int seed = 1; seed <= trials.manual_runs; ++seed) {
    const Trace t = run_of(runs.robot, runs.manual(seed), trials.sensors, seed);
    for (Reliability& row : rows) add_hand(r, t, row);
    report(trials.blows, seed);
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].delay_p50 = quantile(delays[i], 0.5);
    rows[i].delay_p95 = quantile(delays[i], 0.95);
  }
  return rows;
}

std::string format_reliability(const std::vector<Tried>& all, TableFormat format) {
  if (format == TableFormat::kText) {
    std::string out;
    for (const Tried& tried : all) out += text(tried);
    return out + fmt::format(kReliabilityLegend, metrics::kGrace);
  }
  std::vector<TableWriter::Column> all_columns = reliability_columns();
  all_columns.insert(all_columns.begin(), {"velocity noise", "rad/s"});
  TableWriter table(all_columns);
  for (const Tried& tried : all) {
    for (const Reliability& r : tried.rows) {
      std::vector<std::string> row = cells_of(r);
      row.insert(row.begin(), fmt::format("{:g}", tried.trials.sensors.velocity_noise));
      table.add(row);
    }
  }
  return table.format(format);
}

}  // namespace tauext::study

// SPDX-License-Identifier: Apache-2.0
#include "bench/reliability.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/metrics.h"
#include "bench/robot.h"
#include "bench/suite.h"

namespace tauext {
namespace {

constexpr const char* kRobot = "testbed1";

Trace run_of(const Scenario& s, Sensors sensors, std::uint64_t seed) {
  sensors.seed = seed;
  return record(load_for(kRobot, s), s, sensors);
}

std::string milliseconds(double s) {
  return std::isnan(s) ? "-" : fmt::format("{:.0f}", 1e3 * s);
}

}  // namespace

std::vector<Reliability> reliability(const Trials& trials,
                                     const std::function<void(double)>& progress) {
  const Robot& r = robot(kRobot);
  std::vector<Reliability> rows;
  for (const std::string& e : r.estimators) {
    if (is_baseline(e)) continue;
    for (const std::string& d : r.detectors) {
      if (!study_only(d)) rows.push_back({.estimator = e, .detector = d});
    }
  }
  std::vector<std::vector<double>> delays(rows.size());
  const auto report = [&](double share) {
    if (progress) progress(share);
  };

  // 2 s and 30 s a run
  const double work = 2. * trials.blows + 30. * trials.manual_runs;
  for (int seed = 1; seed <= trials.blows; ++seed) {
    const Trace t = run_of(blow_on_testbed1(seed), trials.sensors, seed);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Output out = r.runner(rows[i].estimator, rows[i].detector, t)->run();
      const DetectionScore score = detection_score(t.t, t.contact, out.marks);
      ++rows[i].blows;
      rows[i].missed += score.collisions - score.detected;
      rows[i].stray += score.false_alarms;
      if (score.detected > 0) delays[i].push_back(score.delay);
    }
    report(2. * seed / work);
  }
  for (int seed = 1; seed <= trials.manual_runs; ++seed) {
    const Trace t = run_of(manual_of_testbed1(seed), trials.sensors, seed);
    for (Reliability& row : rows) {
      const Output out = r.runner(row.estimator, row.detector, t)->run();
      row.alarms += static_cast<int>(std::count(out.marks.begin(), out.marks.end(), 1));
      row.hours += t.size() * 1e-3 / 3600;
    }
    report((2. * trials.blows + 30. * seed) / work);
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].delay_p50 = quantile(delays[i], 0.5);
    rows[i].delay_p95 = quantile(delays[i], 0.95);
  }
  return rows;
}

std::string format_reliability(const Trials& trials, const std::vector<Reliability>& rows) {
  std::string out = fmt::format(
      "testbed1, velocity noise {:g} rad/s: {} blows of 100 to 300 N, 10 to 50 ms, up or down, "
      "while it "
      "moves or rests;\nand {:.2g} h of a hand that moves the arm\n"
      "{:<34} {:>7} {:>7} {:>10} {:>10} {:>8}\n{:<34} {:>7} {:>7} {:>10} {:>10} {:>8}\n",
      trials.sensors.velocity_noise, trials.blows, rows.empty() ? 0 : rows[0].hours,
      "estimator+detector", "missed", "stray", "delay p50", "delay p95", "manual", "", "blows",
      "marks", "ms", "ms", "marks");
  for (const Reliability& r : rows) {
    out += fmt::format("{:<34} {:>7} {:>7} {:>10} {:>10} {:>8}\n", r.estimator + "+" + r.detector,
                       r.missed, r.stray, milliseconds(r.delay_p50), milliseconds(r.delay_p95),
                       r.alarms);
  }
  return out;
}

}  // namespace tauext

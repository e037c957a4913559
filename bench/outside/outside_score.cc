// SPDX-License-Identifier: Apache-2.0
#include "bench/outside/outside_score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "bench/score/detection_metrics.h"
#include "bench/score/metrics.h"
#include "bench/score/suite.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

using Eigen::VectorXd;

// samples that count and while which nothing touches, or has touched just before
std::vector<int> untouched(const LogRun& run) {
  std::vector<int> samples;
  const Trace& t = *run.trace;
  double last = -std::numeric_limits<double>::infinity();  // [s] of a contact
  for (int k = 0; k < t.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    if (!t.contact.empty() && t.contact[at] != 0) last = t.t[at];
    if (t.t[at] >= run.from && t.t[at] > last + metrics::kGrace) samples.push_back(k);
  }
  return samples;
}

VectorXd mean(const Output& o, const std::vector<int>& samples, std::size_t from, std::size_t to) {
  VectorXd sum = VectorXd::Zero(o.tau_ext.rows());
  for (std::size_t i = from; i < to; ++i) sum += o.tau_ext.col(samples[i]);
  return sum / static_cast<double>(to - from);
}

Score::Joints as_list(const VectorXd& v) {
  return Score::Joints(v.begin(), v.end());
}

// the first log that fails, and why
std::string failure(const std::vector<OutsideRun>& runs, const std::vector<OutsideEstimates>& all) {
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::string why = bad_status(*runs[i].trace, all[i].output);
    if (!why.empty()) return runs.size() == 1 ? why : runs[i].log + ": " + why;
  }
  return "";
}

// times, truth and estimates of all samples that count, one log after the other
std::pair<Trace, Output> joined(const std::vector<LogRun>& logs) {
  Trace trace;
  Output out;
  Eigen::Index n = 0;
  for (const LogRun& log : logs) {
    for (const double t : log.trace->t) n += t >= log.from;
  }
  const Eigen::Index dof = logs.front().trace->dof();
  trace.tau_ext.resize(dof, n), out.tau_ext.resize(dof, n);
  for (const LogRun& log : logs) {
    const double shift = trace.t.empty() ? 0 : trace.t.back() + 1 - log.trace->t.front();
    for (int k = 0; k < log.trace->size(); ++k) {
      const double t = log.trace->t[static_cast<std::size_t>(k)];
      if (t < log.from) continue;
      const auto at = static_cast<Eigen::Index>(trace.t.size());
      trace.tau_ext.col(at) = log.trace->tau_ext.col(k);
      out.tau_ext.col(at) = log.output->tau_ext.col(k);
      trace.t.push_back(t + shift);
    }
  }
  trace.q.resize(dof, 0);  // of so many joints
  return {std::move(trace), std::move(out)};
}

}  // namespace

void add_floor_metrics(const std::vector<LogRun>& runs, Score& score) {
  const bool unknown = std::any_of(runs.begin(), runs.end(), [](const LogRun& r) {
    return r.trace->force.cols() > 0 && r.trace->contact.empty();
  });
  if (runs.empty() || unknown) return;
  const Eigen::Index n = runs.front().output->tau_ext.rows();
  VectorXd squares = VectorXd::Zero(n), drift = VectorXd::Zero(n);
  std::size_t count = 0;
  for (const LogRun& run : runs) {
    const std::vector<int> samples = untouched(run);
    for (const int k : samples) squares += run.output->tau_ext.col(k).cwiseAbs2();
    count += samples.size();
    const std::size_t third = samples.size() / 3;
    if (third == 0) continue;
    const VectorXd wandered = mean(*run.output, samples, samples.size() - third, samples.size()) -
                              mean(*run.output, samples, 0, third);
    drift = drift.cwiseMax(wandered.cwiseAbs());
  }
  if (count < 3) return;
  score.set_joints(Metric::kFloor,
                   as_list((squares / static_cast<double>(count)).cwiseSqrt().eval()));
  score.set_joints(Metric::kDrift, as_list(drift));
}

void add_vendor_metrics(const std::vector<LogRun>& runs, Score& score) {
  const bool known = std::all_of(runs.begin(), runs.end(), [](const LogRun& r) {
    return r.trace->tau_ext_of_driver.cols() == r.trace->size() && r.trace->size() > 0;
  });
  if (runs.empty() || !known) return;
  const Eigen::Index n = runs.front().output->tau_ext.rows();
  Score::Joints correlation;
  std::vector<double> gain;
  Eigen::Index worst = 0;
  for (Eigen::Index j = 0; j < n; ++j) {
    double count = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
    for (const LogRun& run : runs) {
      for (int k = 0; k < run.trace->size(); ++k) {
        if (run.trace->t[static_cast<std::size_t>(k)] < run.from) continue;
        const double a = run.output->tau_ext(j, k), b = run.trace->tau_ext_of_driver(j, k);
        count += 1, x += a, y += b, xx += a * a, yy += b * b, xy += a * b;
      }
    }
    const double cov = xy - x * y / count, vx = xx - x * x / count, vy = yy - y * y / count;
    correlation.push_back(vx > 0 && vy > 0 ? cov / std::sqrt(vx * vy) : kNoValue);
    gain.push_back(vx > 0 ? cov / vx : kNoValue);
    if (correlation.back() < correlation[static_cast<std::size_t>(worst)]) worst = j;
  }
  score.set_joints(Metric::kMakerCorrelation, correlation);
  score.set(Metric::kMakerGain, gain[static_cast<std::size_t>(worst)]);
  const LogRun& run = runs.front();
  const auto ours = run.output->tau_ext.row(worst),
             theirs = run.trace->tau_ext_of_driver.row(worst);
  const std::vector<double>& t = run.trace->t;
  const double from = std::max(run.from - t.front(), 0.);  // as a lag counts it
  const double after = metrics::lag(t, theirs, ours, from),
               before = metrics::lag(t, ours, theirs, from);
  score.set(Metric::kMakerLag, after > 0 || std::isnan(before) ? after : -before);
}

void add_label_metrics(const std::vector<LogRun>& runs, Score& score) {
  metrics::DetectionScore all;
  double hours = 0;  // that were watched
  for (const LogRun& run : runs) {
    if (run.output->marks.empty()) return;
    const Trace& t = *run.trace;
    const auto from = std::lower_bound(t.t.begin(), t.t.end(), run.from) - t.t.begin();
    const std::vector<double> times(t.t.begin() + from, t.t.end());
    const std::vector<std::uint8_t> marks(run.output->marks.begin() + from,
                                          run.output->marks.end());
    std::vector<std::uint8_t> contact(marks.size(), 0);
    if (!t.contact.empty()) contact.assign(t.contact.begin() + from, t.contact.end());
    const metrics::DetectionScore d = metrics::detection_score(times, contact, marks);
    all.collisions += d.collisions;
    all.detected += d.detected;
    all.false_alarms += d.false_alarms;
    all.delays.insert(all.delays.end(), d.delays.begin(), d.delays.end());
    hours += d.watched / 3600;
  }
  if (all.collisions > 0) {
    const metrics::Interval recall = metrics::share_interval(all.detected, all.collisions);
    score.set(Metric::kRecall, static_cast<double>(all.detected) / all.collisions);
    score.set(Metric::kRecallLow, recall.low);
    score.set(Metric::kRecallHigh, recall.high);
    score.set(Metric::kDelay, metrics::quantile(all.delays, 1));
    score.set(Metric::kDelayMedian, metrics::quantile(all.delays, 0.5));
  }
  score.set(Metric::kFalseAlarms, all.false_alarms);
  if (!(hours > 0)) return;
  const metrics::Interval alarms = metrics::count_interval(all.false_alarms);
  score.set(Metric::kFalseAlarmsPerHour, all.false_alarms / hours);
  score.set(Metric::kFalseAlarmsLow, alarms.low / hours);
  score.set(Metric::kFalseAlarmsHigh, alarms.high / hours);
}

void take_sensor(const Robot& robot, Trace& trace) {
  if (trace.force.cols() == 0 || trace.tau_ext_of_driver.cols() > 0) return;
  const auto arm = robot.forces_at(kEndEffector, false);
  trace.tau_ext_of_driver.resize(trace.dof(), trace.size());
  for (int k = 0; k < trace.size(); ++k)
    trace.tau_ext_of_driver.col(k) = arm->torque(trace.q.col(k), trace.force.col(k));
}

Row score_outside(const OutsideRun& run, const OutsideEstimates& e) {
  Row row = score_outside(std::vector{run}, std::vector{e});
  const Trace& trace = *run.trace;
  if (run.scenario != nullptr) add_response_metrics(trace, e.output, *run.scenario, row.score);
  if (run.robot != nullptr && trace.force.cols() > 0) {
    const auto arm = run.robot->forces_at(kEndEffector, false);
    const double force = metrics::force_rmse(*arm, trace, e.output.tau_ext, run.score_from);
    if (!std::isnan(force)) row.score.set(Metric::kForce, force);
  }
  return row;
}

Row score_outside(const std::vector<OutsideRun>& runs,
                  const std::vector<OutsideEstimates>& estimates) {
  const OutsideRun& first = runs.front();
  const OutsideEstimates& name = estimates.front();
  Row row{Entry::made_elsewhere(first.group, name.estimator, name.detector, first.robot), {}};
  Score& score = row.score;
  score.error = failure(runs, estimates);
  std::vector<LogRun> logs;
  bool truth = true;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Trace& trace = *runs[i].trace;
    logs.push_back({&trace, &estimates[i].output, runs[i].score_from});
    score.counts.add(estimates[i].output.counts);
    truth = truth && trace.has_truth();
  }
  score.set(Metric::kLeftOut, static_cast<double>(score.counts.left_out()));
  if (truth) {
    const auto [trace, out] = joined(logs);
    add_error_metrics(trace, out, trace.t.empty() ? 0 : trace.t.front(), score);
    if (runs.size() > 1) score.unset(Metric::kMaxAt);  // a time of no log
  } else {
    add_floor_metrics(logs, score);
  }
  add_vendor_metrics(logs, score);
  if (truth && runs.size() == 1) {
    add_detection_metrics(*first.trace, name.output, score);
  } else {
    add_label_metrics(logs, score);
  }
  return row;
}

std::string results_json(const std::vector<Row>& rows,
                         const std::vector<std::pair<std::string, std::string>>& context) {
  nlohmann::json all{{"context", nlohmann::json::object()},
                     {"benchmarks", nlohmann::json::array()}};
  for (const auto& [key, text] : context) all["context"][key] = text;
  for (const Row& r : rows) {
    const std::string name = printable_name(r.entry.name(), 1000);
    nlohmann::json one{{"name", name}, {"run_name", name}, {"run_type", "iteration"}};
    if (!r.score.error.empty()) {
      one["error_occurred"] = true;
      one["error_message"] = r.score.error;
    }
    std::string never;
    for (const auto& [key, value] : r.score.by_key()) {
      if (std::isnan(value)) {
        never += " " + key;
      } else {
        one[key] = value;
      }
    }
    if (!never.empty()) one["label"] = "never:" + never;
    all["benchmarks"].push_back(one);
  }
  return all.dump(2) + "\n";
}

}  // namespace tauext

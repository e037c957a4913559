// SPDX-License-Identifier: Apache-2.0
#include "bench/outside/outside_score.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "bench/outside/log_metrics.h"
#include "bench/score/detection_metrics.h"
#include "bench/score/metrics.h"
#include "bench/score/suite.h"
#include "mjcf/trace/printable.h"

namespace tauext {

namespace {

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
  add_maker_metrics(logs, score);
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

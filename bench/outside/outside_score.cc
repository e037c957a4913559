// SPDX-License-Identifier: Apache-2.0
#include "bench/outside/outside_score.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/outside/log_metrics.h"
#include "bench/score/detection_metrics.h"
#include "bench/score/metrics.h"
#include "bench/score/suite.h"
#include "mjcf/trace/printable.h"

namespace tauext {

Row score_outside(const OutsideRun& run, const OutsideEstimates& e) {
  const Trace& trace = *run.trace;
  Row row{Entry::made_elsewhere(run.group, e.estimator, e.detector, run.robot), {}};
  Score& score = row.score;
  score.error = bad_status(trace, e.output);
  score.counts = e.output.counts;
  score.set(Metric::kLeftOut, static_cast<double>(e.output.counts.left_out()));
  const std::vector<LogRun> log = {{&trace, &e.output, run.score_from}};
  if (trace.has_truth()) {
    add_error_metrics(trace, e.output, run.score_from, score);
  } else {
    add_floor_metrics(log, score);
  }
  add_maker_metrics(log, score);
  if (run.scenario != nullptr) add_response_metrics(trace, e.output, *run.scenario, score);
  if (run.robot != nullptr && trace.force.cols() > 0) {
    const auto arm = run.robot->forces_at(kEndEffector, false);
    const double force = metrics::force_rmse(*arm, trace, e.output.tau_ext, run.score_from);
    if (!std::isnan(force)) score.set(Metric::kForce, force);
  }
  if (trace.has_truth()) {
    add_detection_metrics(trace, e.output, score);
  } else {
    add_label_metrics(log, score);
  }
  return row;
}

std::string results_json(const std::vector<Row>& rows, const std::string& about) {
  nlohmann::json all{{"context", {{"tauext", about}}}, {"benchmarks", nlohmann::json::array()}};
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

// SPDX-License-Identifier: Apache-2.0
#include "bench/python/scores.h"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <future>
#include <string>
#include <utility>
#include <vector>

#include "bench/outside/outside_score.h"
#include "bench/python/python_estimator.h"
#include "bench/python/robots.h"
#include "bench/roster/robots.h"
#include "bench/roster/threshold_file.h"
#include "bench/score/metric_list.h"
#include "bench/score/suite.h"
#include "bench/study/detection/calibration.h"
#include "bench/study/detection/detection_report.h"
#include "bench/study/detection/detection_study.h"

namespace tauext::python {

namespace py = pybind11;

namespace {

// values by key; a metric without a value ("never") is NaN
py::dict dict_of(const Score& score) {
  py::dict all;
  for (const auto& [key, value] : score.by_key()) all[py::str(key)] = value;
  return all;
}

py::dict scored(const Trace& run, const Output& estimates, const std::vector<bool>& marks,
                const Robot* robot, const std::string& scenario, double score_from) {
  if (estimates.tau_ext.cols() != run.size() || estimates.tau_ext.rows() != run.dof())
    throw std::invalid_argument(
        fmt::format("estimates of {} samples and {} joints, and the run has {} and {}",
                    estimates.tau_ext.cols(), estimates.tau_ext.rows(), run.size(), run.dof()));
  OutsideRun of{.trace = &run, .group = "run", .robot = robot, .score_from = score_from};
  if (robot != nullptr && !scenario.empty()) {
    of.scenario = &scenario_of(*robot, scenario);
    if (std::isnan(score_from)) of.score_from = of.scenario->score_from;
  }
  if (std::isnan(of.score_from)) of.score_from = 0;
  OutsideEstimates e{"estimates", marks.empty() ? "" : "detector", estimates};
  e.output.marks.assign(marks.begin(), marks.end());
  const Score score = score_outside(of, e).score;
  if (!score.error.empty()) throw std::invalid_argument(score.error);
  return dict_of(score);
}

std::vector<py::dict> suite(const Robot& robot, const std::vector<std::string>& estimators,
                            const std::vector<std::string>& detectors, const std::string& filter,
                            const std::string& degrade, std::uint64_t seed) {
  struct Scored {
    std::string name;
    Score score;
  };
  const auto all = unlocked([&] {
    const Degradation d = degradation_of(degrade, seed);
    Suite suite(
        {.sensors = d.sensors, .model_error = d.model_error, .recording = {.drives = d.drives}});
    const auto wanted = entry_filter(filter);
    std::vector<Scored> rows;
    for (const Entry& e : entries({&robot, estimators, detectors})) {
      if (wanted(e.name())) rows.push_back({e.name(), suite.score(e)});
    }
    if (rows.empty()) fail_no_match(filter);
    return rows;
  });
  std::vector<py::dict> rows;
  for (const auto& [name, score] : all) {
    py::dict row;
    row["name"] = name;
    row["error"] = score.error;
    row["metrics"] = score.error.empty() ? dict_of(score) : py::dict();
    rows.push_back(row);
  }
  return rows;
}

std::string study(const Robot& robot, const std::vector<std::string>& conditions,
                  const std::vector<std::string>& estimators,
                  const std::vector<std::string>& detectors, int collisions, int pushes,
                  int clampings, int regions, double hours, int training_runs, int jobs,
                  const py::object& progress) {
  study::StudyOptions o;
  o.robot = &robot, o.conditions = conditions;
  o.estimators = estimators, o.detectors = detectors;
  o.blows = collisions, o.brisk_pushes = pushes, o.clampings = clampings, o.regions = regions;
  o.hours = hours, o.threads = jobs;
  std::atomic<bool> stop = false;
  o.stop = [&] { return stop.load(); };
  if (!progress.is_none())
    o.progress = [&progress](double share) {
      const py::gil_scoped_acquire lock;
      progress(share);
    };
  // beside this thread, which is the one that Ctrl-C reaches
  auto work = std::async(std::launch::async, [&] {
    study::check_study(o);
    study::CalibrationOptions c;
    c.robot = o.robot, c.estimators = o.estimators, c.detectors = o.detectors;
    c.threads = o.threads, c.runs = training_runs;
    const Thresholds thresholds = study::calibrate_for(o.conditions, c);
    return study::study_json(study::touched_runs(o.robot), study::detection_study(o, thresholds),
                             thresholds);
  });
  const auto done = [&] {
    const py::gil_scoped_release free;
    return work.wait_for(std::chrono::milliseconds(100)) == std::future_status::ready;
  };
  while (!done()) stop = stop || PyErr_CheckSignals() != 0;
  if (stop) throw py::error_already_set();
  rethrow();
  return work.get();
}

}  // namespace

void bind_scores(py::module_& m) {
  m.def("metrics", [] {
    std::vector<py::dict> all;
    for (const MetricRow& r : kMetrics) {
      py::dict d;
      d["key"] = py::str(r.key.data(), r.key.size()),
      d["unit"] = py::str(r.unit.data(), r.unit.size());
      d["meaning"] = py::str(r.meaning.data(), r.meaning.size());
      d["better"] = r.better == Better::kLess   ? "less"
                    : r.better == Better::kMore ? "more"
                                                : "neither";
      all.push_back(d);
    }
    return all;
  });
  m.def("score", &scored);
  m.def("suite", &suite);
  m.def("study", &study);
  m.def("estimator", &add_maker);
}

}  // namespace tauext::python

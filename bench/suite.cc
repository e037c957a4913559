// SPDX-License-Identifier: Apache-2.0
#include "bench/suite.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <type_traits>

#include "bench/allocations.h"
#include "bench/metrics.h"

namespace tauext {
namespace {

// the largest of a metric over the joints (the smallest with less<>); NaN, which says "never", is worse
template <class Worse>
double worst(const Eigen::VectorXd& per_joint) {
  if (per_joint.hasNaN()) return std::numeric_limits<double>::quiet_NaN();
  return std::is_same_v<Worse, std::less<>> ? per_joint.minCoeff() : per_joint.maxCoeff();
}

// `key`_<unit> of every joint, with the joint's number, and the worst one without
template <class Worse = std::greater<>, class Metric>
void add_per_joint(int dof, const std::string& quantity, const std::string& unit, Score& score,
                   Metric&& metric) {
  Eigen::VectorXd values(dof);
  for (int j = 0; j < dof; ++j) {
    values[j] = metric(j);
    score.metrics[fmt::format("{}{}_{}", quantity, j + 1, unit)] = values[j];
  }
  score.metrics[quantity + "_" + unit] = worst<Worse>(values);
}

const char* name_of(Status s) {
  switch (s) {
    case Status::kOk:
      return "ok";
    case Status::kStarted:
      return "started";
    case Status::kBadMeasurement:
      return "bad measurement";
    case Status::kSingularInertia:
      return "singular inertia";
    case Status::kDiverged:
      return "diverged";
  }
  return "?";
}

double allocations_per_step(Runner& runner) {
  runner.batch();  // the first batch may fill caches of its own
  const auto before = allocations();
  runner.batch();
  return static_cast<double>(allocations() - before) / Runner::kBatch;
}

}  // namespace

std::string bad_status(const Trace& trace, const Output& out) {
  for (int k = 0; k < trace.size(); ++k) {
    if (!out.tau_ext.col(k).allFinite()) return fmt::format("not finite at t = {} s", trace.t[k]);
    const Status s = out.status[k];
    if (s == Status::kOk || (s == Status::kStarted && k == 0)) continue;
    return fmt::format("{} at t = {} s", name_of(s), trace.t[k]);
  }
  return "";
}

std::string failure(const Trace& ideal, const Output& out, double from) {
  if (std::string bad = bad_status(ideal, out); !bad.empty()) return bad;
  constexpr double kSlack = 5;  // [N m]
  for (int j = 0; j < ideal.dof(); ++j) {
    const auto truth = ideal.tau_ext.row(j);
    const double error = rmse(ideal.t, truth, out.tau_ext.row(j), from);
    const double guess = rmse(ideal.t, truth, Eigen::RowVectorXd::Zero(ideal.size()), from);
    if (error <= 1.5 * guess + kSlack) continue;
    return fmt::format(
        "wrong answer: {:.3g} N m rms on joint {}, where an estimate of 0 has {:.3g}", error, j + 1,
        guess);
  }
  return "";
}

std::string Entry::group() const {
  return robot + "/" + scenario;
}

std::string Entry::name() const {
  return group() + "/" + estimator + (detector.empty() ? "" : "+" + detector);
}

bool study_only(const std::string& detector) {
  constexpr const char* kStudyOnly[] = {"threshold", "dynamic_threshold", "high_pass", "band_pass",
                                        "cusum",     "clamping"};
  return std::count(std::begin(kStudyOnly), std::end(kStudyOnly), detector) > 0;
}

std::vector<Entry> entries() {
  std::vector<Entry> all;
  for (const Robot& r : robots()) {
    for (const Scenario& s : scenarios(r.name)) {
      for (const std::string& e : r.estimators) all.push_back({r.name, s.name, e, ""});
      if (s.response != Response::kDetection && s.response != Response::kLag) continue;
      for (const std::string& e : r.estimators) {
        if (is_baseline(e)) continue;
        for (const std::string& d : r.detectors) {
          if (!study_only(d)) all.push_back({r.name, s.name, e, d});
        }
      }
    }
  }
  return all;
}

std::optional<double> Score::get(const std::string& key) const {
  const auto it = metrics.find(key);
  return it == metrics.end() ? std::nullopt : std::optional(it->second);
}

void add_error_metrics(const Trace& trace, const Output& out, double from, Score& score) {
  const auto add = [&](const char* quantity, auto metric) {
    add_per_joint(trace.dof(), quantity, "Nm", score, [&](int j) {
      return metric(trace.t, trace.tau_ext.row(j), out.tau_ext.row(j), from);
    });
  };
  add("rmse", rmse);
  add("max", max_error);
  // of the joint that is worst
  double largest = -1;
  for (int j = 0; j < trace.dof(); ++j) {
    const double e = score.metrics.at(fmt::format("max{}_Nm", j + 1));
    if (!(e > largest)) continue;
    largest = e;
    score.metrics["max_at_s"] =
        time_of_max_error(trace.t, trace.tau_ext.row(j), out.tau_ext.row(j), from);
  }
  add_per_joint(trace.dof(), "bias", "Nm", score, [&](int j) {
    return std::abs(bias(trace.t, trace.tau_ext.row(j), out.tau_ext.row(j), from));
  });
}

void add_response_metrics(const Trace& trace, const Output& out, const Scenario& scenario,
                          Score& score) {
  const int n = trace.dof();
  if (scenario.response == Response::kStep) {
    std::vector<StepResponse> r;
    for (int j = 0; j < n; ++j) {
      r.push_back(step_response(trace.t, trace.tau_ext.row(j), out.tau_ext.row(j)));
    }
    add_per_joint(n, "rise", "s", score, [&](int j) { return r[j].rise; });
    add_per_joint(n, "rise_0_90", "s", score, [&](int j) { return r[j].rise_0_90; });
    add_per_joint(n, "settling", "s", score, [&](int j) { return r[j].settling; });
    add_per_joint(n, "overshoot", "percent", score, [&](int j) { return r[j].overshoot; });
    add_per_joint(n, "final", "Nm", score, [&](int j) {
      return std::abs(final_error(trace.t, trace.tau_ext.row(j), out.tau_ext.row(j)));
    });
  }
  if (scenario.response == Response::kLag) {
    add_per_joint(n, "lag", "s", score, [&](int j) {
      return lag(trace.t, trace.tau_ext.row(j), out.tau_ext.row(j), scenario.score_from);
    });
  }
  if (scenario.response == Response::kBandwidth) {
    add_per_joint<std::less<>>(n, "bandwidth", "rad_s", score, [&](int j) {
      return bandwidth(trace.t, trace.tau_ext.row(j), out.tau_ext.row(j));
    });
  }
}

void add_detection_metrics(const Trace& trace, const Output& out, Score& score) {
  if (out.marks.empty() || trace.contact.empty()) return;
  const DetectionScore d = detection_score(trace.t, trace.contact, out.marks);
  if (d.collisions > 0) {
    score.metrics["delay_s"] = d.delay;
    score.metrics["recall"] = static_cast<double>(d.detected) / d.collisions;
  }
  score.metrics["false_alarms"] = d.false_alarms;
  score.metrics["false_alarms_per_hour"] = d.false_alarms_per_hour;
}

void add_reaction_metrics(const Trace& stopped, const Trace& free, Score& score) {
  score.metrics["overtravel_rad"] = overtravel(stopped);
  score.metrics["peak_N"] = peak(stopped.contact_force);
  score.metrics["peak_unstopped_N"] = peak(free.contact_force);
}

bool Suite::closed_loop(const Entry& e) {
  return !e.detector.empty() && scenario(e.robot, e.scenario).reacts;
}

DetectorSettings Suite::settings(const Entry& e) const {
  const ThresholdSet set = options_.thresholds.of(e.robot, options_.sensors.velocity_noise);
  const auto known = set.by_estimator.find(e.estimator);
  return {.thresholds = known == set.by_estimator.end() ? DetectorThresholds{} : known->second};
}

const Suite::Traces& Suite::traces(const Entry& e) {
  const std::string key = closed_loop(e) ? e.name() : e.group();
  const auto it = traces_.find(key);
  if (it != traces_.end()) return it->second;
  Traces t;
  const Scenario& s = scenario(e.robot, e.scenario);
  t.ideal = simulate(
      load_for(e.robot, s, options_.model_error), s, options_.recording, options_.sensors,
      closed_loop(e) ? robot(e.robot).supervisor(e.estimator, e.detector, settings(e)) : nullptr);
  Sensors sensors = options_.sensors;
  if (sensors.ideal()) sensors.velocity_noise = options_.noise_probe;
  t.noisy = measure(t.ideal, sensors);
  return traces_.emplace(key, std::move(t)).first->second;
}

const Trace& Suite::scored(const Entry& e) {
  return options_.sensors.ideal() ? traces(e).ideal : traces(e).noisy;
}

std::unique_ptr<Runner> Suite::runner(const Entry& e) {
  return robot(e.robot).runner(e.estimator, e.detector, scored(e), settings(e));
}

Suite::Run Suite::run(const Entry& e) {
  Run r{scored(e), runner(e)->run(), {}};
  if (!e.detector.empty()) {
    r.detections = robot(e.robot).detect(e.detector, r.trace, r.output, settings(e));
  }
  return r;
}

Score Suite::score(const Entry& e) {
  const Scenario& s = scenario(e.robot, e.scenario);
  const Robot& r = robot(e.robot);
  const Traces& recorded = traces(e);
  const auto ideal_runner = r.runner(e.estimator, e.detector, recorded.ideal, settings(e));
  const Output ideal = ideal_runner->run();
  const Output noisy = r.runner(e.estimator, e.detector, recorded.noisy, settings(e))->run();

  Score score;
  // with a wrong model an estimate may be as wrong as that: then it only has to be one
  score.error = options_.model_error.none() ? failure(recorded.ideal, ideal, s.score_from)
                                            : bad_status(recorded.ideal, ideal);
  if (const std::string bad = bad_status(recorded.noisy, noisy);
      score.error.empty() && !bad.empty()) {
    score.error = "under sensor noise: " + bad;
  }
  const Trace& trace = scored(e);
  const Output& out = options_.sensors.ideal() ? ideal : noisy;
  add_error_metrics(trace, out, s.score_from, score);
  add_response_metrics(trace, out, s, score);
  add_detection_metrics(trace, out, score);
  if (closed_loop(e)) {
    Entry free = e;
    free.detector = "";
    add_reaction_metrics(recorded.ideal, traces(free).ideal, score);
  }
  if (ideal.status.size() == noisy.status.size()) {  // else samples were dropped
    add_per_joint(r.dof, "noise", "Nm", score, [&](int j) {
      return noise(trace.t, ideal.tau_ext.row(j), noisy.tau_ext.row(j), s.score_from);
    });
  }
  if (allocations_are_counted()) score.metrics["allocs"] = allocations_per_step(*ideal_runner);
  return score;
}

}  // namespace tauext

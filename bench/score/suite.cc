// SPDX-License-Identifier: Apache-2.0
#include "bench/score/suite.h"

#include <fmt/format.h>

#include <cmath>
#include <ctime>
#include <stdexcept>
#include <utility>

#include "bench/kit/allocations.h"
#include "bench/roster/session/soundness.h"
#include "bench/roster/threshold_file.h"
#include "bench/score/detection_metrics.h"
#include "bench/score/metrics.h"

namespace tauext {
namespace {

double allocations_per_step(Runner runner) {
  runner.batch();  // the first batch may fill caches of its own
  const auto before = allocations();
  runner.batch();
  return static_cast<double>(allocations() - before) / Runner::kBatch;
}

// why there is no truth to score by
struct NotRecorded : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// [N m] a joint that carries next to nothing is disturbed by those that carry much
Eigen::VectorXd slack(const Robot& r) {
  return Eigen::VectorXd::Constant(r.dof(), r.small_torque().maxCoeff());
}

}  // namespace

double batch_seconds(Runner& runner) {
  const auto spent = [] {
    std::timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  };
  const double from = spent();
  runner.batch();
  return spent() - from;
}

std::string bad_status(const Trace& trace, const Output& out) {
  Soundness soundness(out.counts);
  for (int k = 0; k < trace.size(); ++k)
    soundness.look(trace.t[k], out.status[k], out.tau_ext.col(k).allFinite());
  return soundness.why(trace.size());
}

std::string failure(const Trace& ideal, const Output& out, double from,
                    const Eigen::VectorXd& slack) {
  if (std::string bad = bad_status(ideal, out); !bad.empty()) return bad;
  for (int j = 0; j < ideal.dof(); ++j) {
    const auto truth = ideal.tau_ext.row(j);
    const double error = metrics::rmse(ideal.t, truth, out.tau_ext.row(j), from);
    const double guess =
        metrics::rmse(ideal.t, truth, Eigen::RowVectorXd::Zero(ideal.size()), from);
    if (error <= 1.5 * guess + slack[j]) continue;
    return fmt::format(
        "wrong answer: {:.3g} N m rms on joint {}, where an estimate of 0 has {:.3g}", error, j + 1,
        guess);
  }
  return "";
}

Suite::Truth::Truth(const Entry& e)
    : robot(&e.robot()),
      scenario(&e.scenario()),
      estimator(e.closed_loop() ? e.estimator() : ""),
      detector(e.closed_loop() ? e.detector() : "") {}

DetectorSettings Suite::settings(const Entry& e) const {
  return {.thresholds = trained_for(options_.thresholds, e.robot(),
                                    sensors_for(e.scenario(), options_.sensors).velocity_noise,
                                    e.estimator(), e.detector())};
}

void Suite::set_sensors(const Sensors& sensors) {
  std::erase_if(ideal_, [](const auto& kept) { return kept.first.closed_loop(); });
  std::erase_if(of_ideal_, [](const auto& kept) { return kept.first.first.closed_loop(); });
  if (sensors.ideal() != options_.sensors.ideal()) of_ideal_.clear();  // others are scored now
  noisy_.clear();
  of_noisy_.clear();
  scores_.clear();
  options_.sensors = sensors;
}

const Trace& Suite::ideal(const Entry& e) {
  const Truth key(e);
  const auto it = ideal_.find(key);
  if (it != ideal_.end()) return it->second;
  const Scenario& s = e.scenario();
  Supervisor supervisor;
  if (e.closed_loop()) {
    supervisor =
        e.robot().supervisor(e.estimator(), e.detector(), options_.recording.drives, settings(e));
  }
  Trace truth = [&] {
    try {
      return simulate(e.robot().load_for(s, options_.model_error), s, options_.recording,
                      sensors_for(s, options_.sensors), supervisor);
    } catch (const std::exception& why) {
      throw NotRecorded(fmt::format("cannot be recorded: {}", why.what()));
    }
  }();
  const bool elastic = truth.motor_q.cols() > 0;  // encoders are on the motors' side
  return ideal_.emplace(key, elastic ? measure(truth, {}) : std::move(truth)).first->second;
}

const Trace& Suite::noisy(const Entry& e) {
  const Truth key(e);
  const auto it = noisy_.find(key);
  if (it != noisy_.end()) return it->second;
  Sensors sensors = sensors_for(e.scenario(), options_.sensors);
  if (sensors.ideal()) sensors.velocity_noise = options_.noise_probe;
  return noisy_.emplace(key, measure(ideal(e), sensors)).first->second;
}

const Output& Suite::estimate(const Entry& e, const Trace& trace, Outputs& made) {
  const std::pair key(Truth(e), e.estimator());
  for (Outputs* all : {&of_ideal_, &of_noisy_})
    if (!all->empty() && all->begin()->first.first.scenario != key.first.scenario) all->clear();
  const auto it = made.find(key);
  return it != made.end() ? it->second
                          : made.emplace(key, e.robot().run(e.estimator(), trace)).first->second;
}

void Suite::add_force_metric(const Entry& e, const Output& out, Score& to) {
  const Trace& trace = scored(e);
  if (trace.force.cols() == 0) return;
  auto& arm = forces_[&e.robot()];
  if (!arm) arm = e.robot().forces_at(kEndEffector, false);
  const double rmse = metrics::force_rmse(*arm, trace, out.tau_ext, e.scenario().score_from);
  if (!std::isnan(rmse)) to.set(Metric::kForce, rmse);
}

bool Suite::is_ideal(const Entry& e) const {
  return sensors_for(e.scenario(), options_.sensors).ideal();
}

const Trace& Suite::scored(const Entry& e) {
  return is_ideal(e) ? ideal(e) : noisy(e);
}

Pair Suite::pair(const Entry& e, const Trace& trace) const {
  return e.robot().pair(e.estimator(), e.detector(), trace, settings(e));
}

Runner Suite::runner(const Entry& e) {
  return {pair(e, scored(e)), scored(e)};
}

Suite::Run Suite::run(const Entry& e) {
  Run r{scored(e), pair(e, scored(e)).run(scored(e)), {}};
  if (!e.detector().empty()) {
    r.detections = e.robot().detect(e.detector(), r.trace, r.output, settings(e));
  }
  return r;
}

// with a wrong model an estimate may be as wrong as that: then it only has to be one
std::string Suite::error(const Entry& e, const Output& of_ideal, const Output& of_noisy) {
  const std::string bad =
      error_for(e.scenario(), options_.model_error).none()
          ? failure(ideal(e), of_ideal, e.scenario().score_from, slack(e.robot()))
          : bad_status(ideal(e), of_ideal);
  if (!bad.empty()) return bad;
  const std::string rejected = bad_status(noisy(e), of_noisy);
  return rejected.empty() ? "" : "under sensor noise: " + rejected;
}

const Score& Suite::of_estimator(const Entry& e) {
  const Output& of_ideal = estimate(e, ideal(e), of_ideal_);
  const Output& of_noisy = estimate(e, noisy(e), of_noisy_);
  const auto [kept, is_new] = scores_.try_emplace({Truth(e), e.estimator()});
  Score& score = kept->second;
  if (!is_new) return score;
  const Output& out = is_ideal(e) ? of_ideal : of_noisy;
  const Trace& trace = scored(e);
  const Scenario& s = e.scenario();
  score.error = error(e, of_ideal, of_noisy);
  score.counts = out.counts;
  score.set(Metric::kLeftOut, static_cast<double>(out.counts.left_out()));
  add_error_metrics(trace, out, s.score_from, score);
  add_force_metric(e, out, score);
  add_noise_metric(trace, of_ideal, of_noisy, s.score_from, score);
  add_response_metrics(trace, out, s, score);
  return score;
}

Score Suite::score(const Entry& e) {
  try {
    ideal(e);
  } catch (const NotRecorded& why) {  // it costs its own rows
    Score none;
    none.error = why.what();
    return none;
  }
  Score score = of_estimator(e);
  if (!e.detector().empty()) {
    const Trace& trace = scored(e);
    Output out = estimate(e, trace, is_ideal(e) ? of_ideal_ : of_noisy_);
    const std::vector<Detection> all = e.robot().detect(e.detector(), trace, out, settings(e));
    for (const Detection& d : all) out.marks.push_back(d.mark);
    add_detection_metrics(trace, out, score);
    add_score_metrics(all, score);
  }
  if (e.closed_loop()) {
    add_reaction_metrics(ideal(e), ideal(e.with_detector("")), score);
  }
  if (allocations_are_counted())
    score.set(Metric::kAllocs, allocations_per_step({pair(e, ideal(e)), ideal(e)}));
  return score;
}

}  // namespace tauext

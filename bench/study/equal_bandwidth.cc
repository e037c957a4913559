// SPDX-License-Identifier: Apache-2.0
#include "bench/study/equal_bandwidth.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "bench/roster/robots.h"
#include "bench/score/metric_list.h"
#include "bench/score/metrics.h"
#include "bench/score/parallel.h"
#include "bench/score/suite.h"
#include "bench/score/table.h"
#include "mjcf/record.h"

namespace tauext::study {
namespace {

constexpr double kSettled = 3;  // [s] the start is over

constexpr const char* kBandwidthLegend =
    R"(bandwidth: where the gain of the slowest joint falls to -3 dB in `chirp`; design: the parameter
`bandwidth` that gives it. noise: what a velocity noise of 1e-3 rad/s and an encoder of 17 bits
add. lag: how far the estimate is behind `sine`. rise 0-90 %, overshoot: the answer to `step`. mass:
mean error if the last link is 5 % heavier than the model says. friction: rms error under
{} that the model does not know.
step: CPU time. Every figure is that of the worst joint.
)";
constexpr double kNear = 0.05;  // of the bandwidth that is asked for
constexpr const char* kFar =
    "!: the bandwidth is more than 5 % off, and no design comes nearer; compare this row with "
    "care.\n";
constexpr const char* kNever = "never: no design comes within 25 % of this bandwidth.\n";

void require_scenarios(const Robot& r, const std::vector<std::string>& wanted) {
  std::vector<std::string> lacks = wanted;
  for (const Scenario& s : r.scenarios()) std::erase(lacks, s.name);
  if (lacks.empty()) return;
  throw std::invalid_argument(fmt::format("this study needs the scenarios {}; {} lacks {}",
                                          fmt::join(wanted, ", "), r.name(),
                                          fmt::join(lacks, ", ")));
}

Trace run_of(const Robot& r, const char* name, const ModelError& error = {}) {
  const Scenario& s = scenario_of(r, name);
  return simulate(r.load_for(s, error), s);
}

Output estimate(const Robot& r, const std::string& specification, const Trace& t) {
  return r.run(specification, t);
}

// the runs that all estimators share
struct SharedRuns : StepRuns {
  explicit SharedRuns(const Robot& r)
      : StepRuns(r),
        chirp(run_of(r, "chirp")),
        sine(run_of(r, "sine")),
        heavy(run_of(r, "free", {.mass = 1.05})),
        rubbing(run_of(r, "free", r.hidden_friction())) {}

  Trace chirp, sine, heavy, rubbing;
};

double value(const Score& score, Metric metric) {
  return score.get(metric).value_or(kNoValue);
}

// what the scenario of this run asks for
Score response_of(const Robot& r, const std::string& specification, const char* name,
                  const Trace& t) {
  Score score;
  add_response_metrics(t, estimate(r, specification, t), scenario_of(r, name), score);
  return score;
}

Score errors_of(const Robot& r, const std::string& specification, const Trace& t) {
  Score score;
  add_error_metrics(t, estimate(r, specification, t), kSettled, score);
  return score;
}

double measured_bandwidth(const SharedRuns& runs, const std::string& specification) {
  return value(response_of(runs.robot, specification, "chirp", runs.chirp), Metric::kBandwidth);
}

double measured_cpu(const SharedRuns& runs, const std::string& specification) {
  Runner runner(runs.robot.pair(specification, "", runs.free), runs.free);
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 200; ++i) best = std::min(best, batch_seconds(runner));
  return 1e9 * best / Runner::kBatch;
}

Worth worth_of(const SharedRuns& runs, const std::string& specification) {
  const Robot& r = runs.robot;
  Worth w;
  static_cast<NoiseAndDelay&>(w) = noise_and_delay(runs, specification);
  w.bandwidth = measured_bandwidth(runs, specification);
  w.lag = value(response_of(r, specification, "sine", runs.sine), Metric::kLag);
  w.mass_bias = value(errors_of(r, specification, runs.heavy), Metric::kBias);
  w.friction_rms = value(errors_of(r, specification, runs.rubbing), Metric::kRmse);
  return w;
}

// the design whose measured bandwidth comes nearest to w, within 25 %: the secant method in the
// logarithms, bisection once w lies between two designs. A bandwidth may jump over w where coupled
// joints hold the gain near -3 dB.
std::optional<double> design_for(const SharedRuns& runs, const std::string& estimator, double w) {
  double x = std::log(w), best_x = x, best_f = std::log(1.25);
  std::optional<double> slow, fast;  // designs on either side
  bool found = false;
  for (int i = 0; i < 12; ++i) {
    const double f = std::log(measured_bandwidth(runs, at_bandwidth(estimator, std::exp(x))) / w);
    if (std::abs(f) < best_f) {
      found = true;
      best_f = std::abs(f);
      best_x = x;
    }
    if (best_f < 0.01) break;
    if (std::isnan(f)) {
      x += x > std::log(w) ? -0.5 : 0.5;  // too slow or too fast to be seen by the chirp
      continue;
    }
    (f < 0 ? slow : fast) = x;
    x = slow && fast ? (*slow + *fast) / 2 : x - std::clamp(1.2 * f, -1.5, 1.5);
    if (x < std::log(0.01) || x > std::log(1e4)) break;
  }
  return found ? std::optional(std::exp(best_x)) : std::nullopt;
}

bool is_far(const AtBandwidth& r, double w) {
  return r.worth && std::abs(r.worth->bandwidth / w - 1) > kNear;
}

std::vector<std::string> cells_of(const AtBandwidth& r, bool marked) {
  if (!r.worth) return {r.estimator, "-", "never", "-", "-", "-", "-", "-", "-", "-"};
  const Worth& x = *r.worth;
  return {r.estimator,
          fmt::format("{:.1f}", r.design),
          fmt::format("{:.1f}{}", x.bandwidth, marked ? "!" : ""),
          fmt::format("{:.3f}", x.noise),
          milliseconds(x.lag),
          milliseconds(x.rise_0_90),
          fmt::format("{:.1f}", x.overshoot),
          fmt::format("{:.2f}", x.mass_bias),
          fmt::format("{:.2f}", x.friction_rms),
          fmt::format("{:.0f}", x.cpu_ns)};
}

}  // namespace

StepRuns::StepRuns(const Robot& r) : robot(r) {
  require_scenarios(r, {"step", "free"});
  step = run_of(r, "step");
  free = run_of(r, "free");
  noisy = measure(free, {.velocity_noise = 1e-3, .encoder_step = 4.8e-5});
}

NoiseAndDelay noise_and_delay(const StepRuns& runs, const std::string& specification) {
  const Robot& r = runs.robot;
  Score score = response_of(r, specification, "step", runs.step);
  tauext::add_noise_metric(runs.free, estimate(r, specification, runs.free),
                           estimate(r, specification, runs.noisy), kSettled, score);
  NoiseAndDelay x;
  x.noise = value(score, Metric::kNoise);
  x.rise_0_90 = value(score, Metric::kRise0To90);
  x.overshoot = value(score, Metric::kOvershoot);
  x.settling = value(score, Metric::kSettling);
  return x;
}

std::vector<std::string> tunable_of(const Robot& r, const std::vector<std::string>& asked) {
  const std::vector<std::string> all = r.tunable();
  if (asked.empty()) return all;
  std::vector<std::string> chosen;
  for (const std::string& e : asked) {
    r.check(e, "");
    if (key_of(e, "bandwidth"))
      throw std::invalid_argument(fmt::format("{}: the study sets its bandwidth", e));
    if (std::count(all.begin(), all.end(), name_of_specification(e)) > 0) chosen.push_back(e);
  }
  return chosen;
}

std::vector<AtBandwidth> at_equal_bandwidth(const Robot& r, double w, int threads,
                                            const std::function<void(double)>& progress,
                                            const std::vector<std::string>& asked) {
  if (!(w >= 1 && w <= 200)) {
    throw std::invalid_argument(
        fmt::format("a bandwidth of {} rad/s: 1 to 200 can be measured", w));
  }
  require_scenarios(r, {"chirp", "step", "sine", "free"});
  std::vector<AtBandwidth> rows;
  for (const std::string& e : tunable_of(r, asked)) rows.push_back({.estimator = e});
  if (rows.empty())
    throw std::invalid_argument(fmt::format(
        "no estimator with the key bandwidth; these have it: {}", fmt::join(r.tunable(), ", ")));
  const SharedRuns runs(r);
  const auto work = [&](int i) {
    AtBandwidth& row = rows[static_cast<std::size_t>(i)];
    const auto design = design_for(runs, row.estimator, w);
    if (!design) return;
    row.design = *design;
    row.worth = worth_of(runs, at_bandwidth(row.estimator, *design));
  };
  parallel_for(static_cast<int>(rows.size()), threads, work, progress);
  for (AtBandwidth& row : rows) {  // one after the other, for the clock
    if (row.worth) row.worth->cpu_ns = measured_cpu(runs, at_bandwidth(row.estimator, row.design));
  }
  return rows;
}

std::string format_equal_bandwidth(const Robot& r, double w, const std::vector<AtBandwidth>& rows,
                                   TableFormat format) {
  TableWriter table({{"estimator", "", true},
                     {"design", "rad/s"},
                     {title_of(Metric::kBandwidth), "rad/s"},
                     {title_of(Metric::kNoise), "N m"},
                     {title_of(Metric::kLag), "ms"},
                     {title_of(Metric::kRise0To90), "ms"},
                     {title_of(Metric::kOvershoot), "%"},
                     {"mass", "N m"},
                     {"friction", "N m"},
                     {"step", "ns"}});
  const bool text = format == TableFormat::kText;
  for (const AtBandwidth& row : rows) table.add(cells_of(row, text && is_far(row, w)));
  if (!text) return table.format(format);
  const bool all =
      std::all_of(rows.begin(), rows.end(), [](const AtBandwidth& x) { return bool(x.worth); });
  const bool far =
      std::any_of(rows.begin(), rows.end(), [&](const AtBandwidth& x) { return is_far(x, w); });
  return fmt::format("{}, every estimator at {:g} rad/s\n{}{}{}{}", r.name(), w, table.format(),
                     fmt::format(kBandwidthLegend, r.hidden_friction_in_words()), far ? kFar : "",
                     all ? "" : kNever);
}

}  // namespace tauext::study

// SPDX-License-Identifier: Apache-2.0
#include "bench/bandwidth_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <map>
#include <stdexcept>

#include "bench/metrics.h"
#include "bench/parallel.h"
#include "bench/robot.h"

namespace tauext {
namespace {

constexpr const char* kRobot = "wallmobot3";
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// the runs that all estimators share
struct Runs {
  Trace chirp, step, sine, free, noisy, heavy, rubbing;

  Runs() {
    const auto run = [](const char* name, const ModelError& error = {}) {
      const Scenario& s = scenario(kRobot, name);
      return simulate(load_for(kRobot, s, error), s);
    };
    chirp = run("chirp"), step = run("step"), sine = run("sine"), free = run("free");
    noisy = measure(free, {.velocity_noise = 1e-3, .encoder_step = 4.8e-5});
    heavy = run("free", {.mass = 1.05});
    rubbing = run("free", {.friction = 5});
  }
};

const Runs& runs() {
  static const Runs all;
  return all;
}

using MakeRunner = std::function<std::unique_ptr<Runner>(const Trace&)>;

MakeRunner tuned(const std::string& estimator, double w) {
  return [=](const Trace& t) { return robot(kRobot).tuned(estimator, w, t); };
}

MakeRunner as_is(const std::string& estimator) {
  return [=](const Trace& t) { return robot(kRobot).runner(estimator, "", t); };
}

// the largest of a metric (truth, estimate) -> double over the joints; NaN if one has none
template <class Metric>
double worst(const Trace& t, const Output& out, Metric&& metric) {
  double largest = -std::numeric_limits<double>::infinity();
  for (int j = 0; j < t.dof(); ++j) {
    const double value = metric(t.tau_ext.row(j), out.tau_ext.row(j));
    if (std::isnan(value)) return kNaN;
    largest = std::max(largest, value);
  }
  return largest;
}

double measured_bandwidth(const MakeRunner& make) {
  const Trace& t = runs().chirp;
  const Output out = make(t)->run();
  return -worst(t, out, [&](const auto& x, const auto& y) { return -bandwidth(t.t, x, y); });
}

double measured_noise(const MakeRunner& make) {
  const Trace& t = runs().free;
  const Output ideal = make(t)->run(), noisy = make(runs().noisy)->run();
  return worst(t, ideal, [&, j = 0](const auto&, const auto& x) mutable {
    return noise(t.t, x, noisy.tau_ext.row(j++), 3);
  });
}

StepResponse worst_step(const MakeRunner& make) {
  const Trace& t = runs().step;
  const Output out = make(t)->run();
  StepResponse r{};
  r.rise_0_90 = worst(
      t, out, [&](const auto& x, const auto& y) { return step_response(t.t, x, y).rise_0_90; });
  r.overshoot = worst(
      t, out, [&](const auto& x, const auto& y) { return step_response(t.t, x, y).overshoot; });
  return r;
}

double cpu_seconds() {
  std::timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double measured_cpu(const MakeRunner& make) {
  const auto runner = make(runs().free);
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 200; ++i) {
    const double start = cpu_seconds();
    runner->batch();
    best = std::min(best, cpu_seconds() - start);
  }
  return 1e9 * best / Runner::kBatch;
}

Worth worth_of(const MakeRunner& make) {
  const auto of = [&](const Trace& t, auto metric) { return worst(t, make(t)->run(), metric); };
  Worth w;
  w.bandwidth = measured_bandwidth(make);
  w.noise = measured_noise(make);
  const Trace &sine = runs().sine, &heavy = runs().heavy, &rubbing = runs().rubbing;
  w.lag = of(sine, [&](const auto& x, const auto& y) { return lag(sine.t, x, y, 3); });
  const StepResponse step = worst_step(make);
  w.rise_0_90 = step.rise_0_90;
  w.overshoot = step.overshoot;
  w.mass_bias =
      of(heavy, [&](const auto& x, const auto& y) { return std::abs(bias(heavy.t, x, y, 3)); });
  w.friction_rms =
      of(rubbing, [&](const auto& x, const auto& y) { return rmse(rubbing.t, x, y, 3); });
  return w;
}

// the design whose measured bandwidth comes nearest to w, within 25 %: the secant method in the
// logarithms, bisection once w lies between two designs. A bandwidth may jump over w where coupled
// joints hold the gain near -3 dB.
std::optional<double> design_for(const std::string& estimator, double w) {
  double x = std::log(w), best_x = x, best_f = std::log(1.25);
  std::optional<double> slow, fast;  // designs on either side
  bool found = false;
  for (int i = 0; i < 12; ++i) {
    const double f = std::log(measured_bandwidth(tuned(estimator, std::exp(x))) / w);
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

// noise of a front at a delay, on straight lines in the logarithms; its slowest point's if the delay is
// longer, NaN if it is shorter than any
double noise_at(const std::vector<const ParetoPoint*>& front, double delay) {
  for (std::size_t i = 1; i < front.size(); ++i) {
    const ParetoPoint &a = *front[i - 1], &b = *front[i];
    if (!(delay >= std::min(a.delay, b.delay) && delay <= std::max(a.delay, b.delay))) continue;
    const double share =
        a.delay == b.delay ? 0 : std::log(delay / a.delay) / std::log(b.delay / a.delay);
    return a.noise * std::pow(b.noise / a.noise, share);
  }
  return !front.empty() && front.back()->delay <= delay ? front.back()->noise : kNaN;
}

}  // namespace

std::vector<AtBandwidth> at_equal_bandwidth(double w, int threads,
                                            const std::function<void(double)>& progress) {
  if (!(w >= 1 && w <= 200)) {
    throw std::invalid_argument(
        fmt::format("a bandwidth of {} rad/s: 1 to 200 can be measured", w));
  }
  runs();
  const std::vector<std::string>& names = robot(kRobot).tunable;
  std::vector<AtBandwidth> rows(names.size());
  const auto work = [&](int i) {
    rows[i].estimator = names[i];
    const auto design = design_for(names[i], w);
    if (!design) return;
    rows[i].design = *design;
    rows[i].worth = worth_of(tuned(names[i], *design));
  };
  parallel_for(static_cast<int>(names.size()), threads, work, progress);
  for (AtBandwidth& row : rows) {  // one after the other, for the clock
    if (row.worth) row.worth->cpu_ns = measured_cpu(tuned(row.estimator, row.design));
  }
  return rows;
}

std::vector<ParetoPoint> pareto(int threads, const std::function<void(double)>& progress) {
  runs();
  std::vector<ParetoPoint> points;
  const Robot& r = robot(kRobot);
  for (const std::string& e : r.tunable) {
    for (const double w : {3., 6., 12., 25., 50., 100., 200., 400.}) points.push_back({e, w});
  }
  for (const std::string& e : r.estimators) {
    if (!is_baseline(e)) points.push_back({e, 0});
  }
  const auto work = [&](int i) {
    ParetoPoint& p = points[i];
    const MakeRunner make = p.design > 0 ? tuned(p.estimator, p.design) : as_is(p.estimator);
    p.noise = measured_noise(make);
    p.delay = worst_step(make).rise_0_90;
  };
  parallel_for(static_cast<int>(points.size()), threads, work, progress);
  mark_dominated(points);
  return points;
}

void mark_dominated(std::vector<ParetoPoint>& points) {
  std::map<std::string, std::vector<const ParetoPoint*>> fronts;
  for (const ParetoPoint& p : points) {
    const bool measured = std::isfinite(p.delay) && std::isfinite(p.noise) && p.delay > 0;
    if (p.design > 0 && measured) fronts[p.estimator].push_back(&p);
  }
  for (auto& [name, front] : fronts) {
    std::sort(front.begin(), front.end(),
              [](const auto* a, const auto* b) { return a->delay < b->delay; });
  }
  for (ParetoPoint& p : points) {
    double quietest = p.noise / 1.02;
    for (const auto& [name, front] : fronts) {
      const double rival = noise_at(front, p.delay);
      if (name == p.estimator || !(rival < quietest)) continue;
      quietest = rival;
      p.dominated_by = name;
      p.excess = p.noise / rival - 1;
    }
  }
}

std::string format_equal_bandwidth(double w, const std::vector<AtBandwidth>& rows) {
  std::string out = fmt::format(
      "wallmobot3, every estimator at {:g} rad/s (-3 dB of its slowest joint in `chirp`)\n"
      "{:<18} {:>8} {:>9} {:>8} {:>7} {:>8} {:>10} {:>9} {:>9} {:>7}\n"
      "{:<18} {:>8} {:>9} {:>8} {:>7} {:>8} {:>10} {:>9} {:>9} {:>7}\n",
      w, "estimator", "design", "bandwidth", "noise", "lag", "to 90 %", "overshoot", "mass 5 %",
      "friction", "step", "", "rad/s", "rad/s", "N m", "ms", "ms", "%", "bias N m", "rms N m",
      "ns");
  for (const AtBandwidth& r : rows) {
    if (!r.worth) {
      out += fmt::format("{:<18} does not reach it\n", r.estimator);
      continue;
    }
    const Worth& x = *r.worth;
    out += fmt::format(
        "{:<18} {:>8.1f} {:>9.1f} {:>8.3f} {:>7.0f} {:>8.0f} {:>10.1f} {:>9.2f} {:>9.2f} "
        "{:>7.0f}\n",
        r.estimator, r.design, x.bandwidth, x.noise, 1e3 * x.lag, 1e3 * x.rise_0_90, x.overshoot,
        x.mass_bias, x.friction_rms, x.cpu_ns);
  }
  return out +
         "noise: from velocity noise of 1e-3 rad/s and an encoder of 17 bits. lag: behind `sine`. "
         "to 90 %:\n"
         "of `step`. mass: the last link weighs 5 % more than believed. friction: 5 N m of it that "
         "nobody\n"
         "told. Worst joint of each.\n";
}

std::string format_pareto(const std::vector<ParetoPoint>& points) {
  std::string out = fmt::format(
      "wallmobot3: noise against delay, worst joint; design 0 is the roster's own tuning\n"
      "{:<18} {:>8} {:>9} {:>9}\n{:<18} {:>8} {:>9} {:>9}\n",
      "estimator", "design", "delay", "noise", "", "rad/s", "ms", "N m");
  std::string before;
  for (const ParetoPoint& p : points) {
    if (p.estimator != before && !before.empty() && p.design > 0) out += "\n";
    before = p.estimator;
    const std::string verdict =
        p.dominated_by.empty()
            ? "on the front"
            : fmt::format("{:.0f} % noisier than {}", 100 * p.excess, p.dominated_by);
    out += fmt::format("{:<18} {:>8g} {:>9.1f} {:>9.3f}  {}\n", p.estimator, p.design,
                       1e3 * p.delay, p.noise, verdict);
  }
  return out +
         "delay: to 90 % of `step`. noise: from velocity noise of 1e-3 rad/s and an encoder of 17 "
         "bits. A\n"
         "point is dominated where another estimator is as quick and at least 2 % quieter; named "
         "is the\n"
         "quietest.\n";
}

}  // namespace tauext

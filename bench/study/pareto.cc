// SPDX-License-Identifier: Apache-2.0
#include "bench/study/pareto.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "bench/roster/baselines.h"
#include "bench/score/metric_list.h"
#include "bench/score/parallel.h"
#include "bench/score/table.h"

namespace tauext::study {
namespace {

constexpr double kMargin = 1.02;  // less than this factor of noise is no difference

constexpr const char* kParetoLegend =
    R"(settling: until the estimate of `step` stays within 2 %. rise 0-90 %, overshoot: its way there. noise:
what a velocity noise of 1e-3 rad/s and an encoder of 17 bits add. A point is behind the front if
another one settles as quickly and is at least 2 % quieter; the quietest of these is named. An
estimate that never settles is not compared. Every figure is that of the worst joint.
)";

using Front = std::vector<const ParetoPoint*>;  // of one estimator, by settling time

// the least noise of a front that settles within so many seconds; infinite if it never does
double noise_of_points(const Front& front, double settling) {
  double least = std::numeric_limits<double>::infinity();
  for (const ParetoPoint* p : front) {
    if (p->value.settling <= settling) least = std::min(least, p->value.noise);
  }
  return least;
}

// the same with straight lines in the logarithms between its points
double noise_within(const Front& front, double settling) {
  double least = noise_of_points(front, settling);
  for (std::size_t i = 1; i < front.size(); ++i) {
    const NoiseAndDelay &a = front[i - 1]->value, &b = front[i]->value;
    if (!(a.settling < settling && settling < b.settling)) continue;
    const double share = std::log(settling / a.settling) / std::log(b.settling / a.settling);
    least = std::min(least, a.noise * std::pow(b.noise / a.noise, share));
  }
  return least;
}

std::map<std::string, Front> fronts_of(const std::vector<ParetoPoint>& points) {
  std::map<std::string, Front> fronts;
  for (const ParetoPoint& p : points) {
    if (p.design > 0 && p.has_value()) fronts[p.estimator].push_back(&p);
  }
  for (auto& [name, front] : fronts) {
    std::sort(front.begin(), front.end(),
              [](const auto* a, const auto* b) { return a->value.settling < b->value.settling; });
  }
  return fronts;
}

std::string verdict(const ParetoPoint& p) {
  if (!p.has_value()) return "no value";
  if (p.on_front()) return "on the front";
  return fmt::format("{:.0f} % noisier than {}", 100 * p.excess,
                     p.dominated_by == p.estimator ? "itself at another design" : p.dominated_by);
}

std::vector<std::string> cells_of(const ParetoPoint& p) {
  const bool settles = !std::isnan(p.value.settling);
  return {p.estimator,
          fmt::format("{:g}", p.design),
          milliseconds(p.value.rise_0_90, 1),
          fmt::format("{:.1f}", p.value.overshoot),
          settles ? milliseconds(p.value.settling, 1) : "never",
          fmt::format("{:.3f}", p.value.noise),
          verdict(p)};
}

}  // namespace

bool ParetoPoint::has_value() const {
  return std::isfinite(value.settling) && value.settling > 0 && std::isfinite(value.noise) &&
         value.noise > 0;
}

std::vector<ParetoPoint> pareto(const Robot& r, int threads,
                                const std::function<void(double)>& progress,
                                const std::vector<std::string>& asked) {
  std::vector<ParetoPoint> points;
  for (const std::string& e : tunable_of(r, asked)) {
    for (const double w : {3., 6., 12., 25., 50., 100., 200., 400.}) {
      points.push_back({.estimator = e, .design = w});
    }
  }
  for (const std::string& e : asked.empty() ? r.estimators() : asked) {
    if (!is_baseline(e)) points.push_back({.estimator = e});
  }
  const StepRuns runs(r);
  const auto work = [&](int i) {
    ParetoPoint& p = points[static_cast<std::size_t>(i)];
    p.value =
        noise_and_delay(runs, p.design > 0 ? at_bandwidth(p.estimator, p.design) : p.estimator);
  };
  parallel_for(static_cast<int>(points.size()), threads, work, progress);
  mark_dominated(points);
  return points;
}

void mark_dominated(std::vector<ParetoPoint>& points) {
  const std::map<std::string, Front> fronts = fronts_of(points);
  for (ParetoPoint& p : points) {
    if (!p.has_value()) continue;
    double quietest = p.value.noise / kMargin;
    for (const auto& [name, front] : fronts) {
      // between its own points an estimator does not compete with itself
      const double rival = name == p.estimator ? noise_of_points(front, p.value.settling)
                                               : noise_within(front, p.value.settling);
      if (!(rival < quietest)) continue;
      quietest = rival;
      p.dominated_by = name;
      p.excess = p.value.noise / rival - 1;
    }
  }
}

std::string format_pareto(const Robot& r, const std::vector<ParetoPoint>& points,
                          TableFormat format) {
  TableWriter table({{"estimator", "", true},
                     {"design", "rad/s"},
                     {title_of(Metric::kRise0To90), "ms"},
                     {title_of(Metric::kOvershoot), "%"},
                     {title_of(Metric::kSettling), "ms"},
                     {title_of(Metric::kNoise), "N m"},
                     {"verdict", "", true}});
  const ParetoPoint* before = nullptr;
  for (const ParetoPoint& p : points) {
    // a group for each estimator that was swept, and one for the roster's own tunings
    const bool next =
        before != nullptr && (p.design > 0 ? p.estimator != before->estimator : before->design > 0);
    if (next) table.add_gap();
    before = &p;
    table.add(cells_of(p));
  }
  if (format != TableFormat::kText) return table.format(format);
  return fmt::format("{}: noise against delay; design 0 is the roster's own tuning\n{}{}", r.name(),
                     table.format(), kParetoLegend);
}

}  // namespace tauext::study

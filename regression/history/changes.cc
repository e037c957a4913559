// SPDX-License-Identifier: Apache-2.0
#include "regression/history/changes.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "regression/time/verdict.h"

namespace tauext::gate {
namespace {

double noise_of(const std::vector<double>& values, double least) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) {
    steps.push_back(std::abs(values[i] - values[i - 1]));
  }
  return std::max(median(steps) / (0.6745 * std::sqrt(2.)), least);
}

double median(std::span<const double> values) {
  return gate::median(std::vector<double>(values.begin(), values.end()));
}

double deviations(std::span<const double> values, double from) {
  double sum = 0;
  for (const double v : values) sum += std::abs(v - from);
  return sum;
}

// the split that leaves the least deviations from both medians, and their t
struct Split {
  std::size_t at = 0;
  double by = 0, t = 0;
};

Split best_split(std::span<const double> values, double sd, std::size_t points) {
  Split best;
  double least = HUGE_VAL;
  for (std::size_t k = points; k + points <= values.size(); ++k) {
    const double before = median(values.first(k)), after = median(values.subspan(k));
    const double left = deviations(values.first(k), before) + deviations(values.subspan(k), after);
    if (!(left < least)) continue;
    least = left;
    const auto n = static_cast<double>(k), m = static_cast<double>(values.size() - k);
    // a median's standard error is sqrt(pi / 2) times the mean's
    best = {k, after - before, std::abs(after - before) / (1.2533 * sd * std::sqrt(1 / n + 1 / m))};
  }
  return best;
}

}  // namespace

LevelChange last_change(const std::vector<double>& values, const ChangeLimits& limits, int series) {
  const std::size_t n = values.size();
  if (n < 2 * limits.points) return {};
  const double sd = noise_of(values, limits.least_sd);
  const double tests = 2. * static_cast<double>(n) * std::max(series, 1);
  const double wanted = student_quantile(1 - limits.false_alarms / tests, static_cast<int>(n) - 2);
  LevelChange last;
  std::size_t begin = 0;
  while (true) {
    const Split s = best_split(std::span(values).subspan(begin), sd, limits.points);
    if (s.t <= wanted || std::abs(s.by) < limits.least) return last;
    last = {begin + s.at, s.by};
    begin += s.at;
  }
}

}  // namespace tauext::gate

// SPDX-License-Identifier: Apache-2.0
#include "bench/seeds/seed_figures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace tauext {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// [1] of Student's t with n degrees of freedom, what lies within +-sqrt(n) tan(angle): Abramowitz
// and Stegun, 26.7.3 and 4
double inside(double angle, int n) {
  const double c = std::cos(angle), s = std::sin(angle);
  double sum = 0, term = n % 2 == 0 ? 1 : c;
  for (int k = n % 2 == 0 ? 2 : 3; k <= n; k += 2) {
    sum += term;
    term *= c * c * (k - 1) / k;
  }
  return n % 2 == 0 ? s * sum : (angle + s * sum) * 2 / std::numbers::pi;
}

// values of those that have one, and how often there was none
std::vector<double> values_of(const std::vector<Score>& scores, Metric m, int& never) {
  std::vector<double> values;
  for (const Score& s : scores) {
    const auto value = s.get(m);
    if (!value || !s.error.empty()) continue;
    if (std::isnan(*value))
      ++never;
    else
      values.push_back(*value);
  }
  return values;
}

}  // namespace

double student_t(int degrees) {
  double low = 0, high = std::numbers::pi / 2;  // of atan(t / sqrt(n))
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (inside(middle, degrees) < 0.95 ? low : high) = middle;
  }
  return std::sqrt(degrees) * std::tan(low);
}

SeedFigure figure_of(const std::vector<double>& values) {
  SeedFigure f;
  f.values = static_cast<int>(values.size());
  if (values.empty()) return f;
  const auto n = static_cast<double>(values.size());
  for (const double v : values) f.mean += v / n;
  double squares = 0;
  for (const double v : values) squares += (v - f.mean) * (v - f.mean);
  const double half =
      f.values < 2 ? kInfinity : student_t(f.values - 1) * std::sqrt(squares / (n - 1) / n);
  f.interval = {f.mean - half, f.mean + half};
  return f;
}

SeedFigure figure_of(const SeededRow& row, Metric metric) {
  int never = 0;
  SeedFigure f = figure_of(values_of(row.scores, metric, never));
  f.never = never;
  double count = 0;  // of what the metric counts, over all seeds
  int collisions = 0;
  for (const Score& s : row.scores) {
    if (!s.error.empty()) continue;
    collisions += s.collisions;
    count += s.get(metric).value_or(0) * (metric == Metric::kRecall ? s.collisions : 1);
  }
  const int whole = static_cast<int>(std::lround(count));
  if (metric == Metric::kRecall && collisions > 0) {
    f.mean = count / collisions;
    f.interval = metrics::share_interval(whole, collisions);
  }
  if (metric == Metric::kFalseAlarms && f.values > 0) {
    const metrics::Interval all = metrics::count_interval(whole);
    f.interval = {all.low / f.values, all.high / f.values};
  }
  return f;
}

SeedFigure difference_of(const SeededRow& row, const SeededRow& against, Metric metric) {
  std::vector<double> differences;
  int never = 0;
  for (std::size_t i = 0; i < std::min(row.scores.size(), against.scores.size()); ++i) {
    const auto a = row.scores[i].get(metric), b = against.scores[i].get(metric);
    if (!a || !b || !row.scores[i].error.empty() || !against.scores[i].error.empty()) continue;
    if (std::isfinite(*a - *b))
      differences.push_back(*a - *b);
    else
      ++never;
  }
  SeedFigure f = figure_of(differences);
  f.never = never;
  return f;
}

}  // namespace tauext

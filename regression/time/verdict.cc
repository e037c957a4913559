// SPDX-License-Identifier: Apache-2.0
#include "regression/time/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace tauext::gate {
namespace {

double median_of(const std::vector<LayoutRatios>& all, double LayoutRatios::*ratio) {
  std::vector<double> values;
  for (const LayoutRatios& r : all) values.push_back(r.*ratio);
  return median(values);
}

// Student's distribution function for x > 0: Abramowitz and Stegun 26.7.3 and 26.7.4
double student_probability(double x, int degrees) {
  constexpr double kPi = 3.141592653589793;
  const double angle = std::atan(x / std::sqrt(degrees)), c = std::cos(angle), s = std::sin(angle);
  const bool odd = degrees % 2 == 1;
  double term = odd ? c : 1, sum = degrees == 1 ? 0 : term;
  for (int k = odd ? 2 : 1; k <= degrees - 3; k += 2) {
    term *= c * c * k / (k + 1);
    sum += term;
  }
  const double two_sided = odd ? 2 / kPi * (angle + s * sum) : s * sum;
  return (1 + two_sided) / 2;
}

// why these layouts cannot be trusted; false if they can
bool too_noisy(const TimeLimits& limits, TimeVerdict& v) {
  if (!(std::abs(v.aa - 1) <= limits.limit / 2)) {
    v.why = fmt::format("a copy of base beside itself is off by {:+.1f} %", 100 * (v.aa - 1));
    return true;
  }
  if (!(v.canary > 1 + limits.canary / 2)) {
    v.why = fmt::format("of {:.0f} % injected, {:.1f} % were seen", 100 * limits.canary,
                        100 * (v.canary - 1));
    v.harness_error = true;
    return true;
  }
  return false;
}

}  // namespace

const char* name_of(Verdict v) {
  switch (v) {
    case Verdict::kIdentical:
      return "identical";
    case Verdict::kPass:
      return "ok";
    case Verdict::kNote:
      return "note";
    case Verdict::kFail:
      return "FAIL";
    case Verdict::kInconclusive:
      return "INCONCLUSIVE";
    case Verdict::kNoBaseline:
      return "no baseline";
    case Verdict::kAccepted:
      return "accepted";
  }
  return "?";
}

double median(std::vector<double> values) {
  if (values.empty()) throw std::logic_error("median of nothing");
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

double student_quantile(double probability, int degrees) {
  double low = 0, high = 1;
  while (student_probability(high, degrees) < probability) high *= 2;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (student_probability(middle, degrees) < probability ? low : high) = middle;
  }
  return (low + high) / 2;
}

TimeVerdict judge(const std::vector<LayoutRatios>& all, const TimeLimits& limits, int kernels) {
  const auto n = static_cast<int>(all.size());
  if (n < std::max(limits.stages[0], 2)) {
    throw std::logic_error(
        fmt::format("{} layouts, where a verdict needs {}", n, limits.stages[0]));
  }
  double mean = 0, squares = 0;
  for (const LayoutRatios& r : all) mean += std::log(r.head) / n;
  for (const LayoutRatios& r : all) squares += std::pow(std::log(r.head) - mean, 2);
  TimeVerdict v;
  v.layouts = n;
  v.layout_sd = std::sqrt(squares / (n - 1));
  const double error = std::max(v.layout_sd, limits.least_sd) / std::sqrt(n);
  const double both = student_quantile(0.975, n - 1) * error;
  const double surely =
      mean - student_quantile(1 - limits.false_alarms / std::max(kernels, 1), n - 1) * error;
  v.surely = std::expm1(surely);
  v.ratio = std::exp(mean);
  v.low = std::exp(mean - both);
  v.high = std::exp(mean + both);
  v.aa = median_of(all, &LayoutRatios::aa);
  v.canary = median_of(all, &LayoutRatios::canary);
  if (too_noisy(limits, v)) return v;
  if (v.surely > limits.surely) {
    if (n >= limits.stages[1]) {
      v.verdict = Verdict::kFail;
    } else {
      v.why = "slower in the first layouts, to be confirmed";
    }
  } else if (v.high <= 1 + limits.limit ||
             (n >= limits.stages[2] && v.high <= 1 + 1.5 * limits.limit &&
              v.ratio <= 1 + 0.75 * limits.limit)) {
    v.verdict = Verdict::kPass;
  } else {
    v.why = fmt::format("the interval holds the limit: layouts differ by {:.2f} % (sd)",
                        100 * v.layout_sd);
  }
  return v;
}

}  // namespace tauext::gate

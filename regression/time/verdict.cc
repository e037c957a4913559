// SPDX-License-Identifier: Apache-2.0
#include "regression/time/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace tauext::gate {
namespace {

std::vector<double> sorted(const std::vector<ProcessRatios>& all, double ProcessRatios::*ratio,
                           std::size_t first = 0) {
  std::vector<double> values;
  for (std::size_t i = first; i < all.size(); ++i) values.push_back(all[i].*ratio);
  std::sort(values.begin(), values.end());
  return values;
}

// the 3rd smallest of 10, 6th of 20, 12th of 40
double low_of(const std::vector<double>& sorted_values) {
  return sorted_values[sorted_values.size() * 3 / 10 - 1];
}
double high_of(const std::vector<double>& sorted_values) {
  return sorted_values[sorted_values.size() - sorted_values.size() * 3 / 10];
}

bool slower(const std::vector<double>& sorted_values, double limit) {
  return median(sorted_values) > 1 + limit && low_of(sorted_values) > 1;
}

// the first stage may have been unlucky: later processes have to say so among themselves, and if
// they are no more than those of the first stage, the first stage, too
void confirm(const std::vector<ProcessRatios>& all, const TimeLimits& limits, TimeVerdict& v) {
  const auto first_stage = static_cast<std::size_t>(limits.stages[0]);
  const std::vector<ProcessRatios> stage(all.begin(),
                                         all.begin() + static_cast<std::ptrdiff_t>(first_stage));
  const std::vector<double> fresh = sorted(all, &ProcessRatios::head, first_stage);
  if (fresh.size() < first_stage) {
    v.why = "slower in the first processes, to be confirmed";
    return;
  }
  const bool early = slower(sorted(stage, &ProcessRatios::head), limits.limit);
  if (slower(fresh, limits.limit) && (early || fresh.size() > first_stage)) {
    v.verdict = Verdict::kFail;
  } else {
    v.why = "some processes say slower, and others do not confirm it";
  }
}

// why these processes cannot be trusted; false if they can
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

TimeVerdict judge(const std::vector<ProcessRatios>& all, const TimeLimits& limits) {
  const std::size_t least = std::max<std::size_t>(static_cast<std::size_t>(limits.stages[0]), 4);
  if (all.size() < least) {
    throw std::logic_error(
        fmt::format("{} processes, where a verdict needs {}", all.size(), least));
  }
  const std::vector<double> head = sorted(all, &ProcessRatios::head);
  TimeVerdict v;
  v.processes = static_cast<int>(all.size());
  v.median = median(head);
  v.low = low_of(head);
  v.high = high_of(head);
  v.aa = median(sorted(all, &ProcessRatios::aa));
  v.canary = median(sorted(all, &ProcessRatios::canary));
  if (too_noisy(limits, v)) return v;
  if (slower(head, limits.limit)) {
    confirm(all, limits, v);
  } else if (v.high <= 1 + limits.limit) {
    v.verdict = Verdict::kPass;
  } else {
    v.why = "the interval holds the limit";
  }
  return v;
}

}  // namespace tauext::gate

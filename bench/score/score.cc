// SPDX-License-Identifier: Apache-2.0
#include "bench/score/score.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace tauext {
namespace {

double worst(WorstJoint which, const std::vector<double>& values) {
  const auto never = [](double v) { return std::isnan(v); };
  if (values.empty() || std::any_of(values.begin(), values.end(), never)) {
    return kNoValue;
  }
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return which == WorstJoint::kSmallest ? *least : *most;
}

}  // namespace

bool Score::empty() const {
  return std::none_of(values_.begin(), values_.end(), [](const auto& v) { return v.has_value(); });
}

void Score::set_joints(Metric m, std::vector<double> values) {
  const WorstJoint which = row_of(m).joints;
  if (which == WorstJoint::kNone) throw std::logic_error(key_of(m) + " is not judged by joint");
  set(m, worst(which, values));
  joints_[index(m)] = std::move(values);
}

std::vector<std::pair<std::string, double>> Score::by_key() const {
  std::vector<std::pair<std::string, double>> all;
  for (const MetricRow& row : kMetrics) {
    if (const auto value = get(row.metric)) all.emplace_back(row.key, *value);
    int joint = 0;
    for (const double value : joints(row.metric)) {
      all.emplace_back(key_of(row.metric, ++joint), value);
    }
  }
  counts.for_each([&](const std::string& key, std::int64_t n) {
    all.emplace_back(key, static_cast<double>(n));
  });
  return all;
}

}  // namespace tauext

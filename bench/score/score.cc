// SPDX-License-Identifier: Apache-2.0
#include "bench/score/score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace tauext {
namespace {

double worst(WorstJoint which, const Score::Joints& joints) {
  double worst = which == WorstJoint::kSmallest ? std::numeric_limits<double>::infinity()
                                                : -std::numeric_limits<double>::infinity();
  for (const std::optional<double>& v : joints) {
    if (!v) continue;
    if (std::isnan(*v)) return kNoValue;
    worst = which == WorstJoint::kSmallest ? std::min(worst, *v) : std::max(worst, *v);
  }
  return worst;
}

}  // namespace

bool Score::empty() const {
  return std::none_of(values_.begin(), values_.end(), [](const auto& v) { return v.has_value(); });
}

void Score::set_joints(Metric m, Joints values) {
  const WorstJoint which = row_of(m).joints;
  if (which == WorstJoint::kNone) throw std::logic_error(key_of(m) + " is not judged by joint");
  if (std::none_of(values.begin(), values.end(), [](const auto& v) { return v.has_value(); }))
    return;
  set(m, worst(which, values));
  joints_[index(m)] = std::move(values);
}

std::vector<std::pair<std::string, double>> Score::by_key() const {
  std::vector<std::pair<std::string, double>> all;
  for (const MetricRow& row : kMetrics) {
    if (const auto value = get(row.metric)) all.emplace_back(row.key, *value);
    int joint = 0;
    for (const std::optional<double>& value : joints(row.metric)) {
      ++joint;
      if (value) all.emplace_back(key_of(row.metric, joint), *value);
    }
  }
  counts.for_each([&](const std::string& key, std::int64_t n) {
    all.emplace_back(key, static_cast<double>(n));
  });
  return all;
}

}  // namespace tauext

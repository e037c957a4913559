// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/torque_sampling.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tauext {

bool TorqueWeight::contradicts(bool assumed_instant) const {
  // a weight far from both says that something else is wrong with tau
  const double other = assumed_instant ? 0 : 1;
  return sure < 0.3 && std::abs(weight - other) < 0.25 && std::abs(weight - other) + sure < 0.5;
}

bool TorqueWeight::leans_from(bool assumed_instant) const {
  return (assumed_instant ? 1 - weight : weight) - sure > 0.5;
}

void TorqueWeigher::take(const double* held, const double* instant) {
  ++count_;
  for (std::size_t j = 0; j < sums_.size(); ++j) {
    const double a = held[j], d = a - instant[j];
    sums_[j].dd += d * d, sums_[j].ad += a * d, sums_[j].aa += a * a;
  }
}

std::optional<TorqueWeight> TorqueWeigher::weight(double bandwidth, double step) const {
  constexpr std::int64_t kFewest = 200;
  if (count_ < kFewest) return std::nullopt;
  const double dependent = std::max(1., 2 / (bandwidth * step));
  const auto count = static_cast<double>(count_);
  double weighted = 0, weights = 0;
  Eigen::VectorXd held(static_cast<Eigen::Index>(sums_.size())), instant = held;
  for (std::size_t j = 0; j < sums_.size(); ++j) {
    const auto& [dd, ad, aa] = sums_[j];
    held[static_cast<Eigen::Index>(j)] = aa / count;
    instant[static_cast<Eigen::Index>(j)] = std::max(aa - 2 * ad + dd, 0.) / count;
    if (dd == 0) continue;
    const double weight = ad / dd, rest = std::max(aa - ad * weight, 1e-12 * aa) / count;
    const double certain = dd / (rest * dependent);
    weighted += certain * weight, weights += certain;
  }
  if (!(weights > 0)) return std::nullopt;
  return TorqueWeight{weighted / weights, 3 / std::sqrt(weights), std::move(held),
                      std::move(instant)};
}

}  // namespace tauext

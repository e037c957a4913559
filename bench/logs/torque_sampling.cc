// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/torque_sampling.h"

#include <algorithm>
#include <cmath>

namespace tauext {

bool TorqueWeight::contradicts(bool assumed_instant) const {
  // a weight far from both says that something else is wrong with tau
  const double other = assumed_instant ? 0 : 1;
  return sure < 0.3 && std::abs(weight - other) < 0.25 && std::abs(weight - other) + sure < 0.5;
}

std::optional<TorqueWeight> torque_weight(const Trace& trace, const Eigen::MatrixXd& held,
                                          const Eigen::MatrixXd& instant,
                                          const std::vector<Status>& status, double bandwidth) {
  const double step = (trace.t.back() - trace.t.front()) / std::max(trace.size() - 1, 1);
  const double dependent = std::max(1., 2 / (bandwidth * step));
  double weighted = 0, weights = 0;
  for (int j = 0; j < trace.dof(); ++j) {
    double dd = 0, ad = 0, aa = 0;
    int count = 0;
    for (int k = 0; k < trace.size(); ++k) {
      if (status[k] != Status::kOk || (!trace.contact.empty() && trace.contact[k])) continue;
      const double a = held(j, k), delta = a - instant(j, k);
      dd += delta * delta, ad += a * delta, aa += a * a;
      ++count;
    }
    if (count < 1000 || dd == 0) continue;
    const double weight = ad / dd, rest = std::max(aa - ad * weight, 1e-12 * aa) / count;
    const double certain = dd / (rest * dependent);
    weighted += certain * weight, weights += certain;
  }
  if (!(weights > 0)) return std::nullopt;
  return TorqueWeight{weighted / weights, 3 / std::sqrt(weights)};
}

}  // namespace tauext

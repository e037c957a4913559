// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/arm_motion.h"

#include "mjcf/plant/any_tree.h"

namespace tauext {

ArmMotion::ArmMotion(const ArmTree& arm, const Trace& log) : log_(log) {
  const int n = arm.dof(), samples = log.size();
  detail::require_size(arm, log.dof());
  const auto model = detail::filled<TiedTree>(arm);
  momentum_.resize(n, samples);
  rest_.resize(n, samples);
  for (int k = 0; k < samples; ++k) {
    Vec<kMostCoordinates> q = Vec<kMostCoordinates>::Zero(), qd = q;
    q.head(n) = log.q.col(k), qd.head(n) = log.qd.col(k);
    const auto d = model.momentum_dynamics(q, qd);
    momentum_.col(k) = (d.B * qd).head(n);
    rest_.col(k) = (model.friction(qd) - d.bias).head(n);
  }
}

double ArmMotion::expected(int joint, const Window& w) const {
  return mean_change(log_, w, [&](int k) { return momentum_(joint, k); }) +
         mean_over(log_, w, [&](int k) { return rest_(joint, k); });
}

double ArmMotion::expected_around(int joint, const Window& w) const {
  return change_around(log_, w, [&](int k) { return momentum_(joint, k); }) +
         mean_over(log_, w, [&](int k) { return rest_(joint, k); });
}

}  // namespace tauext

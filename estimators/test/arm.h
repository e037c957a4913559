// SPDX-License-Identifier: Apache-2.0
// A simulated wallmobot3 for tests that need samples and not MuJoCo: RK4 of the closed form under
// computed torque along q_ref = a sin(w t), tau and tau_ext held over each sample.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "estimators/wallmobot3.h"

namespace tauext::test {

struct Motion {
  double amplitude = 0.1, w = 1;  // [rad], [rad/s]
  bool start_on_reference = true;
  double Kp = 400, Kd = 40;
};

inline std::vector<Measurement<3>> simulate(const std::vector<double>& times,
                                            const std::function<Vec<3>(double)>& tau_ext,
                                            const Motion& m = {},
                                            const WallMoBot3& arm = WallMoBot3()) {
  std::vector<Measurement<3>> samples;
  const Vec<3> ones = Vec<3>::Ones();
  Vec<3> q = Vec<3>::Zero(), qd = Vec<3>::Zero();
  if (m.start_on_reference) qd = m.amplitude * m.w * ones;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double t = times[k], s = m.amplitude * std::sin(m.w * t);
    const Vec<3> a = -m.w * m.w * s * ones + m.Kp * (s * ones - q) +
                     m.Kd * (m.amplitude * m.w * std::cos(m.w * t) * ones - qd);
    const Vec<3> tau = arm.inertia(q) * a + arm.bias(q, qd) + arm.friction(qd);
    samples.push_back({t, q, qd, tau});
    if (k + 1 == times.size()) break;
    const double h = times[k + 1] - t;
    const Vec<3> u = tau - tau_ext(t);
    const auto qdd = [&](const Vec<3>& x, const Vec<3>& v) {
      return arm.forward_dynamics(x, v, u).qdd;
    };
    const Vec<3> v1 = qd, a1 = qdd(q, v1);
    const Vec<3> v2 = qd + h / 2 * a1, a2 = qdd(q + h / 2 * v1, v2);
    const Vec<3> v3 = qd + h / 2 * a2, a3 = qdd(q + h / 2 * v2, v3);
    const Vec<3> v4 = qd + h * a3, a4 = qdd(q + h * v3, v4);
    q += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    qd += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  return samples;
}

inline std::vector<double> grid(double seconds, double Ts) {
  std::vector<double> t;
  for (int k = 0; k < std::lround(seconds / Ts); ++k) t.push_back(k * Ts);
  return t;
}

inline std::function<Vec<3>(double)> constant(double load) {
  return [=](double) { return Vec<3>::Constant(load); };
}

}  // namespace tauext::test

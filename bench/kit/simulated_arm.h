// SPDX-License-Identifier: Apache-2.0
/// @file
/// A simulated arm for tests that need samples and no simulator: RK4 of a model's own dynamics
/// under computed torque, tau and tau_ext held over each sample. Not for benchmarks: it knows no
/// friction that sticks, no contact, and nothing that the model does not know.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "estimators/math/ldlt.h"
#include "estimators/wallmobot3.h"

namespace tauext::simulated_arm {

/// q_ref = amplitude sin(w t) on every joint.
struct Motion {
  double amplitude = 0.1;          ///< [rad]
  double w = 1;                    ///< [rad/s]
  bool start_on_reference = true;  ///< moving; else at rest at q = 0
  double Kp = 400;                 ///< [1/s^2]
  double Kd = 40;                  ///< [1/s]
};

/// What the sensors read at these times [s] if tau_ext(t) [N m, sign of (3)] acts.
template <class Arm = WallMoBot3>
std::vector<Measurement<Arm::kDof>> simulate(const std::vector<double>& times,
                                             const std::function<Vec<Arm::kDof>(double)>& tau_ext,
                                             const Motion& m = {}, const Arm& arm = Arm()) {
  using V = Vec<Arm::kDof>;
  std::vector<Measurement<Arm::kDof>> samples;
  const V ones = V::Ones();
  V q = V::Zero(), qd = V::Zero();
  if (m.start_on_reference) qd = m.amplitude * m.w * ones;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double t = times[k], s = m.amplitude * std::sin(m.w * t);
    const V a = -m.w * m.w * s * ones + m.Kp * (s * ones - q) +
                m.Kd * (m.amplitude * m.w * std::cos(m.w * t) * ones - qd);
    const V tau = arm.inertia(q) * a + arm.bias(q, qd) + arm.friction(qd);
    samples.push_back({t, q, qd, tau});
    if (k + 1 == times.size()) break;
    const double h = times[k + 1] - t;
    const V u = tau - tau_ext(t);
    const auto qdd = [&](const V& x, const V& v) -> V {
      const V rest = arm.bias(x, v) + arm.friction(v);
      return Ldlt<Arm::kDof>(arm.inertia(x)).solve(V(u - rest));
    };
    const V v1 = qd, a1 = qdd(q, v1);
    const V v2 = qd + h / 2 * a1, a2 = qdd(q + h / 2 * v1, v2);
    const V v3 = qd + h / 2 * a2, a3 = qdd(q + h / 2 * v2, v3);
    const V v4 = qd + h * a3, a4 = qdd(q + h * v3, v4);
    q += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    qd += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  return samples;
}

/// Times k Ts [s] below `seconds`.
inline std::vector<double> grid(double seconds, double Ts) {
  std::vector<double> t;
  for (int k = 0; k < std::lround(seconds / Ts); ++k) t.push_back(k * Ts);
  return t;
}

/// The same load [N m] on every joint for ever.
template <int N = 3>
std::function<Vec<N>(double)> constant(double load) {
  return [=](double) { return Vec<N>::Constant(load); };
}

}  // namespace tauext::simulated_arm

// SPDX-License-Identifier: Apache-2.0
// The simulated arm, and what else several tests use.
#pragma once

#include <limits>

#include "bench/kit/simulated_arm.h"

namespace tauext::test {
using namespace simulated_arm;

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// the arm held at q = 0 under a load, where (3) is tau = g + tau_ext and nothing else moves
inline Measurement<3> held(double t, double load) {
  Measurement<3> y;
  y.t = t;
  y.tau = WallMoBot3().gravity(y.q) + Vec<3>::Constant(load);
  return y;
}

}  // namespace tauext::test

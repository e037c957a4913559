// SPDX-License-Identifier: Apache-2.0
/// @file
/// An arm at rest, of which a test changes what it likes.
#pragma once

#include "estimators/sampling.h"
#include "estimators/wallmobot3.h"

namespace tauext::test {

// wallmobot3 at rest at q = 0, its first ten samples taken
struct AtRest {
  AtRest() {
    for (int i = 0; i < 10; ++i) take();
  }
  Status take(const Measurement<3>& change = {}) {
    Measurement<3> y = change;
    y.t += k++ * 1e-3;
    y.q += at;
    return s.accept(y);
  }
  Sampling<3> s{0.05, limits_of(WallMoBot3())};
  Vec<3> at = Vec<3>::Zero();
  int k = 0;
};

// what one joint says beside that
inline Measurement<3> off(int joint, double q, double qd, double tau) {
  Measurement<3> y;
  y.q[joint] = q, y.qd[joint] = qd, y.tau[joint] = tau;
  return y;
}

}  // namespace tauext::test

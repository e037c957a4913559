// SPDX-License-Identifier: Apache-2.0
#include <estimators/ndob.h>
#include <estimators/wallmobot3.h>

#include <cstdio>

static_assert(alignof(tauext::Vec<4>) == 32);  // whatever the flags: libraries share these types

int main() {
  const tauext::WallMoBot3 arm;
  tauext::Ndob<tauext::WallMoBot3> ndob(arm, tauext::Ndob<tauext::WallMoBot3>::Parameters::paper());
  tauext::Measurement<3> y;
  y.tau = arm.gravity(y.q) + tauext::Vec<3>::Constant(5);  // at rest, with 5 N m from outside
  tauext::Estimate<3> e;
  for (int k = 0; k < 10000; ++k) y.t = k * 1e-3, e = ndob.update(y);
  std::printf("tau_ext = %.2f N m\n", e.tau_ext[1]);
}

// SPDX-License-Identifier: Apache-2.0
#include "estimators/ndob_inertia.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "estimators/inverse_dynamics.h"
#include "estimators/momentum_observer.h"
#include "estimators/test/arm.h"

namespace tauext::test {
namespace {

using Arm = WallMoBot3;

template <class E>
E with_bandwidth(double w) {
  return E(Arm(), E::Parameters::for_bandwidth(Arm(), w));
}

TEST(NdobInertia, AtEqualBandwidthIsTheMomentumObserverAndFilteredInverseDynamics) {
  auto ndob = with_bandwidth<NdobInertia<Arm>>(30);
  auto mo1 = with_bandwidth<MomentumObserver<Arm>>(30);
  auto inverse = with_bandwidth<InverseDynamics<Arm>>(30);
  const auto step = [](double t) -> Vec<3> { return Vec<3>::Constant(t < 1 ? 0 : 50); };
  double worst = 0;
  for (const auto& y : simulate(grid(3, 1e-3), step, {.amplitude = 0.3, .w = 2})) {
    const Vec<3> d = ndob.update(y).tau_ext;
    worst = std::max(worst, (d - mo1.update(y).tau_ext).norm());
    worst = std::max(worst, (d - inverse.update(y).tau_ext).norm());
  }
  EXPECT_LT(worst, 0.01 * 50) << "N m: three ways to step one equation, apart by order h^2";
}

TEST(NdobInertia, StartedInMotionItIsRightFromTheFirstSample) {
  auto ndob = with_bandwidth<NdobInertia<Arm>>(30);
  double worst = 0;
  for (const auto& y : simulate(grid(5, 1e-3), constant(0), {.amplitude = 0.3, .w = 2})) {
    worst = std::max(worst, ndob.update(y).tau_ext.cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst, 0.01) << "N m";
}

TEST(NdobInertia, RefusesABandwidthOfZero) {
  EXPECT_THROW(with_bandwidth<NdobInertia<Arm>>(0), std::invalid_argument);
}

}  // namespace
}  // namespace tauext::test

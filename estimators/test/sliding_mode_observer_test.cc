// SPDX-License-Identifier: Apache-2.0
#include "estimators/sliding_mode_observer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "estimators/higher_order_momentum_observer.h"
#include "estimators/test/arm.h"

namespace tauext::test {
namespace {

using Smo = SlidingModeObserver<WallMoBot3>;

// linear part of 30 rad/s, and a tau_ext of up to S1 per second
Smo::Parameters with_rate(double S1) {
  Smo::Parameters p = Smo::Parameters::for_bandwidth(WallMoBot3(), 30);
  p.S1.setConstant(S1);
  p.T1.setConstant(std::sqrt(2 * S1));
  return p;
}

TEST(Smo, ReachesAConstantLoadInFiniteTimeAndStaysThereWithoutChatter) {
  Smo smo(WallMoBot3(), with_rate(100));
  MomentumObserver2<WallMoBot3> mo2(WallMoBot3(), {.bandwidth = 30});
  double linear = 0, low = 50, high = 50;
  for (int k = 0; k < 2000; ++k) {
    const auto y = held(k * 1e-3, 50);
    const double d = smo.update(y).tau_ext[1];
    if (k == 600) linear = mo2.update(y).tau_ext[1];
    mo2.update(y);
    if (k >= 600) low = std::min(low, d), high = std::max(high, d);
  }
  EXPECT_LT(high - low, 1e-6 * 50) << "N m; an explicit step would swing by 2 h S1 = 0.2";
  EXPECT_NEAR(low, 50, 1e-6 * 50);
  EXPECT_GT(std::abs(linear - 50), 100 * (high - low)) << "the linear observer's tail";
}

TEST(Smo, FollowsARampSlowerThanS1WithoutLag) {
  constexpr double kSlope = 20;  // [N m/s]; mo2 would be 0.94 N m behind
  const auto ramp = [](double t) -> Vec<3> { return Vec<3>::Constant(kSlope * t); };
  const auto worst = [&](double S1) {
    Smo smo(WallMoBot3(), with_rate(S1));
    double w = 0;
    for (const auto& y : simulate(grid(3, 1e-3), ramp)) {
      const Vec<3> d = smo.update(y).tau_ext;
      if (y.t > 2) w = std::max(w, (ramp(y.t) - d).cwiseAbs().maxCoeff());
    }
    return w;
  };
  EXPECT_LT(worst(2 * kSlope), kSlope * 1.1e-3) << "N m: the sample in which the load is held";
  EXPECT_GT(worst(0.5 * kSlope), 0.1) << "N m: faster than S1 there is a lag";
}

TEST(Smo, WithoutSlidingIsTheSecondOrderMomentumObserver) {
  Smo::Parameters p = with_rate(0);
  Smo smo(WallMoBot3(), p);
  MomentumObserver2<WallMoBot3> mo2(WallMoBot3(), {.bandwidth = 30});
  const auto step = [](double t) -> Vec<3> { return Vec<3>::Constant(t < 1 ? 0 : 50); };
  double worst = 0;
  for (const auto& y : simulate(grid(2, 0.25e-3), step, {.amplitude = 0.3, .w = 2})) {
    const Vec<3> d = smo.update(y).tau_ext;
    worst = std::max(worst, (d - mo2.update(y).tau_ext).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst, 0.01 * 50) << "N m: an implicit step of first order, w h = 0.0075";
}

TEST(Smo, StartedInMotionItIsRightFromTheFirstSample) {
  Smo smo(WallMoBot3(), with_rate(100));
  double worst = 0;
  for (const auto& y : simulate(grid(5, 1e-3), constant(0), {.amplitude = 0.3, .w = 2})) {
    worst = std::max(worst, smo.update(y).tau_ext.cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst, 0.01) << "N m";
}

TEST(Smo, IsStableForEveryStepOfItsGains) {
  Smo smo(WallMoBot3(), Smo::Parameters::for_bandwidth(WallMoBot3(), 1e6));
  const auto step = [](double t) -> Vec<3> { return Vec<3>::Constant(t < 1 ? 0 : 50); };
  double worst = 0;
  for (const auto& y : simulate(grid(3, 1e-3), step)) {
    const Vec<3> d = smo.update(y).tau_ext;
    if (y.t > 1.01) worst = std::max(worst, (d - step(y.t)).norm());
  }
  EXPECT_LT(worst, 0.5) << "N m: w h = 1000 differentiates, and that is all";
}

TEST(Smo, RefusesGainsThatMeanNothing) {
  EXPECT_THROW(Smo(WallMoBot3(), {}), std::invalid_argument) << "S2 = 0";
  EXPECT_THROW(Smo(WallMoBot3(), with_rate(-1)), std::invalid_argument);
}

}  // namespace
}  // namespace tauext::test

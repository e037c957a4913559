// SPDX-License-Identifier: Apache-2.0
#include "estimators/momentum_observer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "estimators/inverse_dynamics.h"
#include "estimators/test/arm.h"

namespace tauext::test {
namespace {

using ArmMo1 = MomentumObserver<WallMoBot3>;

// a step of 50 N m at 1 s, in motion
Vec<3> step_at_1_s(double t) {
  return Vec<3>::Constant(t < 1 ? 0 : 50);
}

TEST(Mo1, Reaches90PercentOfAStepAfterLn10OverK) {
  for (const double K : {5., 30., 100.}) {
    ArmMo1 mo1(WallMoBot3(), ArmMo1::Parameters::for_bandwidth(WallMoBot3(), K));
    Vec<3> reached = Vec<3>::Constant(-1);
    for (const auto& y : simulate(grid(2, 0.25e-3), step_at_1_s)) {
      const Vec<3> d = mo1.update(y).tau_ext;
      for (int j = 0; j < 3; ++j) {
        if (reached[j] < 0 && d[j] >= 0.9 * 50) reached[j] = y.t - 1;
      }
    }
    for (int j = 0; j < 3; ++j) {
      EXPECT_NEAR(reached[j], std::log(10) / K, 0.02 * std::log(10) / K)
          << "K " << K << " joint " << j;
    }
  }
}

TEST(Mo1, FollowsARampASlopeOverKBehind) {
  constexpr double kSlope = 20;  // [N m/s]
  ArmMo1 mo1(WallMoBot3(), ArmMo1::Parameters::for_bandwidth(WallMoBot3(), 30));
  Vec<3> behind = Vec<3>::Zero();
  const auto ramp = [](double t) -> Vec<3> { return Vec<3>::Constant(kSlope * t); };
  for (const auto& y : simulate(grid(3, 1e-3), ramp)) behind = ramp(y.t) - mo1.update(y).tau_ext;
  // a held sample is half a step ahead of its mean
  for (int j = 0; j < 3; ++j)
    EXPECT_NEAR(behind[j], kSlope / 30, 0.01 * kSlope / 30 + kSlope * 1e-3);
}

TEST(Mo1, AtEqualBandwidthIsFilteredInverseDynamics) {
  ArmMo1 mo1(WallMoBot3(), ArmMo1::Parameters::for_bandwidth(WallMoBot3(), 30));
  InverseDynamics<WallMoBot3> other(WallMoBot3(), {.bandwidth = 30});
  double worst = 0;
  for (const auto& y : simulate(grid(3, 1e-3), step_at_1_s, {.amplitude = 0.3, .w = 2})) {
    worst = std::max(worst, (mo1.update(y).tau_ext - other.update(y).tau_ext).norm());
  }
  EXPECT_LT(worst, 0.01 * 50) << "N m: they differ by how the means are taken, of order h^2";
}

TEST(Mo1, StartedInMotionItIsRightFromTheFirstSample) {
  // with the sign of p_0 wrong, as in two public plug-ins, the error is 189 N m
  ArmMo1 mo1{WallMoBot3()};
  double worst = 0;
  for (const auto& y : simulate(grid(5, 1e-3), constant(0), {.amplitude = 0.3, .w = 2})) {
    worst = std::max(worst, mo1.update(y).tau_ext.cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst, 0.01) << "N m";
}

TEST(Mo1, IsStableForEveryStepOfItsBandwidth) {
  ArmMo1 mo1(WallMoBot3(), ArmMo1::Parameters::for_bandwidth(WallMoBot3(), 1e6));
  double worst = 0;
  for (const auto& y : simulate(grid(3, 1e-3), step_at_1_s)) {
    const Vec<3> d = mo1.update(y).tau_ext;
    if (y.t > 1.01) worst = std::max(worst, (d - step_at_1_s(y.t)).norm());
  }
  EXPECT_LT(worst, 0.5) << "N m: K h = 1000 differentiates, and that is all";
}

TEST(Mo1, RefusesABandwidthOfZero) {
  EXPECT_THROW(ArmMo1(WallMoBot3(), ArmMo1::Parameters::for_bandwidth(WallMoBot3(), 0)),
               std::invalid_argument);
}

}  // namespace
}  // namespace tauext::test

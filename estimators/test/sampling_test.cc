// SPDX-License-Identifier: Apache-2.0
#include "estimators/sampling.h"

#include <gtest/gtest.h>

#include <limits>

#include "estimators/detectors/pan_tompkins.h"
#include "estimators/ekf.h"
#include "estimators/inverse_dynamics.h"
#include "estimators/ndob.h"
#include "estimators/test/arm.h"
#include "estimators/wallmobot3.h"

namespace tauext::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Sampling, StartsOnceThenSteps) {
  Sampling s(0.05);
  Measurement<2> y;
  y.t = 3;
  EXPECT_EQ(s.accept(y), Status::kStarted);
  y.t = 3.001;
  EXPECT_EQ(s.accept(y), Status::kOk);
  EXPECT_DOUBLE_EQ(s.h(), y.t - 3);
}

TEST(Sampling, RefusesTimeThatStandsStillOrGoesBack) {
  Sampling s(0.05);
  Measurement<2> y;
  y.t = 1;
  s.accept(y);
  EXPECT_EQ(s.accept(y), Status::kBadMeasurement);
  y.t = 0.5;
  EXPECT_EQ(s.accept(y), Status::kBadMeasurement);
  y.t = 1.001;  // counted from the last good sample
  EXPECT_EQ(s.accept(y), Status::kOk);
  EXPECT_NEAR(s.h(), 0.001, 1e-12);
}

TEST(Sampling, StartsAnewAfterALongGap) {
  Sampling s(0.05);
  Measurement<2> y;
  s.accept(y);
  y.t = 0.06;
  EXPECT_EQ(s.accept(y), Status::kStarted);
}

TEST(Sampling, RefusesWhatNoSensorSays) {
  for (const double bad : {kNaN, kInfinity, -kInfinity, 2.7e154, 1.1e6}) {
    for (int field = 0; field < 4; ++field) {
      Sampling s(0.05);
      Measurement<2> y;
      (field == 0 ? y.t : field == 1 ? y.q[1] : field == 2 ? y.qd[1] : y.tau[1]) = bad;
      if (field == 0 && std::isfinite(bad)) continue;  // any finite time is a time
      EXPECT_EQ(s.accept(y), Status::kBadMeasurement) << bad << " in field " << field;
    }
  }
}

TEST(StepChange, TakesTheLastBitsOfTimeStampsForNoChange) {
  StepChange changed;
  int changes = 0;
  for (int k = 1; k < 100000; ++k) changes += changed(k * 1e-3 - (k - 1) * 1e-3);
  EXPECT_EQ(changes, 1);
  EXPECT_TRUE(changed(1.00001e-3));
  EXPECT_FALSE(changed(1.00001e-3));
}

TEST(Parameters, OutOfRangeAreRefusedWhenAnEstimatorIsBuilt) {
  const WallMoBot3 arm;
  using ArmEkf = Ekf<WallMoBot3>;
  using ArmNdob = Ndob<WallMoBot3>;
  EXPECT_THROW(ArmEkf(arm, {}), std::invalid_argument) << "R = 0";
  EXPECT_THROW(ArmNdob(arm, {}), std::invalid_argument) << "X = 0";
  ArmEkf::Parameters p = ArmEkf::Parameters::paper();
  EXPECT_NO_THROW(ArmEkf(arm, p));
  p.Q[8] = -1;
  EXPECT_THROW(ArmEkf(arm, p), std::invalid_argument);
  EXPECT_THROW(InverseDynamics<WallMoBot3>(arm, {.bandwidth = kNaN}), std::invalid_argument);
  EXPECT_THROW(InverseDynamics<WallMoBot3>(arm, {.max_gap = 0}), std::invalid_argument);
  EXPECT_THROW(PanTompkins<3>({.stride = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "estimators/sampling.h"

#include <gtest/gtest.h>

#include <limits>

namespace tauext::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
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

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "estimators/sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "estimators/detectors/pan_tompkins.h"
#include "estimators/ekf.h"
#include "estimators/inverse_dynamics.h"
#include "estimators/ndob.h"
#include "estimators/test/arm.h"
#include "estimators/test/at_rest.h"
#include "estimators/testbed1.h"
#include "estimators/wallmobot3.h"

namespace tauext::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Sampling, RefusesWhatNoSensorSaysAndNamesTheJoint) {
  for (const double bad : {kNaN, kInfinity, -kInfinity, 2.7e154, 1.1e6}) {
    for (const auto& y : {off(1, bad, 0, 0), off(1, 0, bad, 0), off(1, 0, 0, bad)}) {
      AtRest r;
      EXPECT_EQ(r.take(y), Status::kBadMeasurement) << bad;
      EXPECT_EQ(r.s.joints(), 2);
      EXPECT_EQ(r.take(), Status::kOk);
      EXPECT_NEAR(r.s.h(), 2e-3, 1e-12) << "from the last good sample";
    }
  }
}

TEST(Sampling, RefusesWhatTheArmCannotDo) {
  for (const auto& y : {off(2, 0.1, 0, 0), off(2, 0, 1, 0)}) {
    AtRest r;
    EXPECT_EQ(r.take(y), Status::kJump);
    EXPECT_EQ(r.s.joints(), 4);
    EXPECT_EQ(r.take(), Status::kOk);
  }
  AtRest r;
  EXPECT_EQ(r.take(off(0, 0, 1e3, 0)), Status::kOutOfRange);
  EXPECT_EQ(r.s.joints(), 1);
}

TEST(Sampling, ReplacesATorqueThatJumpsAndReturns) {
  AtRest r;
  EXPECT_EQ(r.take(off(2, 0, 0, 3e4)), Status::kOk);
  EXPECT_EQ(r.s.joints(), 0);
  EXPECT_EQ(r.take(), Status::kOk);
  EXPECT_EQ(r.s.joints(), 4);
  EXPECT_EQ(r.s.torque({}), Vec<3>(0, 0, 0));
  EXPECT_EQ(r.take(off(2, 0, 0, 3e4)), Status::kOk);
  EXPECT_EQ(r.s.joints(), 0);
  EXPECT_EQ(r.take(off(2, 0, 0, 3e4)), Status::kOk) << "it stays: a motor that lets go";
  EXPECT_EQ(r.s.joints(), 0);
  EXPECT_EQ(r.s.torque({}), Vec<3>(0, 0, 3e4));
}

TEST(Sampling, LeavesOutATorqueReadAtAnInstantThatJumps) {
  Sampling<3> s(0.05, limits_of(WallMoBot3()), TorqueSampling::kInstant);
  Measurement<3> y;
  s.accept(y);
  y.t = 1e-3;
  EXPECT_EQ(s.accept(y), Status::kOk);
  y.t = 2e-3, y.tau[0] = 3e4;
  EXPECT_EQ(s.accept(y), Status::kJump);
  y.t = 3e-3, y.tau[0] = 0;
  EXPECT_EQ(s.accept(y), Status::kOk);
  y.t = 4e-3, y.tau[0] = 100;
  EXPECT_EQ(s.accept(y), Status::kOk);
  EXPECT_EQ(s.torque(y), Vec<3>(50, 0, 0));
}

TEST(Sampling, BelievesABlowAtTheSecondSample) {
  AtRest r;
  EXPECT_EQ(r.take(off(1, 0, 0.5, 0)), Status::kJump);
  EXPECT_EQ(r.take(off(1, 0.0005, 0.5, 0)), Status::kOk);
  EXPECT_NEAR(r.s.h(), 2e-3, 1e-12);
}

TEST(Sampling, DoesNotTakeTwoOutliersForABlow) {
  for (const auto& [a, b] : {std::pair(off(0, 0, 5, 0), off(1, 0, 5, 0)),
                             {off(1, 0, 5, 0), off(1, 0, -5, 0)},
                             {off(1, 0.1, 0, 0), off(1, 0, 5, 0)},
                             {off(1, 0, 0.3, 0), off(1, 0, 9, 0)}}) {
    AtRest r;
    EXPECT_EQ(r.take(a), Status::kJump);
    EXPECT_EQ(r.take(b), Status::kJump);
    EXPECT_EQ(r.take(), Status::kOk);
  }
}

TEST(Sampling, LearnsHowRoughASensorIs) {
  AtRest r;
  std::mt19937 generator(1);
  const auto noise = [&] { return 0.4 * (generator() % 2001 / 1000. - 1); };  // [rad/s]
  int used_late = 0;
  for (int k = 0; k < 3000; ++k) {
    const Status s = r.take(off(1, 1e-6 * (k % 2), noise(), 0));
    used_late += k >= 1000 && s == Status::kOk;
  }
  EXPECT_GT(used_late, 1980);
  EXPECT_EQ(r.take(off(1, 0, 20, 0)), Status::kJump);
  AtRest damaged;  // every fifth sample
  for (int k = 0; k < 1000; ++k) {
    EXPECT_EQ(damaged.take(off(1, 0, k % 5 == 0 ? 1 + k % 7 : 0, 0)),
              k % 5 == 0 ? Status::kJump : Status::kOk)
        << k;
  }
}

TEST(Sampling, StartsAnewWhereTheNextSampleSaysOtherwise) {
  for (const auto& y : {off(1, 0.1, 0, 0), off(1, 0, 0.5, 0), off(1, 0, 0, 1e4)}) {
    AtRest r;
    r.s.reset();
    EXPECT_EQ(r.take(y), Status::kStarted);
    EXPECT_EQ(r.take(), Status::kStarted);
    EXPECT_EQ(r.take(), Status::kOk);
  }
}

TEST(Sampling, TurnsWithAnEncoderThatWraps) {
  AtRest r;
  const double turn = 6.283185307179586;
  r.at[1] = -turn;
  EXPECT_EQ(r.take(), Status::kOk);
  EXPECT_TRUE(r.s.wrapped());
  EXPECT_EQ(r.s.turns(), Vec<3>(0, -turn, 0));
  EXPECT_EQ(r.s.joints(), 2);
  EXPECT_EQ(r.take(), Status::kOk);
  EXPECT_FALSE(r.s.wrapped());
  EXPECT_EQ(r.s.joints(), 0);
  r.at[1] = 0.01;  // by a turn and more than the arm can have moved
  EXPECT_EQ(r.take(), Status::kJump);
}

TEST(Sampling, TakesANewPositionAtTheThirdSample) {
  AtRest r;
  r.at[1] = 0.1;
  EXPECT_EQ(r.take(), Status::kJump);
  EXPECT_EQ(r.take(), Status::kJump);
  EXPECT_EQ(r.take(), Status::kStarted);
  EXPECT_EQ(r.take(), Status::kOk);
}

TEST(Limits, AreThoseThatTheArmHasOrFollowFromItsModel) {
  struct Limited : WallMoBot3 {
    ArmLimits<3> limits() const { return {.qd = {1, 2, 3}}; }
  };
  EXPECT_EQ(limits_of(Limited()).qd, Vec<3>(1, 2, 3));
  // (37): gravity at most theta_2 g, inertia theta_1, whatever the pose
  const Testbed1::Parameters p;
  const double g = p.g * std::hypot(p.theta2, p.theta3), scale = g + 5 * p.theta1;
  const ArmLimits<1> l = limits_of(Testbed1());
  EXPECT_NEAR(l.dtau[0], 0.15 * scale, 0.02 * scale);
  EXPECT_NEAR(l.tau[0], 55 * scale, 0.05 * 55 * scale);
  EXPECT_NEAR(l.qdd[0], 20 + 2 * g / p.theta1, 0.05 * g / p.theta1);
}

TEST(Limits, ThatLetNothingPassOrSayNothingAreRefused) {
  struct Limited : WallMoBot3 {
    ArmLimits<3> limits() const { return of; }
    ArmLimits<3> of;
  };
  Limited arm;
  EXPECT_NO_THROW(limits_of(arm));
  arm.of.q_least[2] = 2 * kMeasurementLimit;
  EXPECT_THROW(limits_of(arm), std::invalid_argument);
  for (auto member : {&ArmLimits<3>::q_most, &ArmLimits<3>::qd, &ArmLimits<3>::tau,
                      &ArmLimits<3>::qdd, &ArmLimits<3>::dtau}) {
    arm.of = {};
    (arm.of.*member)[1] = std::nan("");
    EXPECT_THROW(limits_of(arm), std::invalid_argument);
  }
}

TEST(Limits, SlidesHaveNoTurns) {
  struct Sliding : WallMoBot3 {
    Mat<3> inertia(const Vec<3>& q) const noexcept { return (2 + q[1]) * Mat<3>::Identity(); }
  };
  EXPECT_EQ(limits_of(WallMoBot3()).turns, 0xff);
  EXPECT_EQ(limits_of(Sliding()).turns, 0xff & ~2);
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
  EXPECT_THROW(PanTompkins(3, {.stride = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace tauext::test

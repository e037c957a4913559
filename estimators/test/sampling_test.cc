// SPDX-License-Identifier: Apache-2.0
#include "estimators/sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "estimators/detectors/pan_tompkins.h"
#include "estimators/ekf.h"
#include "estimators/inverse_dynamics.h"
#include "estimators/ndob.h"
#include "estimators/test/arm.h"
#include "estimators/testbed1.h"
#include "estimators/wallmobot3.h"

namespace tauext::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// what a clock makes of these times
std::vector<Status> judged(const std::vector<double>& times, double max_gap = 0.05) {
  Clock clock(max_gap);
  std::vector<Status> all;
  for (const double t : times) all.push_back(clock.accept(t));
  return all;
}

// 1 kHz from t on
std::vector<double> ticks(int n, double t = 0) {
  std::vector<double> all;
  for (int k = 0; k < n; ++k) all.push_back(t + k * 1e-3);
  return all;
}

std::vector<double> operator+(std::vector<double> a, const std::vector<double>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(Clock, StartsOnceThenSteps) {
  Clock clock(0.05);
  EXPECT_EQ(clock.accept(3), Status::kStarted);
  EXPECT_EQ(clock.accept(3.001), Status::kOk);
  EXPECT_DOUBLE_EQ(clock.h(), 3.001 - 3);
  clock.reset();
  EXPECT_EQ(clock.accept(1), Status::kStarted);
}

TEST(Clock, LosesOneOutlierAndNothingElse) {
  for (const double odd : {1e9, 1.01, 0.02, 0.0499, 0.009, -3600., 0.0, kNaN, kInfinity}) {
    const auto all = judged(ticks(10) + std::vector{odd} + ticks(10, 0.011));
    EXPECT_EQ(all[10], Status::kBadTime) << odd;
    EXPECT_EQ(std::count(all.begin(), all.end(), Status::kOk), 19) << odd;
  }
}

TEST(Clock, TakesANewOneAtTheThirdSample) {
  for (const double start : {-3600., 0.003, 1., 1e9, 1.7e9}) {
    const auto all = judged(ticks(10) + ticks(10, start));
    EXPECT_EQ(all[10], Status::kBadTime) << start;
    EXPECT_EQ(all[11], Status::kBadTime) << start;
    EXPECT_EQ(all[12], Status::kStarted) << start;
    EXPECT_EQ(all[13], Status::kOk) << start;
  }
}

TEST(Clock, DoesNotFollowOneThatIsNone) {
  std::vector<double> milliseconds, still(20, 0.009);
  for (int k = 0; k < 20; ++k) milliseconds.push_back(k);
  const auto of_ms = judged(milliseconds);
  EXPECT_EQ(std::count(of_ms.begin(), of_ms.end(), Status::kOk), 0);
  EXPECT_EQ(std::count(of_ms.begin(), of_ms.end(), Status::kStarted), 1);
  const auto all = judged(ticks(10) + still + ticks(10, 0.010));
  for (int k = 10; k < 30; ++k) EXPECT_EQ(all[k], Status::kBadTime) << k;
  EXPECT_EQ(all[30], Status::kOk);
}

TEST(Clock, KnowsASlowerOrFasterOneAgain) {
  std::vector<double> slow, fast;
  for (int k = 1; k <= 20; ++k) slow.push_back(0.009 + k * 0.02);
  for (int k = 1; k <= 20; ++k) fast.push_back(0.009 + k * 1e-4);
  const auto slower = judged(ticks(10) + slow), faster = judged(ticks(10) + fast);
  EXPECT_EQ(slower[12], Status::kStarted);
  EXPECT_EQ(std::count(slower.begin() + 13, slower.end(), Status::kOk), 17);
  EXPECT_EQ(std::count(faster.begin() + 10, faster.end(), Status::kOk), 20);
}

TEST(Clock, BearsJitterAndLostPackets) {
  std::vector<double> t;
  for (int k = 0; k < 10000; ++k) {
    if (k % 97 < 3) continue;
    t.push_back(k * 1e-3 + 0.45e-3 * std::sin(13. * k));
  }
  const auto all = judged(t);
  EXPECT_EQ(std::count(all.begin(), all.end(), Status::kOk), std::ssize(t) - 1);
}

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

Measurement<3> off(int joint, double q, double qd, double tau) {
  Measurement<3> y;
  y.q[joint] = q, y.qd[joint] = qd, y.tau[joint] = tau;
  return y;
}

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

TEST(Sampling, SaysWhenAMovingJointStandsStill) {
  AtRest r;
  const Measurement<3> moving = off(1, 0.004, 0.06, 0);
  std::vector<Status> all;
  for (int k = 0; k < 500; ++k) all.push_back(r.take(moving));
  EXPECT_EQ(std::count(all.begin(), all.end(), Status::kFrozen), 500 - 9)
      << "0.5 mrad / 0.06 rad/s";
  EXPECT_EQ(r.s.joints(), 2);
  EXPECT_EQ(r.take(off(1, 0.1, 0.2, 0)), Status::kBadTime) << "half a second later";
  EXPECT_EQ(r.take(off(1, 0.1, 0.2, 0)), Status::kBadTime);
  EXPECT_EQ(r.take(off(1, 0.1, 0.2, 0)), Status::kStarted);
  AtRest at_rest;  // no joint says that it moves
  for (int k = 0; k < 500; ++k) EXPECT_EQ(at_rest.take(), Status::kOk);
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

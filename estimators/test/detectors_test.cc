// SPDX-License-Identifier: Apache-2.0
// Detectors against closed forms of what they compute; what all of them share:
// bench/kit/conformance.h.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "estimators/detectors/band_pass.h"
#include "estimators/detectors/clamping.h"
#include "estimators/detectors/contact_classifier.h"
#include "estimators/detectors/cusum.h"
#include "estimators/detectors/dynamic_threshold.h"
#include "estimators/detectors/energy.h"
#include "estimators/detectors/glr.h"
#include "estimators/detectors/high_pass.h"
#include "estimators/detectors/pan_tompkins.h"
#include "estimators/detectors/threshold.h"
#include "estimators/test/arm.h"
#include "estimators/testbed1.h"

namespace tauext::test {
namespace {

using Load = std::function<double(double)>;  // of time [s], on joint 1; the others bear 0

Vec<3> on_joint_1(double x) {
  return {x, 0, 0};
}

// time of the first mark until `until`, or -1
template <class D>
double first_mark(D d, const Load& load, double until = 3, double Ts = 1e-3) {
  for (int k = 0; k * Ts < until; ++k) {
    const double t = k * Ts;
    const Vec<3> rest = Vec<3>::Zero();
    if (detect(d, t, rest, rest, on_joint_1(load(t))).mark) return t;
  }
  return -1;
}

// 0 before 0.5 s, then `height`
Load step(double height) {
  return [=](double t) { return t < 0.5 - 1e-9 ? 0 : height; };
}

TEST(Threshold, MarksWhereALoadReachesItsLimitAndNotBelow) {
  const Threshold d(3, {.threshold = Vec<3>::Constant(100)});
  EXPECT_EQ(first_mark(d, step(99.9)), -1);
  EXPECT_DOUBLE_EQ(first_mark(d, step(-100.1)), 0.5);
  EXPECT_NEAR(first_mark(d, [](double t) { return 50 * t; }), 2, 1.1e-3) << "a ramp";
}

TEST(DynamicThreshold, HasTwiceTheLimitAtItsSpeed) {
  DynamicThreshold d(3, {.threshold = Vec<3>::Constant(100), .speed = 0.4});
  Measurement<3> y;
  const auto score = [&](double qd) {
    y.t += 1e-3;
    y.qd = Vec<3>(qd, 0, 0);
    return detect(d, y.t, y.qd, y.tau, on_joint_1(100)).score;
  };
  EXPECT_DOUBLE_EQ(score(0), 1);
  EXPECT_DOUBLE_EQ(score(0.4), 0.5);
  EXPECT_DOUBLE_EQ(score(-1.2), 0.25);
}

TEST(DynamicThreshold, LeavesOutTheShareOfTheTorqueThatMayBeWrong) {
  DynamicThreshold d(3, {.threshold = Vec<3>::Constant(100), .speed = 1e6, .share = 0.1});
  Measurement<3> y;
  y.tau = Vec<3>(-400, 1e4, 0);  // joint 2 bears much, and sees nothing
  EXPECT_NEAR(detect(d, y.t, y.qd, y.tau, on_joint_1(90)).score, 0.5, 1e-12);
  EXPECT_NEAR(d.statistic()[0], 50, 1e-9);
  EXPECT_EQ(d.statistic()[1], 0);
}

TEST(HighPass, AnswersAStepByExp) {
  HighPass d(3, {.threshold = Vec<3>::Constant(1000), .w = 10});
  d.update(0, on_joint_1(0));
  for (int k = 1; k < 400; ++k) {
    d.update(k * 1e-3, on_joint_1(50));
    EXPECT_NEAR(d.statistic()[0], 50 * std::exp(-10 * (k - 1) * 1e-3), 1e-9);
  }
}

TEST(BandPass, AnswersAStepByTheDifferenceOfTwoExp) {
  constexpr double kLow = 10, kHigh = 100;
  BandPass d(3, {.threshold = Vec<3>::Constant(1000), .w_low = kLow, .w_high = kHigh});
  constexpr double kTs =
      1e-5;  // the high-pass's answer is held over a sample: an error of kHigh kTs / 2
  d.update(0, on_joint_1(0));
  for (int k = 1; k < 20000; ++k) {
    d.update(k * kTs, on_joint_1(50));
    const double t = k * kTs;
    const double closed =
        50 * kHigh / (kHigh - kLow) * (std::exp(-kLow * t) - std::exp(-kHigh * t));
    EXPECT_NEAR(d.statistic()[0], closed, 50 * kHigh * kTs);
  }
}

TEST(Cusum, MarksAStepAfterItsThresholdOverWhatIsBeyondTheDrift) {
  // a slow mean that hardly moves: S grows by (a - drift) per second
  const Cusum d(3, {.threshold = Vec<3>::Constant(0.8), .drift = Vec<3>::Constant(12), .w = 1e-3});
  for (const double a : {20., 52., -92.}) {
    EXPECT_NEAR(first_mark(d, step(a)) - 0.5, 0.8 / (std::abs(a) - 12), 2e-3) << a << " N m";
  }
  EXPECT_EQ(first_mark(d, step(11.9)), -1) << "below the drift";
}

TEST(Cusum, ForgetsASlowLoadAndDoesNotDependOnTheSamplingTime) {
  const Cusum d(3, {.threshold = Vec<3>::Constant(0.4), .drift = Vec<3>::Constant(12), .w = 20});
  // a ramp is slope / w above its mean
  EXPECT_EQ(first_mark(d, [](double t) { return 230 * t; }), -1);
  EXPECT_GT(first_mark(d, [](double t) { return 300 * t; }), 0);
  const double reference = first_mark(d, step(60));
  for (const double Ts : {0.5e-3, 2e-3}) {
    EXPECT_NEAR(first_mark(d, step(60), 3, Ts), reference, 2.1e-3);
  }
}

TEST(Cusum, TellsUpToItsMostScoreWhatAnotherOneWouldMark) {
  const auto p = [](double limit) {
    return CusumParameters{.threshold = Vec<3>::Constant(limit), .w = 1e-3, .most_score = 16};
  };
  const auto score_reaches = [&](double level) {
    Cusum d(3, p(0.1));
    for (int k = 0; k < 2000; ++k)
      if (d.update(k * 1e-3, on_joint_1(step(52)(k * 1e-3))).score >= level) return k * 1e-3;
    return -1.;
  };
  for (const double level : {2., 8., 15.9})
    EXPECT_EQ(score_reaches(level), first_mark(Cusum(3, p(0.1 * level)), step(52))) << level;
  EXPECT_EQ(score_reaches(16.1), -1);
}

TEST(Cusum, StartsItsMeanAnewAfterAGap) {
  // a push of 96 N m in 0.8 s, of which 0.1 s is lost
  Cusum d(3);
  for (int k = 0; k < 2000; ++k) {
    if (k >= 850 && k < 950) continue;
    const double x = std::min(std::max((k - 500) / 800., 0.), 1.);
    const double push = 96 * x * x * x * (10 + x * (6 * x - 15));
    EXPECT_FALSE(d.update(k * 1e-3, on_joint_1(push)).mark) << k;
  }
}

TEST(DynamicThreshold, MarksALoadThatRisesWithABadSpeed) {
  DynamicThreshold d(3);
  int marks = 0;
  for (int k = 0; k < 10; ++k) {
    Measurement<3> y;
    y.t = k * 1e-3;
    if (k == 5) y.qd[0] = std::numeric_limits<double>::quiet_NaN();
    marks += detect(d, y.t, y.qd, y.tau, on_joint_1(k < 5 ? 0 : 300)).mark;
  }
  EXPECT_EQ(marks, 1);
}

TEST(Glr, MarksAStepWhereItsHeightTimesTheRootOfWhatHasPassedReachesTheThreshold) {
  // after 64 samples the span of 64, the longest below 0.1 s, has all of the step;
  constexpr double kHeight = 30;
  // and the slow mean takes less than 1e-4 of it
  const Glr d(3,
              {.threshold = Vec<3>::Constant(kHeight * std::sqrt(0.064) * (1 - 2e-4)), .w = 1e-3});
  EXPECT_NEAR(first_mark(d, step(kHeight)) - 0.5, 0.063, 1e-9);
  EXPECT_EQ(first_mark(d, step(0.99 * kHeight)), -1);
  EXPECT_NEAR(first_mark(d, step(-2 * kHeight)) - 0.5, 0.015, 1.1e-3);
}

TEST(Glr, FindsShortAndLongTouchesOfOneEnergyAlike) {
  // a^2 T is the same, and so is g: at 1 kHz as at 2 kHz
  for (const double Ts : {1e-3, 0.5e-3}) {
    for (const double T : {0.004, 0.016, 0.064}) {
      Glr d(3, {.w = 1e-3});
      double most = 0;
      for (int k = 0; k * Ts < 1; ++k) {
        const double t = k * Ts;
        d.update(t, on_joint_1(t > 0.5 - Ts / 2 && t < 0.5 + T - Ts / 2 ? 5 / std::sqrt(T) : 0));
        most = std::max(most, d.statistic()[0]);
      }
      EXPECT_NEAR(most, 5, 0.01) << T << " s, every " << Ts;
    }
  }
}

TEST(Energy, IsTheFilteredPowerOfTheContact) {
  constexpr double kW = 60, kSpeed = 0.4, kLoad = 50;
  Energy d(3, {.threshold = Vec<3>::Constant(1e3), .w = kW});
  Measurement<3> y;
  y.qd[0] = kSpeed;
  detect(d, y.t, y.qd, y.tau, on_joint_1(0));
  for (int k = 1; k < 300; ++k) {
    y.t = k * 1e-3;
    detect(d, y.t, y.qd, y.tau, on_joint_1(-kLoad));
    const double power = kSpeed * kLoad * (1 - std::exp(-kW * (k - 1) * 1e-3));
    ASSERT_NEAR(d.statistic()[0], power, 1e-9);
    ASSERT_EQ(d.statistic()[0], d.statistic()[2]) << "one number for the arm";
  }
}

TEST(Energy, IsWhatTheBalanceOfKineticEnergySays) {
  // (i) as it is printed, by the trapezoidal rule, with the sign of (3)
  const Testbed1 arm({.theta4 = 0});
  constexpr double kW = 40, h = 0.1e-3;
  const auto load = [](double t) -> Vec<1> { return Vec<1>(t < 0.5 ? 0 : 8 * std::sin(7 * t)); };
  Energy d(1, {.threshold = Vec<1>::Constant(1e3), .w = kW});
  double begun = 0, integral = 0, rate = 0, r = 0;
  bool first = true;
  for (const auto& y : simulate<Testbed1>(grid(2, h), load, {.amplitude = 0.3, .w = 3}, arm)) {
    detect(d, y.t, y.qd, y.tau, load(y.t));
    const double kinetic = 0.5 * y.qd.dot(arm.inertia(y.q) * y.qd);
    const double now = y.qd.dot(y.tau - arm.gravity(y.q) - arm.friction(y.qd));
    if (first) begun = kinetic;
    if (!first) integral += 0.5 * h * (rate + now) - h * r;
    first = false;
    rate = now;
    r = kW * (begun + integral - kinetic);
    ASSERT_NEAR(std::abs(r), d.statistic()[0], 0.02) << "W at t = " << y.t;
  }
  EXPECT_GT(d.statistic()[0], 0.2);
}

Clamping::Parameters clamping() {
  return {.threshold = Vec<3>::Constant(100), .start_up = 0.4};
}

TEST(Clamping, MarksWhatLastsAfterItsDuration) {
  // a step of 200 through 100 rad/s passes 100 after 7 ms, and has to stay there for 0.1 s
  const double t = first_mark(Clamping(3, clamping()), step(200));
  EXPECT_GT(t, 0.5 + 0.1);
  EXPECT_LT(t, 0.5 + 0.1 + 0.03);
}

TEST(Clamping, LetsABlowPassHoweverHard) {
  const auto blow = [](double t) {
    return t < 0.5 || t > 0.55 ? 0 : 1000 * std::sin(std::numbers::pi * (t - 0.5) / 0.05);
  };
  EXPECT_EQ(first_mark(Clamping(3, clamping()), blow), -1);
}

TEST(Clamping, LetsAPayloadPassThatWasThereAndOneThatChangesSlowly) {
  EXPECT_EQ(first_mark(
                Clamping(3, clamping()), [](double) { return 1500; }, 5),
            -1);
  // the high-pass leaves 0.89 of a sine at 1 rad/s
  const auto swings = [](double amplitude) {
    return [=](double t) { return 1500 + amplitude * std::sin(t); };
  };
  EXPECT_EQ(first_mark(Clamping(3, clamping()), swings(90), 20), -1);
  EXPECT_GT(first_mark(Clamping(3, clamping()), swings(150), 20), 0);
}

TEST(Clamping, FollowsALoadThatStaysWithItsBaseline) {
  Clamping d(3, clamping());
  for (int k = 0; k < 3000; ++k) d.update(k * 1e-3, on_joint_1(k < 500 ? 0 : 80));
  EXPECT_NEAR(d.change()[0], 80 * std::exp(-0.5 * 2.5), 0.5) << "2.5 s after the step";
}

TEST(Clamping, WeighsDirectionsByItsMetric) {
  auto p = clamping();
  p.metric = Vec<3>(0.04, 1, 1).asDiagonal();  // joint 1 counts a fifth
  EXPECT_EQ(first_mark(Clamping(3, p), step(400)), -1);
  EXPECT_GT(first_mark(Clamping(3, p), step(600)), 0);
  p.metric(0, 1) = 0.1;
  EXPECT_THROW(Clamping(3, p), std::invalid_argument) << "not symmetric";
  p.metric = Vec<3>(1, -1, 1).asDiagonal();
  EXPECT_THROW(Clamping(3, p), std::invalid_argument) << "not positive definite";
}

TEST(Detectors, RefuseThresholdsAndCutOffsOfZero) {
  const Vec<3> zero = Vec<3>::Zero();
  EXPECT_THROW(Threshold(3, {.threshold = zero}), std::invalid_argument);
  EXPECT_THROW(DynamicThreshold(3, {.threshold = zero}), std::invalid_argument);
  EXPECT_THROW(DynamicThreshold(3, {.speed = 0}), std::invalid_argument);
  EXPECT_THROW(HighPass(3, {.threshold = zero}), std::invalid_argument);
  EXPECT_THROW(HighPass(3, {.w = 0}), std::invalid_argument);
  EXPECT_THROW(BandPass(3, {.w_low = 100, .w_high = 10}), std::invalid_argument);
  EXPECT_THROW(Cusum(3, {.drift = Vec<3>::Constant(-1)}), std::invalid_argument);
  EXPECT_THROW(Clamping(3, {.duration = 0}), std::invalid_argument);
}

template <class D>
class EveryDetector : public testing::Test {};
using Calibratable = testing::Types<Threshold, DynamicThreshold, HighPass, BandPass, Cusum, Glr,
                                    Energy, Clamping, PanTompkins>;
TYPED_TEST_SUITE(EveryDetector, Calibratable);

TYPED_TEST(EveryDetector, RefusesAThresholdThatIsNoPositiveNumber) {
  for (const double bad : {0., -1., std::numeric_limits<double>::quiet_NaN()}) {
    for (int j = 0; j < 3; ++j) {
      typename TypeParam::Parameters p;
      p.threshold = Vec<3>::Constant(p.threshold[0]);
      p.threshold[j] = bad;
      EXPECT_THROW(TypeParam(3, p), std::invalid_argument) << bad << " on joint " << j + 1;
    }
  }
}

TYPED_TEST(EveryDetector, DetectsNothingInEstimatesOfAnotherNumberOfJoints) {
  for (const int joints : {1, 2, 4, 8}) {
    TypeParam d(3);
    ContactClassifier both(3);
    for (int k = 0; k < 1000; ++k) {
      const JointVec<> x = JointVec<>::Constant(joints, k < 500 ? 0 : 1e6);
      EXPECT_EQ(detect(d, k * 1e-3, x, x, x).score, 0) << joints;
      EXPECT_EQ(detect(both, k * 1e-3, x, x, x).score, 0) << joints;
    }
  }
}

TYPED_TEST(EveryDetector, RefusesAnotherNumberOfThresholdsThanOfJoints) {
  typename TypeParam::Parameters p;
  p.threshold = Vec<2>::Constant(p.threshold[0]);
  EXPECT_THROW(TypeParam(3, p), std::invalid_argument);
  EXPECT_NO_THROW(TypeParam(2, p));
  EXPECT_THROW(TypeParam(0), std::invalid_argument);
  EXPECT_THROW(TypeParam(9), std::invalid_argument);
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "estimators/samples/clock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "estimators/test/arm.h"

namespace tauext::test {
namespace {

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
  for (const double odd : {1e9, 1.01, 0.02, 0.0499, 0.009, -3600., 0.0, kNaN, HUGE_VAL}) {
    const auto all = judged(ticks(10) + std::vector{odd} + ticks(10, 0.011));
    EXPECT_EQ(all[10], Status::kBadTime) << odd;
    EXPECT_EQ(std::count(all.begin(), all.end(), Status::kOk), 19) << odd;
  }
}

TEST(Clock, DoesNotTrustTheFirstStampAlone) {
  const auto all = judged(std::vector{-0.04} + ticks(10));
  EXPECT_EQ(all[0], Status::kStarted);
  EXPECT_EQ(all[2], Status::kStarted);
  EXPECT_EQ(std::count(all.begin() + 3, all.end(), Status::kOk), 8);
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

TEST(StepChange, TakesTheLastBitsOfTimeStampsForNoChange) {
  StepChange<> changed;
  int changes = 0;
  for (int k = 1; k < 100000; ++k) changes += changed(k * 1e-3 - (k - 1) * 1e-3);
  EXPECT_EQ(changes, 1);
  EXPECT_TRUE(changed(1.00001e-3));
  EXPECT_FALSE(changed(1.00001e-3));
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "regression/time/verdict.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace tauext::gate {
namespace {

// n layouts, every other one so much above and below the ratio
std::vector<LayoutRatios> around(int n, double ratio, double off) {
  std::vector<LayoutRatios> all;
  for (int i = 0; i < n; ++i) {
    all.push_back({ratio * std::exp(i % 2 == 0 ? off : -off), 1, 1.05});
  }
  return all;
}

Verdict verdict(const std::vector<LayoutRatios>& all, int kernels = 52) {
  return judge(all, TimeLimits(), kernels).verdict;
}

TEST(Median, OfOddAndEvenNumbers) {
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 2, 3}), 2.5);
  EXPECT_THROW(median({}), std::logic_error);
}

// of the tables in Abramowitz and Stegun, 26.10
TEST(Student, AsInTables) {
  EXPECT_NEAR(student_quantile(0.975, 1), 12.706, 5e-4);
  EXPECT_NEAR(student_quantile(0.975, 2), 4.303, 5e-4);
  EXPECT_NEAR(student_quantile(0.975, 7), 2.365, 5e-4);
  EXPECT_NEAR(student_quantile(0.99, 15), 2.602, 5e-4);
  EXPECT_NEAR(student_quantile(0.995, 30), 2.750, 5e-4);
  EXPECT_NEAR(student_quantile(0.9995, 60), 3.460, 5e-4);
}

TEST(Judge, PassesWhatIsAsFastOrFaster) {
  EXPECT_EQ(verdict(around(8, 1, 0.01)), Verdict::kPass);
  EXPECT_EQ(verdict(around(8, 0.5, 0.1)), Verdict::kPass) << "faster is no failure";
  EXPECT_EQ(verdict(around(8, 1.008, 0.005)), Verdict::kPass) << "below the limit";
}

TEST(Judge, FailsWhatIsSlowerOnlyAfterASecondStage) {
  EXPECT_EQ(verdict(around(8, 1.05, 0.003)), Verdict::kInconclusive);
  EXPECT_EQ(verdict(around(16, 1.05, 0.003)), Verdict::kFail);
}

// the interval of 16 layouts with s = .003 * sqrt(16 / 15) is m - 4.5481 s / 4 at .01 / 52
TEST(Judge, FailsWhereItIsSurelySlowerThanOnePercent) {
  const double s = 0.003 * std::sqrt(16 / 15.), edge = 0.01 + 4.54814 * s / 4;
  EXPECT_EQ(verdict(around(16, std::exp(edge + 1e-4), 0.003)), Verdict::kFail);
  EXPECT_NE(verdict(around(16, std::exp(edge - 1e-4), 0.003)), Verdict::kFail);
  EXPECT_EQ(verdict(around(16, std::exp(edge - 1e-4), 0.003), 26), Verdict::kFail)
      << "fewer kernels, of which one could be unlucky";
}

TEST(Judge, BelievesNoSpreadThatIsTooSmallToBeTrue) {
  // at a least sd of .0015 the edge is 1.0170 for 16 layouts
  EXPECT_EQ(verdict(around(16, std::exp(0.01 + 4.54814 * 0.0015 / 4 + 1e-4), 0)), Verdict::kFail);
  EXPECT_NE(verdict(around(16, std::exp(0.01 + 4.54814 * 0.0015 / 4 - 1e-4), 0)), Verdict::kFail);
}

TEST(Judge, PassesBelowTwoPercentAtItsUpperBound) {
  const double s = 0.003 * std::sqrt(8 / 7.), edge = std::log(1.02) - 2.36462 * s / std::sqrt(8);
  EXPECT_EQ(verdict(around(8, std::exp(edge - 1e-4), 0.003)), Verdict::kPass);
  EXPECT_EQ(verdict(around(8, std::exp(edge + 1e-4), 0.003)), Verdict::kInconclusive);
}

TEST(Judge, IsContentWithThreePercentWhereLayoutsDiffer) {
  const auto wide = [](int n) { return around(n, 1.01, 0.03); };
  EXPECT_EQ(verdict(wide(16)), Verdict::kInconclusive);
  EXPECT_EQ(verdict(wide(32)), Verdict::kPass) << "at most 2.5 %";
  EXPECT_EQ(verdict(around(32, 1.016, 0.03)), Verdict::kInconclusive) << "the mean is too large";
  EXPECT_EQ(verdict(around(32, 1.01, 0.08)), Verdict::kInconclusive) << "the bound is too large";
}

TEST(Judge, GivesTheMeanItsIntervalAndWhatLayoutsDiffer) {
  const TimeVerdict v = judge(around(8, 1.002, 0.004), TimeLimits(), 52);
  EXPECT_NEAR(v.ratio, 1.002, 1e-12);
  EXPECT_NEAR(v.layout_sd, 0.004 * std::sqrt(8 / 7.), 1e-12);
  EXPECT_NEAR(std::log(v.high / v.ratio), 2.36462 * v.layout_sd / std::sqrt(8), 1e-7);
  EXPECT_NEAR(v.high / v.ratio, v.ratio / v.low, 1e-12);
  EXPECT_EQ(v.layouts, 8);
}

TEST(Judge, NeverFailsWhereACopyIsOffByHalfTheLimit) {
  for (const double aa : {0.985, 1.015, std::numeric_limits<double>::quiet_NaN()}) {
    auto all = around(16, 1.10, 0.01);
    for (LayoutRatios& r : all) r.aa = aa;
    const TimeVerdict v = judge(all, TimeLimits(), 52);
    EXPECT_EQ(v.verdict, Verdict::kInconclusive) << aa;
    EXPECT_FALSE(v.harness_error);
  }
}

TEST(Judge, CallsItAHarnessErrorWhenAnInjectedSlowdownIsNotSeen) {
  for (const double head : {1., 1.1}) {
    auto all = around(16, head, 0.001);
    for (LayoutRatios& r : all) r.canary = 1.01;
    const TimeVerdict v = judge(all, TimeLimits(), 52);
    EXPECT_EQ(v.verdict, Verdict::kInconclusive);
    EXPECT_TRUE(v.harness_error);
  }
}

TEST(Judge, RefusesFewerLayoutsThanAStage) {
  EXPECT_THROW(judge({}, TimeLimits(), 1), std::logic_error);
  EXPECT_THROW(judge(around(7, 1, 0.01), TimeLimits(), 1), std::logic_error);
}

}  // namespace
}  // namespace tauext::gate

// SPDX-License-Identifier: Apache-2.0
#include "regression/time/verdict.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace tauext::gate {
namespace {

// n processes whose ratios lie evenly between the two
std::vector<ProcessRatios> spread(int n, double from, double to) {
  std::vector<ProcessRatios> all;
  for (int i = 0; i < n; ++i) all.push_back({from + (to - from) * i / (n - 1), 1, 1.05});
  return all;
}

std::vector<ProcessRatios> operator+(std::vector<ProcessRatios> a,
                                     const std::vector<ProcessRatios>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Verdict verdict(const std::vector<ProcessRatios>& all) {
  return judge(all, TimeLimits()).verdict;
}

TEST(Median, OfOddAndEvenNumbers) {
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 2, 3}), 2.5);
  EXPECT_THROW(median({}), std::logic_error);
}

TEST(Judge, PassesWhatIsAsFastOrFaster) {
  EXPECT_EQ(verdict(spread(10, 0.99, 1.01)), Verdict::kPass);
  EXPECT_EQ(verdict(spread(10, 0.5, 0.6)), Verdict::kPass) << "faster is no failure";
  EXPECT_EQ(verdict(spread(10, 1.010, 1.015)), Verdict::kPass) << "below the limit";
}

TEST(Judge, FailsWhatIsSlowerOnlyAfterASecondStage) {
  const auto slow = spread(10, 1.04, 1.06);
  EXPECT_EQ(verdict(slow), Verdict::kInconclusive);
  EXPECT_EQ(verdict(slow + slow), Verdict::kFail);
  EXPECT_EQ(verdict(slow + spread(10, 0.99, 1.01)), Verdict::kInconclusive)
      << "the later processes do not confirm it";
}

TEST(Judge, WithAFirstStageThatIsNotSlowerWantsALargerOne) {
  const auto unsure = spread(10, 1.001, 1.025), slow = spread(10, 1.025, 1.04);
  EXPECT_EQ(verdict(unsure + slow), Verdict::kInconclusive);
  EXPECT_EQ(verdict(unsure + slow + slow + slow), Verdict::kFail);
}

TEST(Judge, HasItsLimitAtTwoPercent) {
  EXPECT_EQ(verdict(spread(20, 1.0201, 1.0202)), Verdict::kFail);
  EXPECT_EQ(verdict(spread(20, 1.0198, 1.0199)), Verdict::kPass);
}

TEST(Judge, IsNotSureWhenTheIntervalHoldsTheLimit) {
  EXPECT_EQ(verdict(spread(10, 0.98, 1.05)), Verdict::kInconclusive);
  EXPECT_EQ(verdict(spread(40, 0.95, 1.10)), Verdict::kInconclusive)
      << "median above, but a third of the processes are faster";
}

TEST(Judge, GivesTheThirdOfTenAsItsInterval) {
  const TimeVerdict v = judge(spread(10, 1.000, 1.009), TimeLimits());
  EXPECT_NEAR(v.low, 1.002, 1e-12);
  EXPECT_NEAR(v.high, 1.007, 1e-12);
  EXPECT_NEAR(v.median, 1.0045, 1e-12);
}

TEST(Judge, NeverFailsWhereACopyIsOffByHalfTheLimit) {
  for (const double aa : {0.985, 1.015, std::numeric_limits<double>::quiet_NaN()}) {
    auto all = spread(20, 1.10, 1.12);
    for (ProcessRatios& r : all) r.aa = aa;
    const TimeVerdict v = judge(all, TimeLimits());
    EXPECT_EQ(v.verdict, Verdict::kInconclusive) << aa;
    EXPECT_FALSE(v.harness_error);
  }
}

TEST(Judge, CallsItAHarnessErrorWhenAnInjectedSlowdownIsNotSeen) {
  for (const double head : {1., 1.1}) {
    auto all = spread(20, head, head + 0.001);
    for (ProcessRatios& r : all) r.canary = 1.01;
    const TimeVerdict v = judge(all, TimeLimits());
    EXPECT_EQ(v.verdict, Verdict::kInconclusive);
    EXPECT_TRUE(v.harness_error);
  }
}

TEST(Judge, RefusesFewerProcessesThanAStage) {
  EXPECT_THROW(judge({}, TimeLimits()), std::logic_error);
  EXPECT_THROW(judge(spread(9, 1, 1), TimeLimits()), std::logic_error);
}

}  // namespace
}  // namespace tauext::gate

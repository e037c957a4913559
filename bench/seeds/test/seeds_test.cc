// SPDX-License-Identifier: Apache-2.0
#include "bench/seeds/seeds.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/roster/robots.h"
#include "bench/seeds/golden.h"
#include "bench/seeds/seed_tables.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

TEST(StudentT, IsThatOfTheTables) {
  // Abramowitz and Stegun, table 26.10
  for (const auto& [n, t] :
       {std::pair(1, 12.706), std::pair(2, 4.303), std::pair(3, 3.182), std::pair(4, 2.776),
        std::pair(9, 2.262), std::pair(29, 2.045), std::pair(120, 1.980)})
    EXPECT_NEAR(student_t(n), t, 6e-4) << n;
}

TEST(SeedFigure, OfFiveValuesByHand) {
  const SeedFigure f = figure_of({1, 2, 3, 4, 5});  // s = sqrt(2.5)
  EXPECT_DOUBLE_EQ(f.mean, 3);
  EXPECT_NEAR(f.interval.high - 3, 2.776445 * std::sqrt(2.5 / 5), 1e-3);
  EXPECT_NEAR(f.interval.low + f.interval.high, 6, 1e-12);
  EXPECT_TRUE(std::isinf(figure_of({7}).interval.high)) << "one value says nothing of the spread";
}

// rows without an entry's run
SeededRow row(const std::string& estimator, std::vector<Score> scores) {
  return {Entry("wallmobot3", "step", estimator), std::move(scores)};
}
Score rmse(double value) {
  Score s;
  s.set(Metric::kRmse, value);
  return s;
}

TEST(SeedFigure, APairedDifferenceKnowsThatBothSawTheSameNoise) {
  const SeededRow a = row("mo1", {rmse(10.1), rmse(20.1), rmse(30.1)}),
                  b = row("mo2", {rmse(10), rmse(20), rmse(30)});
  const SeedFigure d = difference_of(a, b, Metric::kRmse);
  EXPECT_NEAR(d.mean, 0.1, 1e-12);
  EXPECT_LT(d.interval.high, 0.1 + 1e-9);
  EXPECT_GT(figure_of(a, Metric::kRmse).interval.high, 40) << "alone they cannot be told apart";
  const std::string text = format_seeds({a, b}, "mo2");
  EXPECT_NE(text.find("+0.100"), std::string::npos) << text;
  EXPECT_NE(text.find("*"), std::string::npos) << text;
}

TEST(SeedFigure, OfOneSeedHasNoIntervalAndTheTableSaysSo) {
  const SeededRow a = row("mo1", {rmse(1)}), b = row("mo2", {rmse(1), rmse(2)});
  EXPECT_NE(format_seeds({a}, "").find("one seed has no interval"), std::string::npos);
  EXPECT_EQ(format_seeds({b}, "").find("one seed has no interval"), std::string::npos);
}

TEST(SeedFigure, WhatNeverCameIsCountedAndNoMean) {
  SeededRow a = row("mo1", {rmse(1), rmse(2), rmse(std::nan(""))});
  const SeedFigure f = figure_of(a, Metric::kRmse);
  EXPECT_EQ(f.values, 2);
  EXPECT_EQ(f.never, 1);
  EXPECT_NE(format_seeds({a}, "mo2").find("never 1/3"), std::string::npos);
}

TEST(SeedFigure, OfARecallIsWilsonsOverAllCollisions) {
  std::vector<Score> scores(3);
  for (Score& s : scores) {
    s.collisions = 4;
    s.set(Metric::kRecall, 1);
    s.set(Metric::kFalseAlarms, 0);
  }
  const SeededRow r = row("mo1", scores);
  EXPECT_NEAR(figure_of(r, Metric::kRecall).interval.low, 12 / (12 + 1.96 * 1.96), 1e-4);
  EXPECT_NE(format_seeds({r}, "mo2").find("1.00[0.76,1.00]"), std::string::npos);
  EXPECT_NEAR(figure_of(r, Metric::kFalseAlarms).interval.high, 3.6889 / 3, 1e-3) << "Garwood";
}

#ifndef TAUEXT_SANITIZED  // it would take half a minute, of what tests of the suite do, too
TEST(ScoreOverSeeds, IsTheSuiteAtEachSeed) {
  SeedOptions o;
  o.suite.sensors = golden_sensors();
  o.entries = {Entry("wallmobot3", "free", "mo1"), Entry("wallmobot3", "ramp", "mo2"),
               Entry("wallmobot3", "free", "mo2")};
  o.seeds = {3, 8};
  const std::vector<SeededRow> rows = score_over_seeds(o);
  ASSERT_EQ(rows.size(), 3u);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].entry.name(), o.entries[i].name());
    for (std::size_t s = 0; s < 2; ++s) {
      SuiteOptions one = o.suite;
      one.sensors.seed = o.seeds[s];
      EXPECT_EQ(rows[i].scores[s].by_key(), Suite(one).score(o.entries[i]).by_key());
    }
    EXPECT_NE(rows[i].scores[0].get(Metric::kRmse), rows[i].scores[1].get(Metric::kRmse));
  }
  o.seeds.clear();
  EXPECT_NE(error_of([&] { score_over_seeds(o); }).find("need a seed"), std::string::npos);
}
#endif

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "bench/live/histogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace tauext::live::test {
namespace {

TEST(HistogramTest, QuantilesAreThoseOfTheSortedValuesWithinABucket) {
  std::mt19937_64 random(1);
  std::lognormal_distribution<double> times(6, 2);
  Histogram h;
  std::vector<double> values;
  for (int i = 0; i < 20000; ++i) {
    const auto ns = static_cast<std::int64_t>(times(random));
    h.add(ns);
    values.push_back(static_cast<double>(ns));
  }
  std::sort(values.begin(), values.end());
  for (const double share : {0.01, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const double exact = values[static_cast<std::size_t>(std::ceil(share * 20000)) - 1];
    EXPECT_GE(h.quantile(share), exact * 15 / 16 - 1) << share;
    EXPECT_LE(h.quantile(share), exact * 17 / 16 + 1) << share;
  }
  EXPECT_EQ(h.quantile(1), values.back());
  EXPECT_EQ(h.largest(), values.back());
  EXPECT_EQ(h.count(), 20000u);
}

TEST(HistogramTest, TheSmallestAndTheLargestTimesHaveABucket) {
  Histogram h;
  EXPECT_EQ(h.quantile(0.5), 0);
  h.add(-5);
  EXPECT_EQ(h.quantile(1), 0);
  for (int bit = 0; bit < 63; ++bit) h.add(std::int64_t{1} << bit);
  h.add(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(h.count(), 65u);
  EXPECT_GE(h.quantile(1), 9.2e18);
}

}  // namespace
}  // namespace tauext::live::test

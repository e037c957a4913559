// SPDX-License-Identifier: Apache-2.0
#include "bench/bandwidth_study.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

TEST(EqualBandwidth, RefusesWhatTheChirpCannotSee) {
  for (const double w : {0.5, 1000., -1.}) {
    EXPECT_NE(error_of([&] { at_equal_bandwidth(w); }).find("1 to 200 can be measured"),
              std::string::npos);
  }
}

ParetoPoint point(const char* name, double design, double delay, double noise) {
  return {.estimator = name, .design = design, .noise = noise, .delay = delay};
}

TEST(Pareto, MarksWhatLiesAboveAnotherFrontAndByHowMuch) {
  // b has twice the noise of a at every delay
  std::vector<ParetoPoint> p = {point("a", 1, 0.1, 1), point("a", 2, 0.01, 10),
                                point("b", 1, 0.05, 4), point("b", 2, 0.02, 10)};
  mark_dominated(p);
  EXPECT_EQ(p[0].dominated_by, "");
  EXPECT_EQ(p[1].dominated_by, "");
  // between its points a's front is a straight line in the logarithms: noise 0.1 / delay
  EXPECT_EQ(p[2].dominated_by, "a");
  EXPECT_NEAR(p[2].excess, 4 / 2. - 1, 1e-9);
  EXPECT_EQ(p[3].dominated_by, "a");
  EXPECT_NEAR(p[3].excess, 10 / 5. - 1, 1e-9);
}

TEST(Pareto, FrontsThatCrossAreEachBestWhereTheyLieLow) {
  std::vector<ParetoPoint> p = {point("a", 1, 0.1, 1), point("a", 2, 0.01, 100),
                                point("b", 1, 0.1, 10), point("b", 2, 0.01, 20)};
  mark_dominated(p);
  EXPECT_EQ(p[0].dominated_by, "");
  EXPECT_EQ(p[1].dominated_by, "b");
  EXPECT_EQ(p[2].dominated_by, "a");
  EXPECT_EQ(p[3].dominated_by, "");
}

TEST(Pareto, BeyondAFrontsEndsNobodyIsDominated) {
  std::vector<ParetoPoint> p = {point("a", 1, 0.1, 1), point("a", 2, 0.01, 10),
                                point("b", 1, 0.005, 1000), point("c", 0, 0.2, 50)};
  mark_dominated(p);
  EXPECT_EQ(p[2].dominated_by, "");
  EXPECT_EQ(p[3].dominated_by, "a") << "a slower one is no better than the end of a's front";
}

}  // namespace
}  // namespace tauext::test

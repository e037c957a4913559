// SPDX-License-Identifier: Apache-2.0
#include "bench/bandwidth_study.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "bench/test/optimised.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

const Worth& worth(const std::vector<AtBandwidth>& rows, const std::string& name) {
  const auto it = std::find_if(rows.begin(), rows.end(),
                               [&](const AtBandwidth& r) { return r.estimator == name; });
  if (it == rows.end() || !it->worth) throw std::runtime_error(name + " has no row");
  return *it->worth;
}

TEST(EqualBandwidth, SetsEveryEstimatorToTheMeasuredBandwidth) {
  if (!kOptimised) GTEST_SKIP() << "takes minutes here; Release runs it";
  const std::vector<AtBandwidth> rows = at_equal_bandwidth(30);
  EXPECT_GE(rows.size(), 10u);
  for (const AtBandwidth& r : rows) {
    ASSERT_TRUE(r.worth) << r.estimator;
    EXPECT_NEAR(r.worth->bandwidth, 30, 0.05 * 30) << r.estimator;
    // an error of 5 % of the weight is there whatever the filter
    EXPECT_NEAR(r.worth->mass_bias, worth(rows, "mo1").mass_bias, 0.01 * r.worth->mass_bias);
  }
  // first order: the design is the bandwidth, the lag its inverse, 90 % after ln 10 times that
  for (const char* name : {"mo1", "inverse_dynamics", "ndob_wb"}) {
    EXPECT_NEAR(worth(rows, name).bandwidth, 30, 0.02 * 30) << name;
    EXPECT_NEAR(worth(rows, name).lag, 1 / 30., 1.1e-3) << name;
    EXPECT_NEAR(worth(rows, name).rise_0_90, std::log(10) / 30, 0.02 * std::log(10) / 30) << name;
  }
  // Butterworth: 4.3 and 8.1 % of overshoot
  EXPECT_NEAR(worth(rows, "mo2").overshoot, 4.3, 0.3);
  EXPECT_NEAR(worth(rows, "mo3").overshoot, 8.1, 0.3);
}

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

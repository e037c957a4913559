// SPDX-License-Identifier: Apache-2.0
#include "bench/study/pareto.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "bench/roster/robots.h"
#include "bench/score/score.h"
#include "mjcf/test/error_of.h"

namespace tauext::study::test {
namespace {

using tauext::test::error_of;

ParetoPoint point(const char* name, double design, double settling, double noise) {
  ParetoPoint p{.estimator = name, .design = design};
  p.value.settling = settling;
  p.value.noise = noise;
  return p;
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

TEST(Pareto, APointWithoutAValueIsNotOnTheFrontAndDominatesNobody) {
  std::vector<ParetoPoint> p = {point("a", 1, kNoValue, 1), point("a", 2, 0.1, kNoValue),
                                point("a", 4, 0.01, 1e-3),  point("b", 1, 0.2, 1e-2),
                                point("b", 2, 0.005, 5),    point("c", 0, kNoValue, kNoValue)};
  mark_dominated(p);
  for (const int i : {0, 1, 5}) {
    EXPECT_FALSE(p[i].on_front()) << i;
    EXPECT_EQ(p[i].dominated_by, "") << i;
  }
  EXPECT_TRUE(p[2].on_front());
  EXPECT_EQ(p[3].dominated_by, "a") << "by the point that has a value";
  EXPECT_TRUE(p[4].on_front());
  const std::string text = format_pareto(*robots().front(), p);
  std::size_t on_front = 0;
  for (auto at = text.find("on the front"); at != std::string::npos; ++on_front) {
    at = text.find("on the front", at + 1);
  }
  EXPECT_EQ(on_front, 2u) << text;
}

TEST(Pareto, WhoOvershootsAndSettlesLateIsBehindWhoSettlesEarly) {
  // the hasty one is at 90 % first, and quieter than the calm one's quick designs: a place that it
  // must not have
  ParetoPoint hasty = point("hasty", 1, 0.3, 2);
  hasty.value.rise_0_90 = 0.05, hasty.value.overshoot = 25;
  ParetoPoint calm = point("calm", 1, 0.2, 1);
  calm.value.rise_0_90 = 0.1;
  std::vector<ParetoPoint> p = {hasty, calm};
  mark_dominated(p);
  EXPECT_EQ(p[0].dominated_by, "calm");
  EXPECT_NEAR(p[0].excess, 1, 1e-12);
  EXPECT_TRUE(p[1].on_front());
}

TEST(Pareto, ADesignIsBehindABetterOneOfTheSameEstimator) {
  // more bandwidth that settles later, as its overshoot no longer fits into 2 %
  std::vector<ParetoPoint> p = {point("a", 10, 0.1, 1), point("a", 20, 0.2, 3),
                                point("a", 40, 0.05, 9)};
  mark_dominated(p);
  EXPECT_TRUE(p[0].on_front());
  EXPECT_EQ(p[1].dominated_by, "a");
  EXPECT_NEAR(p[1].excess, 2, 1e-12);
  EXPECT_TRUE(p[2].on_front());
  EXPECT_NE(format_pareto(*robots().front(), p).find("200 % noisier than itself at another design"),
            std::string::npos);
}

TEST(Pareto, HoldsEveryPointInEveryFormat) {
  const std::vector<ParetoPoint> p = {point("a", 1, kNoValue, 1), point("b", 0, 0.1, 2)};
  const Robot& r = *robots().front();
  const auto json = nlohmann::json::parse(format_pareto(r, p, TableFormat::kJson));
  ASSERT_EQ(json.size(), 2u);
  EXPECT_TRUE(json[0]["settling_ms"].is_null());
  EXPECT_EQ(json[0]["verdict"], "no value");
  EXPECT_EQ(json[1]["settling_ms"], 100);
  for (const TableFormat f : {TableFormat::kCsv, TableFormat::kMarkdown, TableFormat::kLatex}) {
    const std::string text = format_pareto(r, p, f);
    EXPECT_NE(text.find("100.0"), std::string::npos) << text;
    EXPECT_EQ(text.find("noise against delay"), std::string::npos) << "a head is for people";
  }
}

TEST(Pareto, SaysWhichScenariosARobotLacks) {
  EXPECT_EQ(error_of([] { pareto(robot("testbed1")); }),
            "this study needs the scenarios step, free; testbed1 lacks step, free");
}

}  // namespace
}  // namespace tauext::study::test

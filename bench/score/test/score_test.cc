// SPDX-License-Identifier: Apache-2.0
#include "bench/score/score.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "bench/score/detection_metrics.h"

namespace tauext::test {
namespace {

TEST(Score, StandsForItsWorstJoint) {
  Score s;
  s.set_joints(Metric::kRmse, {1, 3, 2});
  s.set_joints(Metric::kBandwidth, {30, 10, 20});
  EXPECT_EQ(s.get(Metric::kRmse), 3) << "the largest error";
  EXPECT_EQ(s.get(Metric::kBandwidth), 10) << "the slowest joint";
  EXPECT_EQ(s.joint(Metric::kRmse, 2), 2);
}

TEST(Score, OfAnArmThatAFalseAlarmHasStoppedHasNoReactionToATouch) {
  Trace free, stopped;
  free.contact_force = {0, 50, 20};
  stopped.contact_force = {0, 0, 0};
  stopped.t = {0, 1, 2};
  stopped.q = stopped.qd = Eigen::MatrixXd::Constant(1, 3, 0.1);
  stopped.stopped_at = 1;
  Score s;
  add_reaction_metrics(stopped, free, s);
  EXPECT_TRUE(std::isnan(*s.get(Metric::kPeak)) && std::isnan(*s.get(Metric::kOvertravel)));
  EXPECT_EQ(s.get(Metric::kPeakUnstopped), 50);
  stopped.contact_force = {0, 0, 30};
  add_reaction_metrics(stopped, free, s);
  EXPECT_EQ(s.get(Metric::kPeak), 30);
  EXPECT_EQ(s.get(Metric::kOvertravel), 0);
}

TEST(Score, AJointWithoutAValueIsTheWorst) {
  for (const Metric m : {Metric::kSettling, Metric::kBandwidth}) {
    Score s;
    s.set_joints(m, {1, std::nan(""), 2});
    ASSERT_TRUE(s.get(m));
    EXPECT_TRUE(std::isnan(*s.get(m))) << key_of(m);
  }
}

TEST(Score, AJointThatIsNotAskedDoesNotCount) {
  Score s;
  s.set_joints(Metric::kSettling, {std::nullopt, 0.2});
  EXPECT_EQ(s.get(Metric::kSettling), 0.2);
  EXPECT_EQ(s.by_key(), (std::vector<std::pair<std::string, double>>{{"settling_s", 0.2},
                                                                     {"settling_s_joint2", 0.2}}));
  s.set_joints(Metric::kRise, {std::nullopt, std::nullopt});
  EXPECT_FALSE(s.get(Metric::kRise)) << "nobody is asked";
}

TEST(Score, HasNothingThatWasNotSet) {
  Score s;
  EXPECT_TRUE(s.empty());
  EXPECT_FALSE(s.get(Metric::kRmse));
  EXPECT_TRUE(s.joints(Metric::kRmse).empty());
  EXPECT_THROW(s.joint(Metric::kRmse, 0), std::out_of_range);
  s.set(Metric::kAllocs, 0);
  EXPECT_FALSE(s.empty());
}

TEST(Score, RefusesJointsWhereThereAreNone) {
  EXPECT_THROW(Score().set_joints(Metric::kRecall, {1, 1}), std::logic_error);
}

TEST(Score, NamesItsValuesByKeysThatCanBeRead) {
  Score s;
  s.set_joints(Metric::kRise0To90, {0.1, 0.2});
  s.set(Metric::kRecall, 1);
  EXPECT_EQ(s.by_key(), (std::vector<std::pair<std::string, double>>{{"rise_0_90_s", 0.2},
                                                                     {"rise_0_90_s_joint1", 0.1},
                                                                     {"rise_0_90_s_joint2", 0.2},
                                                                     {"recall", 1}}));
}

TEST(MetricList, FindsARowByItsKeyAlone) {
  EXPECT_EQ(find_metric("settling_s"), &row_of(Metric::kSettling));
  EXPECT_EQ(find_metric("settling"), nullptr);
  EXPECT_EQ(find_metric("rmse_Nm_joint1"), nullptr);
}

}  // namespace
}  // namespace tauext::test

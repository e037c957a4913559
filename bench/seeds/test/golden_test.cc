// SPDX-License-Identifier: Apache-2.0
#include "bench/seeds/golden.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "bench/roster/robots.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

GoldenOptions small() {
  GoldenOptions o;
  o.filter = "testbed1/(collision/(truth|ekf.pan_tompkins)|hold/delayed_truth)$";
  o.seeds = {1, 7};
  o.threads = 1;
  return o;
}

const std::string& text() {
  static const std::string once = golden_metrics(small());
  return once;
}

TEST(Golden, HasALineForEachEntryAndMetricSorted) {
  std::istringstream in(text());
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  EXPECT_EQ(lines.front(), "# tauext golden metrics 2");
  EXPECT_EQ(lines.back(), "# end");
  EXPECT_TRUE(std::is_sorted(lines.begin() + 6, lines.end() - 1));
  EXPECT_NE(text().find("\nentry\tmetric\tseed 1\tseed 7\n"), std::string::npos) << text();
}

TEST(Golden, TheBaselinesScoreWhatTheyAreMadeFor) {
  EXPECT_NE(text().find("testbed1/collision/truth\trmse_Nm\t0\t0\n"), std::string::npos) << text();
  EXPECT_NE(text().find("testbed1/hold/delayed_truth\tfailed\t0\t0\n"), std::string::npos);
}

TEST(Golden, HasAnErrorForEachJointAndEveryDetector) {
  GoldenOptions o;
  o.filter = "wallmobot3/contact/ekf";
  o.seeds = {1};
  const std::string all = golden_metrics(o);
  for (const char* joint : {"joint1", "joint2", "joint3"}) {
    EXPECT_NE(all.find(fmt::format("contact/ekf\trmse_Nm_{}\t", joint)), std::string::npos)
        << joint;
  }
  for (const std::string& d : robot("wallmobot3").detectors()) {
    EXPECT_NE(all.find(fmt::format("contact/ekf+{}\tpeak_score\t", d)), std::string::npos) << d;
  }
}

TEST(Golden, HasAStepAndACollisionWithPoorSensors) {
  GoldenOptions o;
  o.filter = "wallmobot3/(step|collision).*/inverse_dynamics$";
  o.seeds = {1};
  const std::string both = golden_metrics(o);
  EXPECT_NE(both.find("# degraded: velocity_noise=0.01 "), std::string::npos) << both;
  EXPECT_NE(both.find("\nwallmobot3/step/inverse_dynamics\trmse_Nm\t"), std::string::npos) << both;
  o.suite.sensors = degraded_sensors();
  const std::string own = golden_metrics(o);
  EXPECT_EQ(own.find("@degraded"), std::string::npos) << "who asks for sensors has them alone";
  const auto value = [](const std::string& text, const std::string& line) {
    const auto begin = text.find(line) + line.size();
    return text.substr(begin, text.find('\n', begin) - begin);
  };
  for (const std::string scenario : {"\nwallmobot3/step", "\nwallmobot3/collision"}) {
    const std::string line = "/inverse_dynamics\trmse_Nm\t";
    ASSERT_NE(both.find(scenario + "@degraded" + line), std::string::npos) << both;
    EXPECT_EQ(value(own, scenario + line), value(both, scenario + "@degraded" + line));
  }
}

TEST(Golden, LeavesOutWhatIsNotGated) {
  for (const char* key : {"\tmax_Nm_joint", "\tfalse_alarms_per_hour"}) {
    EXPECT_EQ(text().find(key), std::string::npos) << key;
  }
  EXPECT_NE(text().find("\trise_0_90_s"), std::string::npos);
}

TEST(Golden, IsTheSameTextWithAnyNumberOfThreads) {
  GoldenOptions o = small();
  o.threads = 3;
  EXPECT_EQ(golden_metrics(o), text());
}

TEST(Golden, HasTheSelectedSpecificationsAlone) {
  GoldenOptions o;
  o.selection.estimators = {"mo2:bandwidth=50"};
  o.filter = "testbed1/hold/";
  o.seeds = {1};
  const std::string selected = golden_metrics(o);
  EXPECT_NE(selected.find("\ntestbed1/hold/mo2:bandwidth=50\trmse_Nm\t"), std::string::npos)
      << selected;
  EXPECT_EQ(selected.find("/ekf\t"), std::string::npos);
}

TEST(Golden, RefusesAFilterThatMatchesNothingAndNoSeed) {
  GoldenOptions o = small();
  o.filter = "nosuchthing";
  EXPECT_NE(error_of([&] { golden_metrics(o); }).find("'nosuchthing' matches nothing"),
            std::string::npos);
  o.filter.assign(1, '(');
  EXPECT_NE(error_of([&] { golden_metrics(o); }).find("'(' is no regular expression"),
            std::string::npos);
  o = small();
  o.seeds.clear();
  EXPECT_NE(error_of([&] { golden_metrics(o); }).find("need a seed"), std::string::npos);
}

}  // namespace
}  // namespace tauext::test

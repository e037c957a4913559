// SPDX-License-Identifier: Apache-2.0
// The examples are what a stranger copies: they must build, run and mean what they say.
#include <gtest/gtest.h>

#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "bench/test/programs.h"

namespace tauext::test {
namespace {

// the fields of the row that begins with `name`
std::vector<std::string> row(const Outcome& o, const std::string& name) {
  std::istringstream in(o.text);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(name + " ")) continue;
    std::istringstream fields(line);
    return {std::istream_iterator<std::string>(fields), {}};
  }
  return {};
}

TEST_F(Programs, OwnEstimatorStandsInTheTableAndAtEqualBandwidth) {
  const Outcome table =
      run(std::string("examples/own_estimator --benchmark_filter=wallmobot3/step/tw") + kQuick);
  ASSERT_EQ(table.code, 0) << table.text;
  const auto fields = row(table, "wallmobot3/step/twice");
  ASSERT_GT(fields.size(), 7u) << table.text;
  EXPECT_LT(std::stod(fields[1]), 5) << "N m rms after a step of 98.2";
  const Outcome equal = run("examples/own_estimator --equal-bandwidth 30");
  ASSERT_EQ(equal.code, 0) << equal.text;
  ASSERT_GT(row(equal, "twice").size(), 3u) << equal.text;
  EXPECT_NEAR(std::stod(row(equal, "twice")[2]), 30, 0.6) << "rad/s";
}

TEST_F(Programs, OwnEstimatorIsStudiedBesideOurs) {
  const Outcome o = run(
      "examples/own_estimator detect --conditions light --estimator twice,mo1 --detector threshold "
      "--runs 2 --collisions 10 --pushes 0 --clampings 0 --hours 0.02 --out study.json");
  ASSERT_EQ(o.code, 0) << o.text;
  EXPECT_TRUE(o.says("twice") && o.says("mo1")) << o.text;
  EXPECT_EQ(run("tauext-detect --estimator twice").code, 2) << "nobody else knows it";
}

TEST_F(Programs, OwnDetectorMarksTheCollisionBehindEveryEstimator) {
  const Outcome o =
      run(std::string(
              "examples/own_detector '--benchmark_filter=wallmobot3/collision/(mo1|ekf)[+]jump'") +
          kQuick);
  ASSERT_EQ(o.code, 0) << o.text;
  for (const char* name : {"wallmobot3/collision/mo1+jump", "wallmobot3/collision/ekf+jump"}) {
    ASSERT_GT(row(o, name).size(), 5u) << o.text;
    EXPECT_LE(std::stod(row(o, name)[4]), 0.01) << "s of delay, " << name;
  }
}

TEST_F(Programs, OwnEstimatorsAndDetectorsRunOnARobotFromAFile) {
  const std::string arm = " --robot " + kExamples + "/two_arms.urdf";
  const Outcome e = run("examples/own_estimator" + arm + " --benchmark_filter=step/twice" + kQuick);
  EXPECT_EQ(e.code, 0) << e.text;
  EXPECT_GT(row(e, "two_arms/step/twice").size(), 7u) << e.text;
  const Outcome d =
      run("examples/own_detector" + arm + " --benchmark_filter=blow/mo2.jump" + kQuick);
  EXPECT_EQ(d.code, 0) << d.text;
  EXPECT_GT(row(d, "two_arms/blow/mo2+jump").size(), 5u) << d.text;
}

TEST_F(Programs, OwnRobotRunsEveryCommonEstimator) {
  const Outcome o = run(std::string("examples/own_robot --benchmark_filter=pendulum/") + kQuick);
  ASSERT_EQ(o.code, 0) << o.text;
  for (const char* e : {"mo1", "mo3", "dkf", "smo", "aob", "ndob_wb"}) {
    const auto fields = row(o, std::string("pendulum/step/") + e);
    ASSERT_GT(fields.size(), 7u) << e << "\n" << o.text;
    EXPECT_LT(std::stod(fields[7]), 0.001) << "N m in the end, " << e;
  }
}

TEST_F(Programs, OwnScenarioIsRecordedAndItsKnocksAreFound) {
  const Outcome o =
      run(std::string("examples/own_scenario '--benchmark_filter=wallmobot3/knock/ekf[+]pan'") +
          kQuick);
  ASSERT_EQ(o.code, 0) << o.text;
  const auto fields = row(o, "wallmobot3/knock/ekf+pan_tompkins");
  ASSERT_GT(fields.size(), 5u) << o.text;
  EXPECT_LE(std::stod(fields[5]), 0.05) << "s of delay: a knock that is not found has none";
  EXPECT_EQ(fields[6].substr(0, 1), "0") << "false alarms";
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
// The examples are what a stranger copies: they must build, run and mean what they say.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

namespace tauext::test {
namespace {

struct Outcome {
  int code = -1;
  std::string text;

  // the fields of the row that begins with `name`
  std::vector<std::string> row(const std::string& name) const {
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) {
      if (!line.starts_with(name + " ")) continue;
      std::istringstream fields(line);
      std::vector<std::string> all;
      for (std::string f; fields >> f;) all.push_back(f);
      return all;
    }
    return {};
  }
};

Outcome run(const std::string& command) {
  Outcome o;
  const std::string line = std::string(TAUEXT_BIN) + "/examples/" + command + " 2>&1";
  std::FILE* const pipe = popen(line.c_str(), "r");
  if (pipe == nullptr) return o;
  std::array<char, 4096> buffer;
  while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) o.text += buffer.data();
  const int status = pclose(pipe);
  o.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return o;
}

constexpr const char* kQuick = " --benchmark_min_time=0.001";

TEST(Examples, OwnEstimatorStandsInTheTableAndAtEqualBandwidth) {
  const Outcome table =
      run(std::string("own_estimator --benchmark_filter=wallmobot3/step/tw") + kQuick);
  ASSERT_EQ(table.code, 0) << table.text;
  const auto row = table.row("wallmobot3/step/twice");
  ASSERT_GT(row.size(), 7u) << table.text;
  EXPECT_LT(std::stod(row[1]), 5) << "N m rms after a step of 98.2";
  const Outcome equal = run("own_estimator --equal-bandwidth 30");
  ASSERT_EQ(equal.code, 0) << equal.text;
  ASSERT_GT(equal.row("twice").size(), 3u) << equal.text;
  EXPECT_NEAR(std::stod(equal.row("twice")[2]), 30, 0.6) << "rad/s";
}

TEST(Examples, OwnDetectorMarksTheCollisionBehindEveryEstimator) {
  const Outcome o =
      run(std::string("own_detector '--benchmark_filter=wallmobot3/collision/(mo1|ekf)[+]jump'") +
          kQuick);
  ASSERT_EQ(o.code, 0) << o.text;
  for (const char* name : {"wallmobot3/collision/mo1+jump", "wallmobot3/collision/ekf+jump"}) {
    ASSERT_GT(o.row(name).size(), 5u) << o.text;
    EXPECT_LE(std::stod(o.row(name)[4]), 0.01) << "s of delay, " << name;
  }
}

TEST(Examples, OwnRobotRunsEveryCommonEstimator) {
  const Outcome o = run(std::string("own_robot --benchmark_filter=pendulum/") + kQuick);
  ASSERT_EQ(o.code, 0) << o.text;
  for (const char* e : {"mo1", "mo3", "dkf", "smo", "eao", "ndob_wb"}) {
    const auto row = o.row(std::string("pendulum/step/") + e);
    ASSERT_GT(row.size(), 7u) << e << "\n" << o.text;
    EXPECT_LT(std::stod(row[7]), 0.001) << "N m in the end, " << e;
  }
}

TEST(Examples, OwnScenarioIsRecordedAndItsKnocksAreFound) {
  const Outcome o =
      run(std::string("own_scenario '--benchmark_filter=wallmobot3/knock/ekf[+]pan'") + kQuick);
  ASSERT_EQ(o.code, 0) << o.text;
  const auto row = o.row("wallmobot3/knock/ekf+pan_tompkins");
  ASSERT_GT(row.size(), 5u) << o.text;
  EXPECT_EQ(row[5].substr(0, 1), "0") << "false alarms";
}

}  // namespace
}  // namespace tauext::test

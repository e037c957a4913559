// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "bench/roster/threshold_file.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

class ThresholdFile : public testing::Test {
 protected:
  ~ThresholdFile() override { std::filesystem::remove(path_); }
  std::string path_ = testing::TempDir() + "thresholds_" +
                      testing::UnitTest::GetInstance()->current_test_info()->name() + ".json";
};

Thresholds some() {
  Thresholds t{.trained_on = "a test", .margin = 1.5, .sets = {}};
  for (const double noise : {1e-4, 1e-3}) {
    ThresholdSet set{.robot = "wallmobot3", .velocity_noise = noise, .by_estimator = {}};
    set.by_estimator["ekf"]["threshold"] = {Eigen::Vector3d(1 / 3., 2, 1e5 * noise), {}};
    set.by_estimator["mo1"]["clamping"] = {Eigen::Vector3d(7, 7, 7),
                                           Eigen::Matrix3d::Identity() / 3};
    t.sets.push_back(set);
  }
  return t;
}

TEST_F(ThresholdFile, IsReadBackToTheBit) {
  write_thresholds(some(), path_);
  const Thresholds t = read_thresholds(path_);
  EXPECT_EQ(t.trained_on, "a test");
  EXPECT_EQ(t.margin, 1.5);
  ASSERT_EQ(t.sets.size(), 2u);
  EXPECT_EQ(t.sets[1].velocity_noise, 1e-3);
  const DetectorThresholds& ekf = t.sets[1].by_estimator.at("ekf");
  EXPECT_EQ(ekf.at("threshold").threshold, Eigen::VectorXd(Eigen::Vector3d(1 / 3., 2, 100)));
  EXPECT_EQ(ekf.at("threshold").metric.size(), 0);
  EXPECT_EQ(t.sets[0].by_estimator.at("mo1").at("clamping").metric,
            Eigen::MatrixXd(Eigen::Matrix3d::Identity() / 3));
}

TEST_F(ThresholdFile, SaysWhatIsWrongWithIt) {
  write_thresholds(some(), path_);
  std::ostringstream text;
  text << std::ifstream(path_).rdbuf();
  // the file with `from` replaced by `to`
  const auto error = [&](const std::string& from, const std::string& to) {
    std::string bad = text.str();
    const auto at = bad.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    std::ofstream(path_) << bad.replace(at, from.size(), to);
    const std::string what = error_of([&] { read_thresholds(path_); });
    EXPECT_EQ(what.find(path_ + ": "), 0u) << what;
    return what;
  };
  EXPECT_NE(error("{", "").find("parse error"), std::string::npos);
  EXPECT_NE(error("tauext-thresholds-1", "x").find("write it with tauext-detect --calibrate"),
            std::string::npos);
  EXPECT_NE(error("\"format\"", "\"shape\"")
                .find("\"format\" is null, not \"tauext-thresholds-1\"; write it with"),
            std::string::npos);
  EXPECT_NE(error("\"wallmobot3\"", "\"r2d2\"").find("unknown robot 'r2d2'"), std::string::npos);
  EXPECT_NE(error("\"ekf\"", "\"oracle\"").find("unknown estimator 'oracle'"), std::string::npos);
  EXPECT_NE(error("\"ekf\"", "\"ekf:alpha=1\"").find("there is no key 'alpha'"), std::string::npos);
  EXPECT_NE(error("\"clamping\"", "\"ear\"").find("unknown detector 'ear'"), std::string::npos);
  EXPECT_NE(error("2.0", "0.0").find("wallmobot3/ekf+threshold: a threshold of 0 is not positive"),
            std::string::npos);
  EXPECT_NE(error("2.0,", "").find("2 numbers for 3 joints"), std::string::npos);
  EXPECT_EQ(error_of([] { read_thresholds("/nowhere/x"); }),
            "/nowhere/x: No such file or directory; tauext-detect --calibrate writes files of "
            "thresholds");
}

TEST(Thresholds, AreThoseOfTheLeastNoisySensorsThatAreAsNoisy) {
  const Thresholds t = some();
  EXPECT_EQ(t.of("wallmobot3", 0)->velocity_noise, 1e-4);
  EXPECT_EQ(t.of("wallmobot3", 1e-4)->velocity_noise, 1e-4);
  EXPECT_EQ(t.of("wallmobot3", 5e-4)->velocity_noise, 1e-3);
  EXPECT_EQ(t.of("wallmobot3", 1)->velocity_noise, 1e-3) << "the noisiest there is";
  EXPECT_EQ(t.of("testbed1", 0), nullptr);
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "bench/degradation.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

class DegradationFile : public testing::Test {
 protected:
  void SetUp() override {
    path_ = testing::TempDir() + "degradation_" +
            testing::UnitTest::GetInstance()->current_test_info()->name() + ".json";
  }
  void TearDown() override { std::filesystem::remove(path_); }

  Degradation read(const std::string& text, Degradation d = {}) {
    std::ofstream(path_) << text;
    read_degradation(path_, d);
    return d;
  }
  std::string error(const std::string& text) {
    const std::string what = error_of([&] { read(text); });
    EXPECT_EQ(what.find(path_ + ": "), 0u) << what;
    return what;
  }

  std::string path_;
};

TEST_F(DegradationFile, SetsWhatItNamesAndLeavesTheRest) {
  Degradation before;
  before.sensors.encoder_step = 1e-4;
  const Degradation d = read(R"({ "velocity_noise": 1e-3, "dropped": 0.01, "seed": 7,  // a comment
                                  "loadcell": { "hysteresis": 0.002 },
                                  "model_error": { "mass": 1.05, "friction": 2 } })",
                             before);
  EXPECT_EQ(d.sensors.velocity_noise, 1e-3);
  EXPECT_EQ(d.sensors.dropped, 0.01);
  EXPECT_EQ(d.sensors.seed, 7u);
  EXPECT_EQ(d.sensors.loadcell.hysteresis, 0.002);
  EXPECT_EQ(d.sensors.loadcell.scale, 1);
  EXPECT_EQ(d.model_error.mass, 1.05);
  EXPECT_EQ(d.model_error.friction, 2);
  EXPECT_EQ(d.sensors.encoder_step, 1e-4);
}

TEST_F(DegradationFile, SaysWhatIsWrongAndKnowsBetter) {
  EXPECT_NE(error("{").find("parse error"), std::string::npos);
  EXPECT_NE(error("[1]").find("a JSON object is wanted"), std::string::npos);
  EXPECT_NE(error(R"({"velocity_nose": 1})")
                .find("unknown key \"velocity_nose\"; known: "
                      "velocity_noise [rad/s], encoder_step [rad]"),
            std::string::npos);
  EXPECT_NE(error(R"({"model_error": {"weight": 1}})")
                .find("unknown key \"model_error.weight\"; "
                      "known: mass [1], com [m]"),
            std::string::npos);
  EXPECT_NE(error(R"({"loadcell": 3})").find("\"loadcell\" is no object"), std::string::npos);
  EXPECT_NE(error(R"({"latency": "long"})").find("\"latency\" is \"long\", no number"),
            std::string::npos);
  EXPECT_EQ(error_of([] {
              Degradation d;
              read_degradation("/nowhere/x.json", d);
            }),
            "/nowhere/x.json: cannot open");
}

TEST_F(DegradationFile, ABadOneChangesNothing) {
  Degradation d;
  std::ofstream(path_) << R"({"velocity_noise": 1, "nonsense": 2})";
  EXPECT_THROW(read_degradation(path_, d), std::runtime_error);
  EXPECT_EQ(describe(d), "");
}

TEST(SetFields, TakesKeysAndNumbersAndRefusesTheRest) {
  ModelError e;
  set_fields({"mass=0.9", "com=-0.01"}, e);
  EXPECT_EQ(e.mass, 0.9);
  EXPECT_EQ(e.com, -0.01);
  for (const char* item : {"mass", "mass=", "mass=1x", "weight=1", "=1", ""}) {
    EXPECT_NE(error_of([&] {
                set_fields({item}, e);
              }).find(std::string("'") + item + "' is not KEY=NUMBER with a KEY of mass [1]"),
              std::string::npos)
        << item;
  }
}

TEST(Describe, NamesWhatIsNotIdealAndNothingElse) {
  EXPECT_EQ(describe({}), "");
  Degradation d;
  d.sensors.jitter = 2e-4;
  d.sensors.loadcell.scale = 1.01;
  d.model_error.mass = 1.05;
  EXPECT_EQ(describe(d), "jitter=0.0002 loadcell.scale=1.01 model_error.mass=1.05");
}

}  // namespace
}  // namespace tauext::test

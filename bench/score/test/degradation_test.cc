// SPDX-License-Identifier: Apache-2.0
#include "bench/score/degradation.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "mjcf/record.h"
#include "mjcf/scenarios/scenario.h"
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

TEST_F(DegradationFile, HasTorqueSensorsAndDrives) {
  const Degradation d = read(R"({ "torque": { "gain": 0.05, "ripple": 0.01 },
                                  "drives": { "stiffness": 200, "coulomb": 0.02 } })");
  EXPECT_EQ(d.sensors.torque.gain, 0.05);
  EXPECT_EQ(d.sensors.torque.ripple, 0.01);
  EXPECT_EQ(d.drives.stiffness, 200);
  EXPECT_EQ(d.drives.coulomb, 0.02);
  EXPECT_EQ(d.drives.rotor, Drives().rotor);
  EXPECT_EQ(describe(d),
            "torque.gain=0.05 torque.ripple=0.01 drives.stiffness=200 drives.coulomb=0.02");
  EXPECT_NE(error(R"({"drives": {"stifness": 1}})")
                .find("drives: there is no key 'stifness'; known: stiffness [u/rad] 0 to 1e+06"),
            std::string::npos);
  EXPECT_NE(error(R"({"torque": {"gain": 1}})").find("torque.gain=1: it must be 0 to 0.9"),
            std::string::npos);
}

TEST_F(DegradationFile, HasNamedSetsEachWorseThanTheOneBefore) {
  std::vector<Degradation> all;
  for (const char* name : {"light", "typical", "hard"}) {
    all.emplace_back().sensors.seed = 7;
    read_degradation(name, all.back());
    EXPECT_EQ(all.back().sensors.seed, 7u) << "the seed stays";
  }
  ASSERT_EQ(all.size(), named_degradations().size());
  for (std::size_t i = 1; i < all.size(); ++i) {
    const Degradation &before = all[i - 1], &d = all[i];
    EXPECT_GT(d.sensors.velocity_noise, before.sensors.velocity_noise);
    EXPECT_GT(d.sensors.torque.noise, before.sensors.torque.noise);
    EXPECT_GT(d.sensors.torque.gain, before.sensors.torque.gain);
    EXPECT_GT(d.sensors.tau_latency, before.sensors.tau_latency);
    EXPECT_GT(d.model_error.mass, before.model_error.mass);
    EXPECT_GT(d.drives.coulomb, before.drives.coulomb);
  }
  EXPECT_GT(all[1].drives.stiffness, all[2].drives.stiffness);
  EXPECT_FALSE(all[0].drives.elastic());
}

TEST_F(DegradationFile, HasNamedSetsUnderWhichEveryScenarioCanBeRecorded) {
  for (const char* robot : {"testbed1", "wallmobot3"}) {
    for (Scenario s : scenarios(robot)) {
      for (const char* name : {"light", "typical", "hard"}) {
        Degradation d;
        read_degradation(name, d);
        s.duration = 0.05;
        const Recording with{.drives = d.drives};
        EXPECT_EQ(error_of([&] { record(load_for(robot, s, d.model_error), s, d.sensors, with); }),
                  "no error")
            << robot << '/' << s.name << ' ' << name;
      }
    }
  }
}

TEST_F(DegradationFile, SaysWhatIsWrongAndKnowsBetter) {
  EXPECT_NE(error("{").find("parse error"), std::string::npos);
  EXPECT_NE(error("[1]").find("a JSON object is wanted"), std::string::npos);
  EXPECT_NE(error(R"({"velocity_nose": 1})")
                .find("sensors: there is no key 'velocity_nose'; known: "
                      "velocity_noise [rad/s] 0 to 1e+09, encoder_step [rad] 0 to 1"),
            std::string::npos);
  EXPECT_NE(error(R"({"model_error": {"weight": 1}})")
                .find("model_error: there is no key 'weight'; "
                      "known: mass [1] 0.01 to 100, com [m] -10 to 10"),
            std::string::npos);
  EXPECT_NE(error(R"({"loadcell": 3})").find("\"loadcell\" is no object"), std::string::npos);
  EXPECT_NE(error(R"({"latency": "long"})").find("\"latency\" is \"long\", no number"),
            std::string::npos);
  EXPECT_NE(error(R"({"dropped": 1})").find("dropped=1: it must be 0 to 0.99; known: "),
            std::string::npos);
  EXPECT_NE(error(R"({"loadcell": {"hysteresis": -1}})")
                .find("loadcell.hysteresis=-1: it must be 0 to 1; known: "),
            std::string::npos);
  EXPECT_EQ(error_of([] {
              Degradation d;
              read_degradation("/nowhere/x.json", d);
            }),
            "/nowhere/x.json: No such file or directory");
  EXPECT_EQ(error_of([] {
              Degradation d;
              read_degradation("ligth", d);
            }),
            "unknown degradation 'ligth'; known: light, typical, hard");
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
  const std::string known = "; known: mass [1] 0.01 to 100, com [m] -10 to 10, friction [N m]";
  const std::pair<const char*, const char*> wrong[] = {
      {"mass", "'mass' is not key=value"},     {"mass=", "'mass=' is not key=value"},
      {"=1", "'=1' is not key=value"},         {"", "'' is not key=value"},
      {"mass=1x", "mass=1x: not a number"},    {"mass=0", "mass=0: it must be 0.01 to 100"},
      {"weight=1", "there is no key 'weight'"}};
  for (const auto& [item, why] : wrong) {
    const auto set = [&e, text = item] { set_fields({text}, e); };
    EXPECT_EQ(error_of(set).find("model_error: " + (why + known)), 0u) << item;
  }
}

// the limits are those of mjcf/, which has them from nobody here
TEST(SetFields, LimitsAreThoseThatASimulationTakes) {
  const Eigen::Vector3d usual(1, 1, 1);
  const auto simulates = [&usual](const Sensors& s) {
    return error_of([&] { SensorStream(s, 3, {}, usual); });
  };
  for (const char* item : {"velocity_noise=1e9",    "encoder_step=1",
                           "loadcell_noise=1e5",    "latency=1",
                           "tau_latency=1",         "jitter=1",
                           "dropped=0.99",          "repeated=0.99",
                           "loadcell.scale=1e3",    "loadcell.offset=-1e6",
                           "loadcell.hysteresis=1", "loadcell.nonlinearity=-1",
                           "loadcell.noise=1e6",    "loadcell.step=1e6",
                           "torque.gain=0.9",       "loadcell.full_scale=1e6",
                           "torque.hysteresis=10",  "torque.ripple=10",
                           "torque.waves=1e5",      "torque.bias=10",
                           "torque.noise=10"}) {
    Sensors s;
    EXPECT_EQ(error_of([&] { set_fields({item}, s); }), "no error") << item;
    EXPECT_EQ(simulates(s), "no error") << item;
    const std::string beyond = item + std::string("1");  // ten times as much, or more than 0.99
    EXPECT_NE(error_of([&] { set_fields({beyond}, s); }).find("it must be"), std::string::npos)
        << beyond;
  }
}

TEST(Ideal, AreSensorsWhateverTheirSeedAndFullScale) {
  Sensors s;
  s.seed = 7;
  s.loadcell.full_scale = 500;
  EXPECT_TRUE(s.ideal());
  EXPECT_TRUE(s.loadcell.ideal());
  for (const char* fault :
       {"velocity_noise=1e-9", "encoder_step=1e-9", "loadcell_noise=1e-9", "latency=1e-9",
        "tau_latency=1e-9", "jitter=1e-9", "dropped=1e-9", "repeated=1e-9", "loadcell.scale=1.01",
        "loadcell.offset=-1", "loadcell.hysteresis=1e-9", "loadcell.nonlinearity=-1e-9",
        "loadcell.noise=1e-9", "loadcell.step=1e-9", "torque.gain=1e-9", "torque.hysteresis=1e-9",
        "torque.ripple=1e-9", "torque.bias=1e-9", "torque.noise=1e-9"}) {
    Sensors faulty = s;
    set_fields({fault}, faulty);
    EXPECT_FALSE(faulty.ideal()) << fault;
    EXPECT_EQ(faulty.loadcell.ideal(), std::string(fault).find("loadcell.") != 0) << fault;
  }
  for (const char* error : {"mass=1.01", "com=-1e-9", "friction=1", "viscous=1", "armature=1"}) {
    ModelError e;
    EXPECT_TRUE(e.none());
    set_fields({error}, e);
    EXPECT_FALSE(e.none()) << error;
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

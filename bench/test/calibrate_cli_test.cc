// SPDX-License-Identifier: Apache-2.0
// tauext-calibrate, where recordings and robot contradict each other.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "bench/test/programs.h"

namespace tauext::test {
namespace {

TEST_F(Programs, CalibrateWritesNoFileWhereItIsNotSure) {
  const std::string record = "tauext-record --scenarios " + kExamples +
                             "/recordings/motions.json --every 8 --velocity_noise 1e-3 ";
  run(record + "--scenario free1 --out free.csv --robot " + kExamples + "/arm6.json");
  run(record + "--scenario loaded --out loaded.csv --robot " + kExamples +
      "/recordings/loaded.json");
  const auto refuses = [&](const std::string& flags, const std::string& why) {
    const Outcome o = run("tauext-calibrate " + flags + " --out new.json");
    EXPECT_EQ(o.code, 1) << o.text;
    EXPECT_TRUE(o.says(why)) << o.text;
    EXPECT_TRUE(o.says("new.json is not written")) << o.text;
    EXPECT_FALSE(exists("new.json"));
  };
  const std::string arm = " --robot " + kExamples + "/arm6.json";
  refuses("loaded.csv --weigh free.csv" + arm, "kg, less than nothing");
  run_system("sed 's/mass=\"\\([0-9.]*\\)\"/mass=\"1\\1\"/' " + kExamples +
             "/arm6.xml > heavy.xml");
  refuses("free.csv --robot heavy.xml", "its torque fits its masses by a factor of");
  const Outcome good = run("tauext-calibrate free.csv --out new.json" + arm);
  EXPECT_EQ(good.code, 0) << good.text;
}

// its friction is (37) of the paper, which is in its file, and its inertia and masses too
TEST_F(Programs, CalibrateTakesATestbedForAnArmOfOneJoint) {
  run("tauext-record --robot testbed1 --scenario identify --loadcell noise=1 --out log.csv");
  const Outcome good =
      run("tauext-calibrate log.csv --terms armature,coulomb --format csv --robot " + kMjcf +
          "/testbed1.xml");
  EXPECT_EQ(good.code, 0) << good.text;
  const std::string name = "q1,coulomb,N m,";
  const std::size_t at = good.text.find(name);
  ASSERT_NE(at, std::string::npos) << good.text;
  EXPECT_NEAR(std::stod(good.text.substr(at + name.size())), 2.163, 0.01) << good.text;
  const Outcome alone = run("tauext-calibrate log.csv");
  EXPECT_EQ(alone.code, 2);
  EXPECT_TRUE(alone.says("--robot FILE is required")) << alone.text;
}

// a sensor that says a tenth less than it should: what --apply writes makes it right
TEST_F(Programs, CalibrateAppliesTheScaleThatItFinds) {
  const std::string robot = " --robot " + kExamples + "/arm6.json";
  run("tauext-record --scenarios " + kExamples +
      "/recordings/motions.json --scenario free1 "
      "--every 8 --velocity_noise 1e-3 --out free.csv" +
      robot);
  write("low.toml", "preset = 'tauext'\n[tau_instant]\ncolumns = 'tau_instant(\\d)'\ngain = 0.9\n");
  const Outcome o =
      run("tauext-calibrate free.csv --apply --columns low.toml --out new.json" + robot);
  ASSERT_EQ(o.code, 0) << o.text;
  const auto joints = nlohmann::json::parse(content("new.json")).at("joints");
  for (const char* joint : {"shoulder_lift", "elbow"})
    EXPECT_NEAR(joints.at(joint).at("torque_gain").get<double>(), 1 / 0.9, 0.03) << joint;
  EXPECT_EQ(run("tauext-replay free.csv --columns low.toml --estimator mo2 --out e.csv --robot "
                "new.json")
                .code,
            0);
}

TEST_F(Programs, CalibrateLeavesLabelledContactsOut) {
  const std::string robot = " --robot " + kExamples + "/arm6.json";
  run("tauext-record --scenarios " + kExamples +
      "/recordings/motions.json --scenario free1 "
      "--every 8 --velocity_noise 1e-3 --out free.csv" +
      robot);
  // 100 N m on each joint from 5 to 10 s, which nobody can calibrate from
  run_system(
      "awk -F, -v OFS=, 'NR > 1 && $1 >= 5 && $1 <= 10 {for (i = 14; i <= 19; ++i) $i += 100} "
      "{print}' free.csv | cut -d, -f1-19 > pushed.csv");
  write("labels.csv", "file,start,end\npushed.csv,4.9,10.1\nother.csv,1,2\n");
  const std::string calibrate = "tauext-calibrate pushed.csv --out new.json" + robot;
  EXPECT_EQ(run(calibrate).code, 1);
  EXPECT_FALSE(exists("new.json"));
  const Outcome o = run(calibrate + " --contacts labels.csv");
  EXPECT_EQ(o.code, 0) << o.text;
  EXPECT_TRUE(o.says("'other.csv'")) << o.text;
}

// arm6 as a URDF without any mass
TEST_F(Programs, CalibrateFindsMassesOfAFileThatHasNone) {
  const auto part = [](int i, const std::string& joint, const std::string& at,
                       const std::string& axis) {
    const std::string link = "l" + std::to_string(i + 1), parent = "l" + std::to_string(i);
    return "<link name='" + link + "'/><joint name='" + joint +
           "' type='continuous'><parent link='" + parent + "'/><child link='" + link +
           "'/><origin xyz='" + at + "'/><axis xyz='" + axis + "'/></joint>";
  };
  write("bare.urdf",
        "<robot name='bare'><link name='l0'/>" + part(0, "shoulder_pan", "0 0 .16", "0 0 1") +
            part(1, "shoulder_lift", "0 .13 0", "0 1 0") + part(2, "elbow", "0 -.12 .43", "0 1 0") +
            part(3, "wrist1", "0 0 .39", "0 1 0") + part(4, "wrist2", "0 .12 0", "0 0 1") +
            part(5, "wrist3", "0 0 .1", "0 1 0") + "</robot>");
  const std::string record = "tauext-record --scenarios " + kExamples +
                             "/recordings/motions.json --every 8 --velocity_noise 1e-3 --robot " +
                             kExamples + "/arm6.json --scenario ";
  for (const std::string name : {"free1", "free2", "free3", "free4"})
    run(record + name + " --out " + name + ".csv");
  const Outcome refused = run("tauext-calibrate free1.csv --robot bare.urdf --out found.json");
  EXPECT_EQ(refused.code, 2) << refused.text;
  EXPECT_TRUE(refused.says("tauext-calibrate --masses")) << refused.text;
  const Outcome found = run(
      "tauext-calibrate free1.csv free2.csv free3.csv --robot bare.urdf --masses --out found.json");
  EXPECT_EQ(found.code, 0) << found.text;
  EXPECT_TRUE(found.says("No single mass, center or inertia is known by this")) << found.text;
  // a motion that it has not seen, by the masses that were found
  const Outcome again = run("tauext-calibrate free4.csv --robot found.json --out again.json");
  EXPECT_EQ(again.code, 0) << again.text;
  EXPECT_EQ(run("tauext-import found.json --out found.xml").code, 0);
  const Outcome poor =
      run("tauext-calibrate free1.csv --robot bare.urdf --masses --terms coulomb --out no.json");
  EXPECT_EQ(poor.code, 2) << poor.text;
  EXPECT_FALSE(exists("no.json"));
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "mjcf/import/robot_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "mjcf/plant/any_tree.h"
#include "mjcf/plant/model_error.h"
#include "mjcf/plant/plant.h"
#include "mjcf/plant/simulated.h"
#include "mjcf/plant/tree.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTwoLinks =
    "<mujoco><compiler angle='radian'/><worldbody><body name='upper'><inertial pos='0 0 .2' "
    "mass='3' diaginertia='.1 .1 .1'/><joint name='shoulder' axis='0 1 0' damping='2'/><body "
    "name='lower' pos='0 0 .4'><inertial pos='0 0 .1' mass='1' diaginertia='.1 .1 .1'/><joint "
    "name='elbow' axis='0 1 0' frictionloss='.7'/><site name='tool' pos='0 0 .3' euler='0 .5 "
    "0'/></body></body></worldbody></mujoco>";

class RobotFiles : public testing::Test {
 protected:
  RobotFiles() {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "arm.xml") << kTwoLinks;
  }
  ~RobotFiles() override { fs::remove_all(folder_); }

  std::string written(const std::string& json) const {
    std::ofstream(folder_ / "arm.json") << json;
    return folder_ / "arm.json";
  }
  ArmTree arm(const std::string& rest) const {
    return tree_of(
        load_mjcf(written(R"({"format": "tauext-robot-1", "file": "arm.xml")" + rest + "}")));
  }
  std::string error_of_robot(const std::string& json) const {
    return error_of([&] { load_mjcf(written(json)); });
  }

  fs::path folder_ = fs::temp_directory_path() / ("tauext_robot_file_" + std::to_string(getpid()));
};

TEST_F(RobotFiles, SayWhatWasMeasuredAndLeaveTheRest) {
  const ArmTree a = arm(R"(, "joints": {"shoulder": {"armature": 0.4, "coulomb": [3, 2],
      "viscous": [5, 4], "offset": 0.25, "gain": 11}})");
  const TreeJoint& shoulder = a.joints[0];
  EXPECT_EQ(shoulder.armature, 0.4);
  EXPECT_EQ(shoulder.dry, 2.5);
  EXPECT_EQ(shoulder.viscous, 4.5);
  EXPECT_EQ(shoulder.viscous_skew, 0.5);
  EXPECT_EQ(shoulder.offset, 0.25 + 0.5);
  EXPECT_EQ(a.gain[0], 11);
  EXPECT_EQ(a.joints[1].dry, 0.7);
  EXPECT_EQ(a.joints[1].offset, 0);
  EXPECT_EQ(a.gain[1], 0);
}

// the gates of samples are three times what a drive can do; where nobody knows, they are wide
TEST_F(RobotFiles, WhatDrivesCanDoBoundsTheSamples) {
  const auto limits = [&](const std::string& joints) {
    return any_tree<2>(load_mjcf(written(R"({"format": "tauext-robot-1", "file": "arm.xml")" +
                                         joints + "}")))
        .limits();
  };
  const ArmLimits<2> wide = limits("");
  const ArmLimits<2> l = limits(R"(, "joints": {"shoulder": {"effort": 400, "velocity": 2}})");
  EXPECT_EQ(l.tau[0], 3 * 400);
  EXPECT_EQ(l.qd, Vec<2>(3 * 2, wide.qd[1]));
  // a drive that could not hold its arm is no measure: m g r = 9.81 (3 * .2 + .5), and 5 rad/s^2
  const double holds = 9.81 * 1.1 + 5 * (.2 + 3 * .04 + .25);
  EXPECT_NEAR(l.dtau[0], 0.1 * 400 + 0.05 * holds, 0.05);
  EXPECT_NEAR(limits(R"(, "joints": {"shoulder": {"effort": 1}})").tau[0], 3 * holds, 1);
}

// friction at a speed is that of its direction, and an offset is always there
TEST_F(RobotFiles, FrictionIsThatOfTheDirection) {
  const TreeModel<2> model = tree_model<2>(load_mjcf(written(
      R"({"format": "tauext-robot-1", "file": "arm.xml",
          "joints": {"shoulder": {"coulomb": [3, 2], "viscous": [5, 4], "offset": 0.25}}})")));
  EXPECT_NEAR(model.friction({2, 0})[0], 3 + 5 * 2 + 0.25, 1e-9);
  EXPECT_NEAR(model.friction({-2, 0})[0], -(2 + 4 * 2) + 0.25, 1e-9);
}

// hidden friction adds to what the arm has, and leaves that as smooth as it is
TEST_F(RobotFiles, HiddenFrictionLeavesTheArmsOwnAsItIs) {
  arm(R"(, "joints": {"shoulder": {"coulomb": 3, "viscous": [5, 4], "offset": 0.25}})");
  const Model model = simulated(load_mjcf(folder_ / "arm.json"));
  const auto friction = [](const Model& m) {
    Plant p(m);
    p.set_state(Vec<2>::Zero(), Vec<2>(0.004, 0.3));
    return p.friction();
  };
  const Eigen::VectorXd own = friction(model);
  EXPECT_LT((friction(with_errors(model, {.friction = 1e-9})) - own).norm(), 2e-9);
  EXPECT_NEAR(friction(with_errors(model, {.friction = 0.5}))[1] - own[1], 0.5, 1e-6);
}

TEST_F(RobotFiles, APayloadStandsInTheFrameThatItNames) {
  const ArmTree bare = arm(""), by_body = arm(R"(, "payload": {"body": "lower", "mass": 2,
      "center": [0.1, 0, 0.3]})"),
                by_site = arm(R"(, "payload": {"body": "tool", "mass": 2, "center": [0, 0, 0.1]})");
  EXPECT_EQ(by_body.joints[1].mass, 3);
  const Vec<3> moment = 3 * by_body.joints[1].center - bare.joints[1].mass * bare.joints[1].center;
  EXPECT_LT((moment - 2 * Vec<3>(0.1, 0, 0.3)).norm(), 1e-9) << moment.transpose();
  const Vec<3> there = 3 * by_site.joints[1].center - bare.joints[1].mass * bare.joints[1].center;
  const Vec<3> tool(0.1 * std::sin(0.5), 0, 0.3 + 0.1 * std::cos(0.5));
  EXPECT_LT((there - 2 * tool).norm(), 1e-9) << there.transpose();
}

// the frame is the body's, whose joint may stand elsewhere; what is fixed to it is part of it
TEST_F(RobotFiles, BodiesHaveTheMassesThatAreSaid) {
  std::ofstream(folder_ / "arm.xml")
      << "<mujoco><worldbody><body name='b'><joint name='j' pos='0 0 .1' axis='0 1 0'/><geom "
         "size='.1'/><inertial pos='0 0 .2' mass='3' diaginertia='.1 .1 .1'/><body name='part' "
         "pos='0 0 .3'><geom size='.1'/><body name='deeper'><inertial pos='0 0 0' mass='1' "
         "diaginertia='.1 .1 .1'/></body></body></body></worldbody></mujoco>";
  const ArmTree a = arm(R"(, "bodies": {"b": {"mass": 2, "center": [0.1, 0.2, 0.3],
      "inertia": [0.05, 0.04, 0.03, 0.002, -0.001, 0.003]}})");
  EXPECT_EQ(a.joints[0].mass, 2);
  EXPECT_LT((a.joints[0].center - Vec<3>(0.1, 0.2, 0.2)).norm(), 1e-12);
  Mat<3> I;
  I << 0.05, 0.002, -0.001, 0.002, 0.04, 0.003, -0.001, 0.003, 0.03;
  EXPECT_LT((a.joints[0].inertia - I).norm(), 1e-12) << a.joints[0].inertia;
  const ArmTree loaded = arm(R"(, "bodies": {"b": {"mass": 2, "center": [0, 0, 0],
      "inertia": [0.05, 0.04, 0.03, 0, 0, 0]}},
      "payload": {"body": "part", "mass": 2, "center": [0, 0, 0]})");
  EXPECT_EQ(loaded.joints[0].mass, 4);
  EXPECT_LT((loaded.joints[0].center - Vec<3>(0, 0, 0.15 - 0.1)).norm(), 1e-12);
}

// as hundreds of industrial arms have them
TEST_F(RobotFiles, BodiesMakeAnArmOfAFileWithoutMasses) {
  std::ofstream(folder_ / "arm.xml")
      << "<robot name='r'><link name='base'/><link name='l'/><link name='flange'/><joint name='j' "
         "type='continuous'><parent link='base'/><child link='l'/><axis xyz='0 1 0'/></joint>"
         "<joint name='f' type='fixed'><parent link='l'/><child link='flange'/></joint></robot>";
  const std::string file = folder_ / "arm.xml";
  EXPECT_NE(error_of([&] { load_mjcf(file); }).find("tauext-calibrate --masses"),
            std::string::npos);
  const ArmTree a = arm(R"(, "bodies": {"l": {"mass": 2, "center": [0.1, 0, 0],
      "inertia": [0.05, 0.04, 0.03, 0, 0, 0]}})");
  EXPECT_EQ(a.joints[0].mass, 2);
  EXPECT_NEAR(a.usual_torque[0], 2 * 9.81 * 0.1, 0.1);
  ImportOptions how;
  how.masses_unknown = true;
  EXPECT_EQ(import_mjcf(file, how).massless, std::set<std::string>{"l"});
  EXPECT_EQ(tree_of(load_mjcf(file, how)).dof(), 1);
  std::ofstream(folder_ / "arm.xml")
      << "<mujoco><worldbody><body name='b'><joint/></body></worldbody></mujoco>";
  EXPECT_NE(error_of([&] { load_mjcf(file); }).find("tauext-calibrate --masses"),
            std::string::npos);
  EXPECT_EQ(import_mjcf(file, how).massless, std::set<std::string>{"b"});
}

TEST_F(RobotFiles, AnImportedTextHoldsAllOfIt) {
  const auto [path, options] = robot_file(written(
      R"({"format": "tauext-robot-1", "file": "arm.xml",
          "joints": {"elbow": {"coulomb": [3, 2], "offset": -1, "gain": 7}}})"));
  std::ofstream(folder_ / "clean.xml") << import_mjcf(path, options).xml;
  const ArmTree once = tree_of(load_mjcf(folder_ / "clean.xml"));
  std::ofstream(folder_ / "again.xml") << import_mjcf(folder_ / "clean.xml").xml;
  const ArmTree twice = tree_of(load_mjcf(folder_ / "again.xml"));
  for (const ArmTree& a : {once, twice}) {
    EXPECT_EQ(a.joints[1].offset, -0.5);
    EXPECT_EQ(a.joints[1].dry, 2.5);
    EXPECT_EQ(a.gain[1], 7);
  }
}

TEST_F(RobotFiles, ErrorsNameTheKeyAndTheRemedy) {
  const std::string head = R"({"format": "tauext-robot-1", "file": "arm.xml", )";
  for (const auto& [json, words] : std::vector<std::pair<std::string, std::string>>{
           {"", "arm.json: no JSON: it is empty"},
           {"{", "arm.json: no JSON"},
           {"[]", "arm.json is [], no object"},
           {R"({"file": "arm.xml"})", "\"format\" is missing, and must be \"tauext-robot-1\""},
           {R"({"format": "tauext-robot-1"})", "\"file\" must name an MJCF or URDF file"},
           {R"({"format": "tauext-robot-1", "file": "no.xml"})", "no.xml"},
           {head + R"("joint": {}})", "unknown key \"joint\"; known: format, file, lock, joints"},
           {head + R"("joints": {"knee": {"coulomb": 1}}})",
            "arm.xml: unknown joint 'knee'; known: elbow, shoulder"},
           {head + R"("joints": {"elbow": {"coulomb": -1}}})",
            "joint 'elbow': \"coulomb\" is -1, and must be 0 to 1e+06"},
           {head + R"("joints": {"elbow": {"viscous": [1]}}})",
            "\"viscous\" is [1], and must be 2 numbers"},
           {head + R"("joints": {"elbow": {"gain": 0}}})", "\"gain\" is 0"},
           {head + R"("joints": {"elbow": {"effort": 0}}})", "\"effort\" is 0, and must be 1e-06"},
           {head + R"("payload": {"body": "hand", "mass": 1, "center": [0, 0, 0]}})",
            "unknown body 'hand'; known: lower, upper"},
           {head + R"("bodies": []})", "\"bodies\" must be an object, a key for each body"},
           {head + R"("bodies": {"hand": {"mass": 1, "center": [0, 0, 0],
              "inertia": [1, 1, 1, 0, 0, 0]}}})",
            "unknown body with a joint 'hand'; known: lower, upper"},
           {head + R"("bodies": {"lower": {"mass": 0, "center": [0, 0, 0],
              "inertia": [1, 1, 1, 0, 0, 0]}}})",
            "body 'lower': \"mass\" is 0, and must be 1e-06"},
           {head + R"("bodies": {"lower": {"mass": 1, "center": [0, 0, 0],
              "inertia": [1, 1, 2.1, 0, 0, 0]}}})",
            "body 'lower': \"inertia\" has the principal moments 1, 1 and 2.1 kg m^2, and no body"},
           {head + R"("bodies": {"lower": {"mass": 1, "center": [0, 0, 0],
              "inertia": [1, 1, 1]}}})",
            "\"inertia\" is [1,1,1], and must be 6 numbers"},
           {head + R"("payload": {"body": "lower", "mass": -1, "center": [0, 0, 0]}})",
            "payload: \"mass\" is -1"}}) {
    EXPECT_TRUE(error_of_robot(json).starts_with((folder_ / "arm.json").string())) << json;
    EXPECT_NE(error_of_robot(json).find(words), std::string::npos) << json << "\n"
                                                                   << error_of_robot(json);
  }
}

TEST_F(RobotFiles, FilesOfOtherKindsAreNamedWithTheCommandThatConvertsThem) {
  const auto why = [](const std::string& path) { return error_of([&] { robot_file(path); }); };
  EXPECT_EQ(why("ur5e.urdf.xacro"),
            "ur5e.urdf.xacro: xacro has to be run first: xacro ur5e.urdf.xacro > ur5e.urdf (the "
            "package xacro of ROS, or pip's)");
  EXPECT_NE(why("my arm.XACRO").find("xacro 'my arm.XACRO' > 'my arm'.urdf"), std::string::npos)
      << why("my arm.XACRO");
  EXPECT_NE(why("a/b.sdf").find("sdf2mjcf a/b.sdf a/b.xml"), std::string::npos);
  EXPECT_NE(why("a.usdz").find("usd_to_urdf -o a.urdf a.usdz"), std::string::npos);
  EXPECT_NE(why("a.mjb").find("give the MJCF"), std::string::npos);
  EXPECT_NE(why("package://ur_description/urdf/ur5.urdf")
                .find("its file is $(ros2 pkg prefix --share ur_description)/urdf/ur5.urdf"),
            std::string::npos);
  EXPECT_NE(why("file:///a/b.urdf").find("give its path, /a/b.urdf"), std::string::npos);
  EXPECT_NE(why("https://x.org/b.urdf").find("download it first"), std::string::npos);
  for (const char* path : {"a.xml", "a.urdf", "a.mjcf", "wallmobot3", "none.json"})
    EXPECT_EQ(why_other_kind(path), "") << path;
  // what of a folder is a robot
  std::filesystem::create_directories(folder_ / "ur" / "urdf");
  EXPECT_NE(why(folder_ / "ur").find("it is a folder; name an MJCF or URDF file"),
            std::string::npos);
  const auto put = [this](const char* text, const char* name) {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  };
  put("<package/>", "ur/package.xml");
  const std::string urdf = put("<robot/>", "ur/urdf/ur5.urdf"), mjcf = put("<mujoco/>", "ur/a.xml");
  EXPECT_TRUE(why(folder_ / "ur").ends_with("name a robot's file, like " + mjcf + ", " + urdf));
}

}  // namespace
}  // namespace tauext::test

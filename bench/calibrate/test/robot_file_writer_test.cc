// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/robot_file_writer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "mjcf/plant/model.h"
#include "mjcf/plant/tree.h"

namespace tauext::test {
namespace {

// tests run side by side
std::string in_a_place_of_its_own(const std::string& name) {
  const std::string file = "tauext_" + std::to_string(::getpid()) + "_" + name;
  return (std::filesystem::temp_directory_path() / file).string();
}

bool doubts(const CalibratedJoint& j, const std::string& why) {
  return std::any_of(j.doubts.begin(), j.doubts.end(), [&](const std::string& words) {
    return words.find(why) != std::string::npos;
  });
}

// one without a name has that of the import
TEST(RobotFile, NamesJointsAsTheImportDoes) {
  const std::string arm = in_a_place_of_its_own("nameless.xml"),
                    path = in_a_place_of_its_own("nameless.json");
  std::ofstream(arm) << "<mujoco><worldbody><body><joint axis='0 1 0'/><inertial pos='0 0 .3' "
                        "mass='2' diaginertia='.1 .1 .1'/></body></worldbody><actuator/></mujoco>";
  CalibratedJoint joint;
  joint.name = joint_name_in_file(tree_of(load_mjcf(arm)), 0);
  joint.terms = {{"coulomb", 2, 0.1}};
  std::ofstream(path) << robot_file_text({arm, "", {joint}}, path);
  EXPECT_EQ(tree_of(load_mjcf(path)).joints[0].dry, 2);
  std::filesystem::remove(arm);
  std::filesystem::remove(path);
}

// what was not asked for is 0 in the file, too
TEST(RobotFile, FrictionIsWrittenAsAWhole) {
  CalibratedJoint joint;
  joint.name = "elbow";
  joint.terms = {{"viscous", 0.2, 0.1}, {"offset", -0.3, 0.1}};
  const auto json =
      nlohmann::json::parse(robot_file_text({"bench/examples/arm6.xml", "", {joint}}, "-"));
  const auto& elbow = json.at("joints").at("elbow");
  EXPECT_EQ(elbow.at("viscous"), 0.2);
  EXPECT_EQ(elbow.at("coulomb"), 0);
  EXPECT_EQ(elbow.at("offset"), -0.3);
  EXPECT_FALSE(elbow.contains("armature"));
}

// a pendulum of 2 kg at 0.3 m, whose rated torque is 9 N m, and its torque on the way q = sin(t)
class Pendulum : public testing::Test {
 protected:
  Pendulum() { write("2", ".1"); }
  ~Pendulum() override { std::filesystem::remove(path_); }

  void write(const std::string& mass, const std::string& inertia) const {
    std::ofstream(path_)
        << "<robot name='p'><link name='base'/><link name='l'><inertial><origin xyz='0 0 .3'/>"
           "<mass value='"
        << mass << "'/><inertia ixx='" << inertia << "' iyy='" << inertia << "' izz='" << inertia
        << "' ixy='0' ixz='0' iyz='0'/>"
           "</inertial></link><joint name='j' type='revolute'><parent link='base'/><child "
           "link='l'/><axis xyz='0 1 0'/><limit lower='-3' upper='3' effort='9' velocity='3'/>"
           "</joint></robot>";
  }

  // I = 0.1 + 2 * 0.3^2 about the axis, and gravity, which drives it upright
  static Trace moved(double armature, double coulomb) {
    constexpr int n = 4000;
    Trace log;
    log.torque_at_instants = true;
    log.q.resize(1, n), log.qd.resize(1, n), log.tau.resize(1, n);
    for (int k = 0; k < n; ++k) {
      const double t = k * 5e-3, qd = std::cos(t);
      log.t.push_back(t), log.q(0, k) = std::sin(t), log.qd(0, k) = qd;
      log.tau(0, k) = -(0.28 + armature) * std::sin(t) - 2 * 9.81 * 0.3 * std::sin(log.q(0, k)) +
                      (qd > 0 ? coulomb : -coulomb);
    }
    return log;
  }
  // of the recording, judged by the file that it makes
  CalibratedJoint judged(const Trace& log, std::vector<CalibratedTerm> terms) const {
    NewRobotFile robot{path_, "", calibrate_arm(tree_of(load_mjcf(path_)), {log})};
    if (!terms.empty()) robot.joints[0].terms = std::move(terms);
    judge_by_file(robot, {log}, {});
    return robot.joints[0];
  }

  std::string path_ = in_a_place_of_its_own("pendulum.urdf");
};

TEST_F(Pendulum, TheTableIsThatOfTheFile) {
  const Trace log = moved(0.05, 1);
  EXPECT_LT(judged(log, {}).after, 0.02);
  EXPECT_TRUE(judged(log, {}).doubts.empty());
  // nothing of the friction in it: 1 N m is left, and the fit had promised less
  const CalibratedJoint without = judged(log, {{"armature", 0.05}, {"coulomb", 0}});
  EXPECT_NEAR(without.after, 1, 0.01);
  EXPECT_TRUE(doubts(without, "the file would leave"));
}

TEST_F(Pendulum, MoreFrictionThanItsRatedTorqueIsDoubted) {
  EXPECT_TRUE(doubts(judged(moved(0.05, 12), {}), "more than the file's rated torque, 9 N m"));
  EXPECT_TRUE(judged(moved(0.05, 8), {}).doubts.empty());
}

// A link of 2 g, with an armature that comes out negative: a friction of 3 N m would stop it within
// 0.1 ms, and has to be smooth over more than it moves. It is no Coulomb friction out of all
// proportion, then, and no file that has none in it.
TEST_F(Pendulum, FrictionThatCannotBeSimulatedIsDoubted) {
  write("0.002", "1e-4");
  Trace log = moved(-0.2, 3);
  log.tau -= 0.999 * moved(0, 0).tau;
  const CalibratedJoint j = judged(log, {});
  EXPECT_LT(j.terms[1].value, 9);
  EXPECT_TRUE(doubts(j, "its friction must be smooth over"));
}

// the file's link has 0.28 kg m^2 about the axis, and the one that was recorded 0.03
TEST_F(Pendulum, LessThanNoArmatureIsDoubted) {
  const CalibratedJoint j = judged(moved(-0.25, 1), {});
  EXPECT_EQ(j.terms[0].value, 0);
  EXPECT_TRUE(doubts(j, "armature would be -0.25"));
}

TEST(RatedTorque, IsWhatTheFileSays) {
  const std::string path = in_a_place_of_its_own("rated.xml");
  const auto rated = [&](const std::string& joint, const std::string& actuators) {
    std::ofstream(path) << "<mujoco><default><general forcerange='-7 7'/><default class='c'><joint "
                           "actuatorfrcrange='-5 4'/><position forcerange='-6 6' gear='2'/>"
                           "</default></default><worldbody><body><joint name='j' "
                        << joint
                        << "/><inertial pos='0 0 .3' mass='2' diaginertia='.1 .1 .1'/></body>"
                           "</worldbody><actuator>"
                        << actuators << "</actuator></mujoco>";
    return tree_of(load_mjcf(path)).rated_torque[0];
  };
  EXPECT_EQ(rated("", ""), 0);
  EXPECT_EQ(rated("class='c'", ""), 5);
  EXPECT_EQ(rated("actuatorfrcrange='-3 3' class='c'", "<general joint='j'/>"), 3);
  EXPECT_EQ(rated("", "<general joint='j'/>"), 7);
  EXPECT_EQ(rated("", "<position joint='j' class='c' kp='9'/>"), 12);
  EXPECT_EQ(rated("", "<motor joint='j' ctrlrange='-8 8'/>"), 7) << "its default is general's, too";
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
// Other people's URDF (mjcf/import/), beside MuJoCo's own reader.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "mjcf/import/mjcf_text.h"
#include "mjcf/plant/plant.h"
#include "mjcf/plant/simulated.h"
#include "mjcf/plant/test/arm_dynamics.h"
#include "mjcf/plant/test/robot_folder.h"
#include "mjcf/plant/tree.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

class OfUrdf : public RobotFolder {};

// of three joints with everything turned; `more` stands in its robot
std::string urdf(const std::string& more = "") {
  return "<?xml version='1.0'?><robot name='arm'><link name='base'/><link name='upper'><visual>"
         "<geometry><mesh filename='package://gone/upper.stl'/></geometry></visual><inertial>"
         "<origin xyz='.01 .02 .15' rpy='.3 -.2 .5'/><mass value='4'/><inertia ixx='.04' "
         "ixy='.001' ixz='0' iyy='.05' iyz='-.002' izz='.02'/></inertial></link><link name='lower'>"
         "<inertial><origin xyz='0 0 .1'/><mass value='2'/><inertia ixx='.02' ixy='0' ixz='0' "
         "iyy='.02' iyz='0' izz='.01'/></inertial></link><link name='tool'><inertial><mass "
         "value='.5'/><inertia ixx='.002' ixy='0' ixz='0' iyy='.001' iyz='0' izz='.002'/>"
         "</inertial></link><joint name='shoulder' type='revolute'><parent link='base'/><child "
         "link='upper'/><origin xyz='0 .1 .3' rpy='.1 .2 .3'/><axis xyz='0 1 0'/><limit lower='-2' "
         "upper='2' effort='10' velocity='1'/><dynamics damping='.5' friction='.3'/></joint>"
         "<joint name='elbow' type='continuous'><parent link='upper'/><child link='lower'/><origin "
         "xyz='0 0 .3' rpy='-.4 0 1'/><axis xyz='1 0 1'/></joint><joint name='lift' "
         "type='prismatic'><parent link='lower'/><child link='tool'/><origin xyz='0 0 .2' rpy='0 "
         "1 0'/><axis xyz='0 0 1'/><limit lower='0' upper='.1' effort='10' velocity='1'/></joint>" +
         more + "</robot>";
}

TEST_F(OfUrdf, IsTheArmThatMuJoCosOwnReaderMakes) {
  if (mjVERSION_HEADER >= 300) GTEST_SKIP() << "MuJoCo 3 does not turn inertias by <origin rpy>";
  const std::string flange =
      "<link name='flange'><inertial><origin xyz='.02 0 .03' rpy='.5 .1 0'/><mass value='.7'/>"
      "<inertia ixx='.003' ixy='.0002' ixz='0' iyy='.002' iyz='0' izz='.004'/></inertial></link>"
      "<joint name='bolts' type='fixed'><parent link='lower'/><child link='flange'/><origin "
      "xyz='0 .05 .1' rpy='.3 -.7 .2'/></joint>";
  const std::string path = put(urdf(flange), "arm.urdf");
  const TreeModel<3> tree = tree_model<3>(load_mjcf(path));
  char why[1000];
  const Model own(mj_loadXML(path.c_str(), nullptr, why, sizeof why),
                  [](const mjModel* m) { mj_deleteModel(const_cast<mjModel*>(m)); });
  ASSERT_NE(own, nullptr) << why;
  const MjcfArm<3> oracle(own);
  const Vec<3> q(0.4, -1.1, 0.05), qd(0.7, -0.3, 0.2);
  EXPECT_LT((tree.inertia(q) - oracle.inertia(q)).norm(), 1e-8);  // MuJoCo finds axes to 1e-8
  EXPECT_LT((tree.bias(q, qd) - oracle.bias(q, qd)).norm(), 1e-8);
  EXPECT_LT((tree.friction(qd) - oracle.friction(qd)).norm(), 1e-9);
  EXPECT_GT(tree.friction(qd)[0], 0.5);
}

TEST_F(OfUrdf, SaysWhatDrivesCanDoAndARobotFileKnowsBetter) {
  const auto says = [&](const ArmTree& tree, const Vec<3>& torque, const Vec<3>& speed) {
    EXPECT_EQ(tree.rated_torque, torque);
    EXPECT_EQ(tree.rated_speed, speed);
  };
  says(tree_of(load_mjcf(put(urdf(), "arm.urdf"))), {10, 0, 10}, {1, 0, 1});
  says(tree_of(load_mjcf(put(R"({"format": "tauext-robot-1", "file": "arm.urdf", "joints": {
           "shoulder": {"velocity": 3}, "elbow": {"effort": 7}}})",
                             "arm.json"))),
       {10, 7, 10}, {3, 0, 1});
}

// as in many robots' URDF, where the world is a link
TEST_F(OfUrdf, MayCallItsBaseTheWorld) {
  std::string text = urdf();
  for (std::size_t at; (at = text.find("'base'")) != text.npos;) text.replace(at, 6, "'world'");
  EXPECT_EQ(tree_of(load_mjcf(put(text, "arm.urdf"))).dof(), 3);
}

// what a URDF cannot say otherwise
TEST_F(OfUrdf, TakesAnArmatureAndALinkForTheEndEffector) {
  std::string text = urdf(
      "<link name='end_effector'/><joint name='tip' type='fixed'><parent link='tool'/><child "
      "link='end_effector'/><origin xyz='0 .1 .25'/></joint>");
  const std::string friction = "friction='.3'";
  text.insert(text.find(friction), "armature='.2' ");
  const Model model = load_mjcf(put(text, "arm.urdf"));
  const ArmTree tree = tree_of(model);
  EXPECT_EQ(tree.joints[0].armature, 0.2);
  EXPECT_EQ(tree.joints[1].armature, 0);
  EXPECT_EQ(tree.end_effector, "the origin of the body 'end_effector'");
  EXPECT_EQ(tree.point("end_effector").joint, 2);
  EXPECT_LT((tree.point("end_effector").place - Vec<3>(0, 0.1, 0.25)).norm(), 1e-12);
  Plant plant(model);
  plant.set_state(Vec<3>(0.4, -1.1, 0.05), Vec<3>::Zero());
  const Vec<3> at = tree_model<3>(model).position(Vec<3>(0.4, -1.1, 0.05), 2, Vec<3>(0, 0.1, 0.25));
  EXPECT_LT((plant.end_effector().position - (tree.base + at)).norm(), 1e-9);
}

TEST_F(OfUrdf, SaysWhatIsWrong) {
  const auto error = [&](const std::string& more, const std::string& lock = "") {
    const std::string path = put(urdf(more), "arm.urdf");
    return error_of([&] { tree_of(load_mjcf(path, {lock})); });
  };
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  const std::string fingers =
      "<link name='a'><inertial><mass value='.1'/><inertia ixx='1e-3' iyy='1e-3' izz='1e-3'/>"
      "</inertial></link><joint name='left' type='prismatic'><parent link='tool'/><child "
      "link='a'/></joint><link name='b'><inertial><mass value='.1'/><inertia ixx='1e-3' "
      "iyy='1e-3' izz='1e-3'/></inertial></link><joint name='right' type='prismatic'><parent "
      "link='tool'/><child link='b'/><mimic joint='left'/></joint>";
  EXPECT_EQ(error(fingers, "left|right"), "no error");
  std::string geared = fingers;
  geared.insert(geared.find("joint='left'/>"), "multiplier='-2' offset='.01' ");
  const ArmTree arm = tree_of(load_mjcf(put(urdf(geared), "arm.urdf")));
  ASSERT_EQ(arm.dof(), 4);
  EXPECT_LT((arm.drho.col(3) - (Eigen::VectorXd(5) << 0, 0, 0, 1, -2).finished()).norm(), 1e-15);
  EXPECT_LT((arm.rho0 - (Eigen::VectorXd(5) << 0, 0, 0, 0, .01).finished()).norm(), 1e-15);
  for (const char* leader : {"joint='lifft'", "", "joint='right'"}) {
    std::string astray = fingers;
    astray.replace(astray.find("joint='left'/>"), 12, leader);
    has(error(astray), "joint 'right': its <mimic> follows");
    EXPECT_TRUE(error(astray).ends_with("; to mend it: --lock 'right'")) << error(astray);
    EXPECT_EQ(error(astray, "right"), "no error");
  }
  has(error("<joint name='x' type='fixed'><parent link='tool'/><child link='none'/></joint>"),
      "joint 'x': its child 'none' is no link");
  has(error("<link name='alone'/>"),
      "2 links are no child of a joint, and one must be: the base; join the others to it, or take "
      "them out: alone, base");
  has(error("<link name='c'/><joint name='y' type='floating'><parent link='tool'/><child "
            "link='c'/></joint>"),
      "joint 'y' is floating");
  has(error("<xacro:include filename='x'/>"), "run it through xacro: xacro FILE > arm.urdf");
  EXPECT_EQ(error("<xacro:property name='width' value='.2'/>"), "no error") << "nobody asks for it";
  has(error("<link name='c'/><joint name='y' type='fixed'><parent link='tool'/><child link='c'/>"
            "<origin xyz='0 0'/></joint>"),
      "xyz of <origin> is '0 0', and must be 3 numbers");
  const auto limited = [](const std::string& type, const std::string& limit) {
    return "<link name='c'/><joint name='y' type='" + type +
           "'><parent link='tool'/><child link='c'/><limit " + limit + "/></joint>";
  };
  has(error(limited("revolut", "lower='-1' upper='1'")), "joint 'y' is revolut");
  has(error(limited("revolute", "lower='2' upper='-2'")), "no way to go from 2 to -2");
  has(error(limited("revolute", "lower='-170' upper='170'")),
      "joint 'y' goes from -170 to 170 rad: give radians");
  has(error(limited("revolute", "lower='-1' upper='1'")),
      "links that move and have no mass (give them an <inertial>, or --lock their joints, or find "
      "the masses from recordings: tauext-calibrate --masses): 'c' (line");
}

TEST_F(OfUrdf, MayDescribeControllersAndSensorsBesideTheArm) {
  const std::string path = put(
      urdf("<ros2_control name='r'><joint name='shoulder'/></ros2_control><sensor name='c'><parent "
           "link='tool'/><origin xyz='0 0 1'/></sensor><transmission name='x'><joint name='elbow'/>"
           "</transmission>"),
      "arm.urdf");
  EXPECT_EQ(tree_of(load_mjcf(path)).dof(), 3);
}

// as Franka's files have them
TEST_F(OfUrdf, AttributesThatNobodyKnowsAreLeftOutAndNamed) {
  std::string text = urdf();
  const auto add = [&](const std::string& behind, const std::string& attributes) {
    text.insert(text.find(behind) + behind.size(), attributes);
  };
  add("<dynamics", " D='1' K='7000' mu_coulomb='0' mu_viscous='16'");
  add("<axis", " rpy='0 0 0'");
  add("<inertia ", "iyx='0' ");
  add("<link name='lower'>", "<gravity>1</gravity>");
  add("velocity='1'/>", "<anchor xyz='0 0 0'/>");
  const std::string path = put(text, "arm.urdf");
  const ArmTree arm = tree_of(load_mjcf(path));
  const ArmTree plain = tree_of(load_mjcf(put(urdf(), "plain.urdf")));
  ASSERT_EQ(arm.joints.size(), plain.joints.size());
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    EXPECT_EQ(arm.joints[i].viscous, plain.joints[i].viscous);
    EXPECT_EQ(arm.joints[i].inertia, plain.joints[i].inertia);
    EXPECT_EQ(arm.joints[i].axis, plain.joints[i].axis);
  }
  const auto left_out = import_mjcf(path).dropped;
  for (const char* name : {"dynamics.D", "dynamics.K", "dynamics.mu_coulomb", "dynamics.mu_viscous",
                           "axis.rpy", "inertia.iyx", "gravity", "anchor"})
    EXPECT_EQ(left_out.count(name), 1u) << name;
}

std::string inertial(const char* mass, const char* x, const char* y, const char* z) {
  return fmt::format("<inertial><mass value='{}'/><inertia ixx='{}' iyy='{}' izz='{}'/></inertial>",
                     mass, x, y, z);
}
std::string fixed_to(const char* parent, const char* link, const std::string& inertial) {
  return fmt::format(
      "<link name='{0}'>{1}</link><joint name='{0}_bolts' type='fixed'><parent link='{2}'/><child "
      "link='{0}'/><origin xyz='0 0 .25'/></joint>",
      link, inertial, parent);
}

TEST_F(OfUrdf, PartsThatAreFixedToEachOtherAreJudgedByTheirSum) {
  const auto arm = [&](const std::string& more) {
    return tree_of(load_mjcf(put(urdf(more), "arm.urdf")));
  };
  const ArmTree plain = arm("");
  const ArmTree same = arm(fixed_to("tool", "frame", inertial("0", "0", "0", "0")) +
                           fixed_to("base", "stand", inertial("9", ".112", ".0065", ".0057")));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(same.joints[i].mass, plain.joints[i].mass);
    EXPECT_LT((same.joints[i].inertia - plain.joints[i].inertia).norm(), 1e-12);
  }
  // a point of 0.3 kg, 0.25 m above 0.5 kg; Steiner's terms are those of the reduced mass
  const TreeJoint tool = arm(fixed_to("tool", "point", inertial(".3", "0", "0", "0"))).joints[2];
  EXPECT_NEAR(tool.mass, 0.8, 1e-12);
  EXPECT_LT((Eigen::Vector3d::Map(&tool.center[0]) - Eigen::Vector3d(0, 0, .25 * .3 / .8)).norm(),
            1e-12);
  const double more = .5 * .3 / .8 * .25 * .25;
  EXPECT_LT((tool.inertia - plain.joints[2].inertia -
             Eigen::Vector3d(more, more, 0).asDiagonal().toDenseMatrix())
                .norm(),
            1e-9);
  // what is locked is fixed
  const std::string finger =
      "<link name='f'>" + inertial("1e-9", "0", "0", "0") +
      "</link><joint name='grip' type='prismatic'><parent link='tool'/><child link='f'/></joint>";
  EXPECT_EQ(tree_of(load_mjcf(put(urdf(finger), "arm.urdf"), {.lock = "grip"})).dof(), 3);
  EXPECT_NE(error_of([&] { arm(finger); }).find("body 'f' moves, and mass or inertia of it is not"),
            std::string::npos);
}

TEST_F(OfUrdf, InertiasThatNoBodyHasAreMendedIfLittleIsMissingOrIfAsked) {
  const auto of = [&](const char* largest, bool balance) {
    std::string text = urdf();
    text.replace(text.find("ixx='.02'"), 9, fmt::format("ixx='{}'", largest));
    return import_mjcf(put(text, "arm.urdf"), {.balance = balance});
  };
  EXPECT_TRUE(of(".0299", false).changed.empty());
  EXPECT_EQ(of(".03001", false).changed.begin()->first, "inertia of 'lower' by 0.011 %");
  EXPECT_NE(error_of([&] { of(".0301", false); }).find("'lower' (line 1) 0.01, 0.02 and 0.0301"),
            std::string::npos);
  EXPECT_NE(error_of([&] { of(".04", false); }).find("'lower' (line 1) 0.01, 0.02"),
            std::string::npos);
  // a third of what is missing from each: .04 = .02 + .01 + .01
  EXPECT_EQ(of(".04", true).changed.begin()->first, "inertia of 'lower' by 9.1 %");
  std::string point = urdf();
  for (const char* moment : {"ixx='.02'", "iyy='.02'", "izz='.01'"})
    point.replace(point.find(moment, point.find("'lower'")) + 5, 3, "4e-18");
  EXPECT_NE(error_of([&] { load_mjcf(put(point, "arm.urdf")); }).find("'lower' (line 1)"),
            std::string::npos);
  const double r = std::cbrt(2 / 4189.);
  EXPECT_LT((tree_of(load_mjcf(put(point, "arm.urdf"), {.balance = true})).joints[1].inertia -
             .8 * r * r * Mat<3>::Identity())
                .norm(),
            1e-9);
}

TEST_F(OfUrdf, EveryErrorIsInOneMessage) {
  std::string text = urdf();
  const auto change = [&](const std::string& what, const std::string& by) {
    text.replace(text.find(what), what.size(), by);
  };
  change("ixx='.02'", "ixx='.09'");
  change("ixx='.002'", "ixx='.09'");
  change("damping=", "dampping=");
  change("'continuous'", "'floating'");
  change("<link name='base'/>", "<link name='base'/><link name='base'/>");
  const std::string error = error_of([&] { import_mjcf(put(text, "arm.urdf")); });
  for (const char* part : {"there are two links 'base'", "2 links have", "'lower' (line 1) 0",
                           "'tool' (line 1) 0", "no 'dampping'", "joint 'elbow' is floating"})
    EXPECT_NE(error.find(part), std::string::npos) << part << ": " << error;
  EXPECT_EQ(error.find("'upper'"), std::string::npos) << error;
}

TEST_F(OfUrdf, LimitsMayBeInfiniteAndAFileOfMacrosIsNamed) {
  std::string text = urdf();
  text.replace(text.find("lower='-2' upper='2'"), 20, "lower='-inf' upper='INF'");
  EXPECT_EQ(import_mjcf(put(text, "arm.urdf")).dropped.at("endless limit"), 2);
  EXPECT_EQ(error_of([&] { import_mjcf(put("<robot name='x'></robot>", "arm.urdf")); }),
            "line 1: there is no link in it; is it a file of macros (xacro)?");
}

TEST_F(OfUrdf, LimitsThatLeaveNoWayAreNoneAndNamed) {
  std::string text = urdf();
  text.replace(text.find("lower='-2' upper='2'"), 20, "lower='0' upper='0'");
  const std::string path = put(text, "arm.urdf");
  EXPECT_EQ(import_mjcf(path).dropped.at("limits of 0 and 0"), 1);
  EXPECT_TRUE(std::isinf(tree_of(load_mjcf(path)).upper[0]));
}

TEST_F(OfUrdf, ALimitOnOneSideStays) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  for (const auto& [limit, lower, upper] : std::vector<std::tuple<const char*, double, double>>{
           {"lower='-2' upper='inf'", -2, kNone},
           {"lower='-inf' upper='2'", -kNone, 2},
           {"lower='-1e5' upper='.5'", -kNone, .5},
           {"lower='-1'            ", -1, 0}}) {  // 0 is what URDF says of one that is not there
    std::string text = urdf();
    text.replace(text.find("lower='-2' upper='2'"), 20, limit);
    const std::string path = put(text, "arm.urdf");
    const ArmTree arm = tree_of(load_mjcf(path));
    EXPECT_EQ(arm.lower[0], lower) << limit;
    EXPECT_EQ(arm.upper[0], upper) << limit;
    EXPECT_EQ(import_mjcf(path).dropped.count("endless limit"),
              std::isinf(upper - lower) ? 1u : 0u);
    // of 6.5 kg at most 0.8 m away
    EXPECT_LT(arm.usual_torque[0], 6.5 * 9.81 * .8) << limit;
    EXPECT_GT(arm.usual_torque[0], 5) << limit;
  }
}

TEST_F(OfUrdf, EveryFaultOfAJointIsNamedAtOnce) {
  std::string text = urdf();
  const auto change = [&](const std::string& what, const std::string& by) {
    text.replace(text.find(what), what.size(), by);
  };
  change("<axis xyz='0 1 0'/>", "<axis xyz='0 0 0'/>");
  change("lower='-2' upper='2'", "lower='2' upper='-2'");
  change("damping='.5' friction='.3'", "damping='-.5' friction='-.3'");
  const std::string error = error_of([&] { import_mjcf(put(text, "arm.urdf")); });
  for (const char* part : {"its axis has no direction", "no way to go from 2 to -2",
                           "its damping is -0.5", "its friction is -0.3"})
    EXPECT_NE(error.find(part), std::string::npos) << part << ": " << error;
}

// MuJoCo has both joints in one body
TEST_F(OfUrdf, AFrameBetweenJointsNeedsNoMass) {
  const auto wrist = [](const std::string& of_frame) {
    return urdf("<link name='frame'>" + of_frame +
                "</link><joint name='a' type='revolute'><parent link='base'/><child link='frame'/>"
                "<origin xyz='1 0 0'/><axis xyz='0 1 0'/></joint><link name='w'><inertial><origin "
                "xyz='.1 .2 .3'/><mass value='3'/><inertia ixx='.02' iyy='.03' izz='.04'/>"
                "</inertial></link><joint name='b' type='revolute'><parent link='frame'/><child "
                "link='w'/><axis xyz='1 0 0'/></joint>");
  };
  const std::string path = put(wrist(""), "arm.urdf");
  EXPECT_EQ(import_mjcf(path).changed.size(), 1u);
  const TreeModel<2> one = tree_model<2>(load_mjcf(path, {"shoulder|elbow|lift"}));
  const TreeModel<2> two = tree_model<2>(load_mjcf(put(
      "<mujoco><worldbody><body pos='1 0 0'><inertial pos='.1 .2 .3' mass='3' diaginertia='.02 .03 "
      ".04'/><joint name='a' axis='0 1 0'/><joint name='b' axis='1 0 0'/></body></worldbody>"
      "<actuator><motor joint='a'/><motor joint='b'/></actuator></mujoco>")));
  const Vec<2> q(0.4, -1.1), qd(0.7, -0.3);
  EXPECT_LT((one.inertia(q) - two.inertia(q)).norm(), 1e-10);
  EXPECT_LT((one.bias(q, qd) - two.bias(q, qd)).norm(), 1e-10);
  // a part that somebody drew will have one
  EXPECT_NE(error_of([&] {
              import_mjcf(put(wrist("<visual/>"), "arm.urdf"));
            }).find("tauext-calibrate --masses): 'frame'"),
            std::string::npos);
}

TEST_F(OfUrdf, WhatIsOutOfPlaceIsAnErrorOnlyWhereItIsMissing) {
  std::string text = urdf(
      "<link name='eye'><origin xyz='1 1 1'/></link><joint name='screws' "
      "type='fixed'><parent link='tool'/><child link='eye'/></joint>");
  const auto left_out = import_mjcf(put(text, "arm.urdf")).dropped;
  EXPECT_EQ(left_out.count("origin in <link>"), 1u);
  text.insert(text.find("<origin xyz='1 1 1'/>"),
              "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1'/></inertial>");
  EXPECT_NE(error_of([&] {
              import_mjcf(put(text, "arm.urdf"));
            }).find("link 'eye': <origin> stands within <link>, and belongs into inertial joint"),
            std::string::npos);
}

// as PR2's files have them
TEST_F(OfUrdf, PartsWithinForeignElementsAreLeftOutAndCounted) {
  const std::string path =
      put(urdf("<gazebo><link name='a'><inertial><mass>1</mass></inertial></link><link name='b'/>"
               "<joint name='j' type='fixed'/></gazebo><transmission><joint name='elbow'/>"
               "</transmission><group><link name='x'><inertial/></link></group>"),
          "arm.urdf");
  EXPECT_EQ(tree_of(load_mjcf(path)).dof(), 3);
  const auto left_out = import_mjcf(path).dropped;
  EXPECT_EQ(left_out.at("link in <gazebo>"), 1) << "b is a name";
  EXPECT_EQ(left_out.at("joint in <gazebo>"), 1);
  EXPECT_EQ(left_out.at("link in <group>"), 1);
  EXPECT_EQ(left_out.count("joint in <transmission>"), 0u);
}

TEST_F(OfUrdf, AnAxisThatMovesNothingOrSaysTheSameMayStandThere) {
  const std::string fixed =
      "<link name='eye'/><joint name='screws' type='fixed'><parent link='tool'/><child "
      "link='eye'/><axis xzy='0 0 1'/><axis xyz='1 0 0'/></joint>";
  std::string text = urdf(fixed);
  const std::string axis = "<axis xyz='1 0 1'/>";
  text.replace(text.find(axis), axis.size(), axis + "<axis xyz='1.0 0  1'/>");
  const std::string path = put(text, "arm.urdf");
  const auto left_out = import_mjcf(path).dropped;
  EXPECT_EQ(left_out.at("second axis"), 2);
  EXPECT_EQ(left_out.at("axis.xzy"), 1);
  EXPECT_EQ(tree_of(load_mjcf(path)).joints[1].axis,
            tree_of(load_mjcf(put(urdf(), "plain.urdf"))).joints[1].axis);
  text.replace(text.find("'1.0 0  1'"), 10, "'1.0 0 -1'");
  EXPECT_NE(
      error_of([&] { import_mjcf(put(text, "arm.urdf")); }).find("joint 'elbow': a second <axis>"),
      std::string::npos);
}

// as Robotiq's grippers have them
TEST_F(OfUrdf, LimitsOfAFollowerThatItsMimicContradictsAreLeftOutAndCounted) {
  const auto finger = [](const char* name, const char* limit, const std::string& mimic) {
    return fmt::format(
        "<link name='{0}'><inertial><mass value='.1'/><inertia ixx='1' iyy='1' izz='1'/></inertial>"
        "</link><joint name='to_{0}' type='revolute'><parent link='tool'/><child "
        "link='{0}'/><limit "
        "{1}/>{2}</joint>",
        name, limit, mimic);
  };
  const auto path = [&](const char* multiplier) {
    return put(urdf(finger("b", "lower='0' upper='.9'",
                           fmt::format("<mimic joint='to_a' multiplier='{}'/>", multiplier)) +
                    finger("a", "lower='0' upper='.8'", "")),
               "arm.urdf");
  };
  for (const auto& [multiplier, left_out, upper] :
       {std::tuple("-1", 1u, .8), {"1", 0u, .8}, {"1.5", 0u, .6}}) {
    const std::string file = path(multiplier);
    EXPECT_EQ(import_mjcf(file).dropped.count("limits that a <mimic> contradicts"), left_out);
    const ArmTree arm = tree_of(load_mjcf(file));
    EXPECT_NEAR(arm.upper[3], upper, 1e-12) << multiplier;
    EXPECT_NEAR(arm.lower[3], 0, 1e-12) << multiplier;
  }
}

TEST_F(OfUrdf, ARingNamesItsJoints) {
  const auto loose = [](const char* link, const char* parent) {
    return fmt::format(
        "<link name='{0}'/><joint name='to_{0}' type='fixed'><parent link='{1}'/><child "
        "link='{0}'/></joint>",
        link, parent);
  };
  const auto error = [&](const std::string& text) {
    return error_of([&] { import_mjcf(put(text, "arm.urdf")); });
  };
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  // beside the arm: one of two with a link that hangs on it, and one of itself
  const std::string two = error(urdf(loose("a", "c") + loose("b", "a") + loose("c", "b") +
                                     loose("d", "b") + loose("e", "e")));
  has(two, "the joints 'to_b', 'to_c', 'to_a' go round in a ring: take out one of them");
  has(two, "the joints 'to_e' go round in a ring");
  EXPECT_EQ(two.find("to_d"), two.npos) << two;
  has(error("<robot name='r'>" + loose("a", "b") + loose("b", "a") + "</robot>"),
      "the joints 'to_b', 'to_a' go round in a ring");
}

TEST_F(OfUrdf, InUtf16NamesTheCommandThatMendsIt) {
  std::string wide = "\xFF\xFE";
  for (const char c : urdf()) wide += {c, '\0'};
  std::string other = wide.substr(2);
  for (std::size_t i = 0; i < other.size(); i += 2) std::swap(other[i], other[i + 1]);
  for (const auto& [text, letters] :
       {std::pair(wide, "UTF-16"), std::pair(wide.substr(2), "UTF-16LE"),
        std::pair(other, "UTF-16BE")}) {
    const std::string file = put(text, "arm.urdf");
    const std::string error = error_of([&] { import_mjcf(file); });
    EXPECT_NE(error.find(fmt::format("UTF-8 is read: iconv -f {} -t UTF-8 ", letters)),
              std::string::npos)
        << error;
    EXPECT_TRUE(error.ends_with("arm.utf8.urdf")) << error;
  }
}

TEST_F(OfUrdf, TooManyJointsAreNamedWithWhatElseIsWrong) {
  std::string more;
  for (int i = 0; i < 9; ++i)
    more += fmt::format(
        "<link name='f{0}'><inertial><mass value='.1'/><inertia ixx='1' iyy='1' izz='{1}'/>"
        "</inertial></link><joint name='g{0}' type='continuous'><parent link='tool'/><child "
        "link='f{0}'/></joint>",
        i, i == 0 ? 3 : 1);
  const std::string error = error_of([&] { load_mjcf(put(urdf(more), "arm.urdf")); });
  EXPECT_NE(error.find("'f0' (line 1) 1, 1 and 3"), error.npos) << error;
  EXPECT_NE(error.find("estimators take arms of 8 joints at most, and here are 12"), error.npos)
      << error;
}

TEST_F(OfUrdf, AJointOfAnyTypeCanBeLocked) {
  const std::string path = put(
      urdf("<link name='c'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1'/></inertial>"
           "</link><joint name='y' type='floating'><parent link='tool'/><child link='c'/></joint>"),
      "arm.urdf");
  EXPECT_NEAR(tree_of(load_mjcf(path, {"y"})).joints[2].mass, 1.5, 1e-12);
}

TEST_F(OfUrdf, WithoutAnyMassNamesTheWaysToGetOne) {
  std::string text = urdf();
  for (std::size_t at; (at = text.find("<inertial>")) != text.npos;)
    text.erase(at, text.find("</inertial>") + 11 - at);
  const std::string error = error_of([&] { load_mjcf(put(text, "arm.urdf")); });
  EXPECT_NE(error.find("none of its links that move has a mass ('tool' (line 1), 'lower' (line 1), "
                       "'upper' (line 1)), and dynamics needs them"),
            std::string::npos)
      << error;
  EXPECT_NE(error.find("tauext-calibrate --masses"), std::string::npos);
  EXPECT_EQ(error.find("to mend it"), std::string::npos) << error;
}

// a finger without a mass, which floats, and a link whose inertia no body has
TEST_F(OfUrdf, TheRemedyOfAllIsOneCommand) {
  std::string text = urdf(
      "<link name='f'/><joint name='grip' type='prismatic'><parent link='tool'/><child link='f'/>"
      "</joint><link name='c'/><joint name='y' type='floating'><parent link='tool'/><child "
      "link='c'/></joint>");
  const auto error = [&] { return error_of([&] { load_mjcf(put(text, "arm.urdf")); }); };
  EXPECT_TRUE(error().ends_with("; to mend it: --lock 'grip|y'")) << error();
  text.replace(text.find("ixx='.02'"), 9, "ixx='.04'");
  const std::string path = put(text, "arm.urdf");
  EXPECT_TRUE(error().ends_with("; to mend it: tauext-import " + path +
                                " --lock 'grip|y' --balance --out arm.xml"))
      << error();
  EXPECT_EQ(tree_of(load_mjcf(path, {.lock = "grip|y", .balance = true})).dof(), 3);
}

TEST_F(OfUrdf, TellsTypingErrorsAndBodiesThatCannotBe) {
  for (const auto& [right, wrong, words] : std::vector<std::array<const char*, 3>>{
           {"damping=", "dampping=", "joint 'shoulder': <dynamics> knows no 'dampping'; known: da"},
           {"friction=", "frictionloss=", "<dynamics> knows no 'frictionloss'; known: da"},
           {"rpy=", "quat_xyzw=", "<origin> knows no 'quat_xyzw'; known: xyz rpy"},
           {"<dynamics", "<dynamcis",
            "this import knows no <dynamcis>; did you mean 'dynamics'? If"},
           {"<axis xyz='0 1 0'/>", "<AXIS xyz='0 1 0'/>", "did you mean 'axis'?"},
           {"<axis xyz='0 1 0'", "<axis value='0 1 0'", "<axis> knows no 'value'; known: xyz"},
           {"<dynamics damping='.5' friction='.3'/>", "<xacro:motor/>", "run it through xacro"},
           {"'upper'", "'${side}_upper'", "this is no URDF yet"},
           {"<axis xyz='0 1 0'/>", "<axis xyz='0 1 0'><limit upper='1'/></axis>",
            "<limit> stands within <axis>, and belongs into joint"},
           {"rpy='.3", "rpy='90", "rpy is 90 -0.2 0.5, more than two turns: it is in rad"},
           {"velocity='1'", "velocity='1,5'", "velocity of <limit> is '1,5', and must be a number"},
           {"lower='-2' upper='2'", "lower='3000' upper='2000'", "no way to go from 3000 to 2000"},
           {"</robot>", "</robot><robot/>", "a second <robot> behind the first"},
           {"<limit", "<limits", "joint 'shoulder': this import knows no <limits>; did you mean"},
           {"<dynamics", "<dynamics/><dynamics", "joint 'shoulder': a second <dynamics>"},
           {"damping='.5'", "damping='-1'", "its damping is -1, and must be 0 or more"},
           {"damping='.5'", "spring_stiffness='3'", "joint 'shoulder' has a spring"},
           {"value='4'", "value='2,6'", "mass> is '2,6', and must be a number, with a point"},
           {"value='4'", "value='-4'", "link 'upper': its mass is -4 kg"},
           {"ixx='.02'", "ixx='.09'",
            "a link has principal moments of inertia [kg m^2] that no body has"},
           {"xyz='1 0 1'", "xyz='0 0 0'", "joint 'elbow': its axis has no direction"},
           {"'elbow'", "'shoulder'", "there are two joints 'shoulder'"},
           {"<joint name='elbow'", "<jiont name='elbow'",
            "did you mean 'joint'? If not, take it out"},
           {"<link name='upper'", "<link nam='upper'", "a link without a name"},
           {"</visual>", "</visul>", "line 1: no XML (mismatched element)"}}) {
    std::string text = urdf();
    text.replace(text.find(right), std::string(right).size(), wrong);
    if (const auto at = text.find("<jiont"); at != text.npos)
      text.replace(text.find("</joint>", at), 8, "</jiont>");
    const std::string error = error_of([&] { load_mjcf(put(text, "arm.urdf")); });
    EXPECT_NE(error.find(words), std::string::npos) << error;
  }
}
}  // namespace
}  // namespace tauext::test

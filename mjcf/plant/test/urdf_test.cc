// SPDX-License-Identifier: Apache-2.0
// Other people's URDF (mjcf/import/), beside MuJoCo's own reader.
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <array>
#include <string>
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
  const std::string path = put(urdf(), "arm.urdf");
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
  }
  has(error("<joint name='x' type='fixed'><parent link='tool'/><child link='none'/></joint>"),
      "joint 'x': its child 'none' is no link");
  has(error("<link name='alone'/>"), "2 links are no child");
  has(error("<link name='c'/><joint name='y' type='floating'><parent link='tool'/><child "
            "link='c'/></joint>"),
      "joint 'y' is floating");
  has(error("<xacro:include filename='x'/>"), "xacro");
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
      "body 'c' moves, and mass or inertia of it is not above 0");
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
                           "axis.rpy", "inertia.iyx"})
    EXPECT_EQ(left_out.count(name), 1u) << name;
}

TEST_F(OfUrdf, TellsTypingErrorsAndBodiesThatCannotBe) {
  for (const auto& [right, wrong, words] : std::vector<std::array<const char*, 3>>{
           {"damping=", "dampping=", "joint 'shoulder': <dynamics> knows no 'dampping'; known: da"},
           {"friction=", "frictionloss=", "<dynamics> knows no 'frictionloss'; known: da"},
           {"rpy=", "quat_xyzw=", "<origin> knows no 'quat_xyzw'; known: xyz rpy"},
           {"<dynamics", "<dynamcis",
            "this import knows no <dynamcis>; did you mean 'dynamics'? If"},
           {"<visual>", "<visula/><visual>", "link 'upper': this import knows no <visula>"},
           {"<dynamics", "<dynamics/><dynamics", "joint 'shoulder': a second <dynamics>"},
           {"damping='.5'", "damping='-1'", "its damping is -1, and must be 0 or more"},
           {"value='4'", "value='2,6'", "mass> is '2,6', and must be a number, with a point"},
           {"value='4'", "value='-4'", "link 'upper': its mass is -4 kg"},
           {"ixx='.02'", "ixx='.09'", "link 'lower': its principal moments"},
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

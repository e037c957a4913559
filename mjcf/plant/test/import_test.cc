// SPDX-License-Identifier: Apache-2.0
// Other people's MJCF (mjcf/import/), as MuJoCo then reads it.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
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

namespace fs = std::filesystem;

// two links, and a hand whose fingers an equality ties: as newer MuJoCo has it, or (`plain`) as
// MuJoCo 2.2.2 reads it, the fingers fixed
std::string arm(bool plain) {
  const auto newer = [plain](const char* words) { return plain ? "" : words; };
  return fmt::format(
      "<mujoco model='arm'><compiler angle='radian' {}/>{}"
      "<worldbody>{}<body name='base'><body name='upper' pos='0 0 .3' {}>"
      "<inertial pos='.01 .02 .15' mass='4' diaginertia='.04 .05 .01'/>"
      "<joint name='shoulder' axis='0 1 0' damping='.5' frictionloss='.3' armature='.1' {}/>{}"
      "<body name='lower' pos='0 .01 .3'><joint name='elbow' axis='1 0 0' damping='.2'/>"
      "<geom type='capsule' size='.03' fromto='0 0 0 0 0 .2' {}/>"
      "<body name='hand' pos='0 0 .2'><inertial pos='0 0 .02' mass='.7' fullinertia='2e-3 2e-3 "
      "1e-3 1e-4 0 0'/>"
      "<body name='left' pos='0 .03 .05'><inertial pos='0 0 .01' mass='.1' diaginertia='1e-4 1e-4 "
      "1e-5'/>{}</body>"
      "<body name='right' pos='0 -.03 .05'><inertial pos='0 0 .01' mass='.1' diaginertia='1e-4 "
      "1e-4 1e-5'/>{}</body></body></body></body></body></worldbody>{}</mujoco>",
      newer("autolimits='true' meshdir='assets'"),
      newer("<option integrator='implicitfast'/><visual><global offwidth='100'/></visual>"
            "<asset><mesh file='link.obj' maxhullvert='20'/><material name='grey'/></asset>"
            "<default><default class='arm'><geom material='grey'/><joint range='-2 2'/>"
            "<position kp='100' dampratio='1'/></default></default>"),
      newer("<light pos='0 0 1'/><camera name='c' resolution='10 10'/>"),
      newer("gravcomp='1' childclass='arm'"), newer("actuatorfrcrange='-87 87'"),
      newer("<geom type='mesh' mesh='link'/>"), newer("material='grey' rgba='1 0 0 1'"),
      newer("<joint name='left_finger' type='slide' axis='0 1 0' range='0 .04'/>"),
      newer("<joint name='right_finger' type='slide' axis='0 -1 0' range='0 .04'/>"),
      plain ? "<actuator><motor joint='shoulder'/><motor joint='elbow'/></actuator>"
            : "<tendon><fixed name='grip'><joint joint='left_finger' coef='1'/></fixed></tendon>"
              "<equality><joint joint1='left_finger' joint2='right_finger'/></equality>"
              "<actuator><position joint='shoulder' inheritrange='1'/><general tendon='grip'/>"
              "</actuator><sensor><jointpos joint='elbow'/></sensor>"
              "<keyframe><key qpos='0 0 0 0'/></keyframe>");
}

class Import : public RobotFolder {
 protected:
  // with these bodies
  std::string body(const std::string& xml) const {
    return put("<mujoco><worldbody>" + xml + "</worldbody></mujoco>");
  }
};

constexpr const char* kFingers = ".*_finger";

TEST_F(Import, OfNewerMjcfIsTheSameArm) {
  const TreeModel<2> one = tree_model<2>(load_mjcf(put(arm(false)), {kFingers})),
                     two = tree_model<2>(load_mjcf(put(arm(true))));
  const Vec<2> q(0.4, -1.1), qd(0.7, -0.3);
  EXPECT_LT((one.inertia(q) - two.inertia(q)).norm(), 1e-14);
  EXPECT_LT((one.bias(q, qd) - two.bias(q, qd)).norm(), 1e-13);
  EXPECT_GT(two.bias(q, qd).norm(), 1);
  EXPECT_EQ(one.friction(qd), two.friction(qd));
}

TEST_F(Import, SaysWhatItLeavesOut) {
  const ImportedText text = import_mjcf(put(arm(false)), {kFingers});
  for (const char* what : {"actuator", "sensor", "keyframe", "geom (mesh)", "mesh", "body.gravcomp",
                           "joint.actuatorfrcrange", "option.integrator",
                           "equality of what is locked", "tendon of locked joints"}) {
    EXPECT_EQ(text.dropped.count(what), 1u) << what;
  }
  EXPECT_EQ(text.changed.at("joint locked"), 2);
  // its own output needs no import, and an import of it changes nothing
  const std::string again = put(text.xml, "again.xml");
  EXPECT_EQ(tree_of(load_mjcf(again)).joints.size(), 2u);
  EXPECT_EQ(import_mjcf(again).changed.size(), 0u);
}

TEST_F(Import, FlattensWhatIsIncluded) {
  put("<mujoco><body name='link'><include file='joint.xml'/><geom size='.1'/></body></mujoco>",
      "link.xml");
  put("<mujoco><joint name='a' axis='0 1 0'/></mujoco>", "joint.xml");
  const std::string path = body("<include file='link.xml'/>");
  EXPECT_EQ(tree_of(load_mjcf(path)).joints.size(), 1u);
  const std::string xml = import_mjcf(path).xml;
  EXPECT_EQ(xml.find("include"), std::string::npos) << xml;
  EXPECT_NE(xml.find("joint name=\"a\""), std::string::npos) << xml;
}

TEST_F(Import, OfADrivenArmCanBeSimulated) {
  Plant plant(load_mjcf(put(arm(false)), {kFingers}));
  EXPECT_EQ(plant.dof(), 2);
}

TEST_F(Import, FrictionThatIsTooQuickForSamplesIsNamedWithItsRemedy) {
  const auto rod = [&](const std::string& friction) {
    return load_mjcf(
        body("<body><joint name='a' axis='0 1 0' " + friction +
             "/><geom type='capsule' size='.01' fromto='0 0 0 0 0 .05' mass='.1'/></body>"));
  };
  EXPECT_EQ(too_stiff(rod("damping='.02'")), "");
  const std::string why = too_stiff(rod("damping='2'"));
  const std::size_t at = why.find("armature=\"");
  ASSERT_NE(at, why.npos) << why;
  EXPECT_NE(why.find("joint 1 'a'"), why.npos) << why;
  const std::string enough = why.substr(at + 10, why.find('"', at + 10) - at - 10);
  EXPECT_EQ(too_stiff(rod("damping='2' armature='" + enough + "'")), "") << "what it advises helps";
  // 500 1/s of dry friction, too: smooth over so much that its slope is that
  const TreeJoint dry = tree_of(rod("frictionloss='1'")).joints[0];
  const double inertia = tree_model<1>(rod("")).inertia(Vec<1>(0.3))(0, 0);
  EXPECT_NEAR(dry.dry / dry.v_s, 500 * inertia, 1e-9 * inertia);
  EXPECT_EQ(tree_of(rod("frictionloss='1e-4'")).joints[0].v_s, 0.01);
}

TEST_F(Import, WhatCannotBeSaysWhyAndWhatToDo) {
  const auto error = [&](const std::string& path, const std::string& lock = "") {
    return error_of([&] { tree_of(load_mjcf(path, {lock})); });
  };
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  };
  const std::string path = put(arm(false));
  has(error(path, "finger"), "there are: shoulder, elbow, left_finger, right_finger");
  has(error(path, "left_finger"), "ties 'right_finger' to it: lock both");
  has(error(path, "("), "--lock '('");
  has(error(body("<frame><body/></frame>")), "MuJoCo 2.2.2 does not know <frame>");
  has(error(body("<include file='none.xml'/>")), "none.xml");
  has(error(body("<include file='robot.xml'/>")), "robot.xml");
  has(error(put("<robot/>")), "robot.xml");
  has(error(body("<body><joint name='a' dampening='1'/></body>")), "'dampening'");
  has(error(body("<body><joint name='a' gravcomp='1'/></body>")), "'gravcomp'");
  has(error(put("")), "robot.xml");
  has(error(body("<body><joint name='a'/><sight name='s'/></body>")), "knows no <sight>");
  has(error(body("<body><joint name='a'/><geom size='.1' mass='nan'/></body>")),
      "mass of <geom> is nan");
  has(error(body("<body><joint name='a'/><geom size='.1' mass='2,9'/></body>")),
      "mass of <geom> is 2,9: write decimals behind a point");
  has(error(body("<body><joint name='a' stiffness='3'/><geom size='.1'/></body>")),
      "joint 1 'a' has a spring of 3 N m/rad");
  has(error(body("<body><freejoint name='loose'/><geom size='.1'/></body>")),
      "joint 1 'loose' is free");
  has(error(body("<body><geom size='.1'/></body>")), "no joint is left that moves");
  has(error(fs::temp_directory_path().string()), "it is a folder");
  // the mass is the mesh's
  has(error(put("<mujoco><asset><mesh name='m' file='gone.stl'/></asset><worldbody><body><joint "
                "name='j'/><geom type='mesh' mesh='m'/></body></worldbody></mujoco>")),
      "gone.stl");
  has(error(
          put("<mujoco><compiler assetdir='parts'/><asset><mesh name='m' file='gone.stl'/></asset>"
              "<worldbody><body><joint name='j'/><geom type='mesh' mesh='m'/></body></worldbody>"
              "</mujoco>")),
      "parts/gone.stl");
}

TEST_F(Import, ManyErrorsAreInOneMessage) {
  const auto error = [&](const std::string& xml) {
    return error_of([&] { tree_of(load_mjcf(put(xml))); });
  };
  const auto has = [](const std::string& text, const std::vector<const char*>& parts) {
    for (const char* part : parts)
      EXPECT_NE(text.find(part), std::string::npos) << part << ": " << text;
  };
  has(error("<mujoco><include file='a.xml'/><include file='b.xml'/></mujoco>"),
      {"a.xml: no such file", "b.xml: no such file"});
  has(error("<mujoco><worldbody><frame/><replicate/></worldbody></mujoco>"),
      {"<frame> (line 1)", "<replicate> (line 1)"});
  has(error("<mujoco><worldbody><body><joint dampening='1' gravcomp='1'/><sight/></body>"
            "</worldbody></mujoco>"),
      {"'dampening'", "'gravcomp'", "<sight>"});
  has(error("<mujoco><option density='1'/><worldbody><body><joint name='a' stiffness='3'/><joint "
            "name='b' stiffness='4' type='slide'/><geom size='.1'/><body><joint name='c' "
            "type='ball'/><geom size='.1'/></body></body></worldbody></mujoco>"),
      {"'a' has a spring of 3 N m/rad", "'b' has a spring of 4 N/m", "'c' is a ball", "air or"});
  has(error("<mujoco><worldbody><body><joint name='a' damping='-1' armature='1e9'/><geom "
            "size='.1'/></body></worldbody></mujoco>"),
      {"damping is -1", "armature is 1e+09"});
}

TEST_F(Import, WhatFloatsBesideTheArmStandsAndABaseThatFloatsCanBeLocked) {
  const auto arm_with = [](const std::string& joint) {
    return "<body name='arm'>" + joint +
           "<geom size='.1'/><body><joint name='a' axis='1 0 0'/><geom size='.1' pos='0 0 .5'/>"
           "</body></body>";
  };
  const std::string object = "<body name='cup' pos='1 0 0'><freejoint/><geom size='.1'/></body>";
  const std::string path = body(arm_with("") + object);
  EXPECT_EQ(import_mjcf(path).dropped.at("body that floats beside the arm, and stands now"), 1);
  EXPECT_EQ(tree_of(load_mjcf(path)).dof(), 1);
  const std::string floats = body(arm_with("<freejoint/>"));
  EXPECT_NE(error_of([&] { tree_of(load_mjcf(floats)); }).find("joint 1 'arm' is free"),
            std::string::npos);
  EXPECT_EQ(tree_of(load_mjcf(floats, {"arm"})).dof(), 1);
}

// MuJoCo's own reading of what it reads
TEST_F(Import, TakesMassAndGravityAsTheFileHasThem) {
  const std::string path = put(
      "<mujoco><compiler inertiagrouprange='3 4'/><option><flag gravity='disable'/></option>"
      "<default><geom group='4'/></default><worldbody><body><joint name='a' axis='1 0 0'/><geom "
      "size='.1' pos='0 0 .5'/><geom size='.3' group='1'/><body><joint name='b' axis='1 0 0'/>"
      "<geom size='.1' pos='0 0 .5'/></body></body></worldbody></mujoco>");
  char why[1000];
  const Model own(mj_loadXML(path.c_str(), nullptr, why, sizeof why),
                  [](const mjModel* m) { mj_deleteModel(const_cast<mjModel*>(m)); });
  ASSERT_NE(own, nullptr) << why;
  const Vec<2> q(0.4, -1.1), qd(0.7, -0.3);
  const MjcfArm<2> oracle(own);
  const TreeModel<2> tree = tree_model<2>(load_mjcf(path));
  EXPECT_LT((tree.inertia(q) - oracle.inertia(q)).norm(), 1e-12);
  EXPECT_LT((tree.bias(q, qd) - oracle.bias(q, qd)).norm(), 1e-12);
  EXPECT_LT(tree.gravity(q).norm(), 1e-12);
}

TEST_F(Import, KnowsDefaultsOfTendonsAndDragsByNoMocapBody) {
  const std::string hand = body(
      "<body name='m' mocap='true'/><body name='arm'><joint name='a'/><geom size='.1'/></body>"
      "<geom type='hfield' hfield='ground'/>");
  std::ifstream in(hand);
  std::string text((std::istreambuf_iterator<char>(in)), {});
  text.insert(text.find("<worldbody>"),
              "<default><tendon width='.1' limited='true' range='0 1'/><equality solref='.01 1'/>"
              "</default><equality><weld body1='m' body2='arm'/></equality>");
  const std::string path = put(text);
  const auto left_out = import_mjcf(path).dropped;
  for (const char* what : {"equality that drags by a mocap body", "geom (hfield)", "tendon.width"})
    EXPECT_EQ(left_out.count(what), 1u) << what;
  EXPECT_EQ(tree_of(load_mjcf(path)).dof(), 1);
  text.insert(text.find("<tendon"), "<tendon damping='1'/>");
  text.insert(text.find("<worldbody>"), "<tendon><spatial/></tendon>");
  EXPECT_NE(error_of([&] { import_mjcf(put(text)); }).find("a <spatial> tendon"),
            std::string::npos);
}

TEST_F(Import, MendsInertiasThatNoBodyHasAsOfUrdf) {
  const auto of = [&](const char* inertia, bool balance, const char* compiler = "") {
    return import_mjcf(put(fmt::format("<mujoco><compiler {}/><worldbody><body name='b'><joint "
                                       "name='a'/><inertial pos='0 0 0' mass='2' {}/></body>"
                                       "</worldbody></mujoco>",
                                       compiler, inertia)),
                       {.balance = balance});
  };
  const char* const diagonal = "quat='0 1 0 0' diaginertia='.01 .02 .04'";
  const char* const full = "fullinertia='.01 .04 .02 0 0 0'";
  for (const char* inertia : {diagonal, full}) {
    EXPECT_NE(error_of([&] { of(inertia, false); }).find("'b' (line 1) 0.01, 0.02 and 0.04"),
              std::string::npos);
    const ImportedText mended = of(inertia, true);
    EXPECT_EQ(mended.changed.begin()->first, "inertia of 'b' by 9.1 %");
    EXPECT_EQ(tree_of(load_mjcf(put(mended.xml))).dof(), 1);
  }
  EXPECT_EQ(of("diaginertia='.01 .02 .03001'", false).changed.size(), 1u);
  EXPECT_EQ(of("diaginertia='.01 .02 .03'", false).changed.size(), 0u);
  // MuJoCo makes .07 / 3 of each
  EXPECT_EQ(of(diagonal, false, "balanceinertia='true'").changed.begin()->first,
            "inertia of 'b' by 42 %, by the file's balanceinertia");
}

TEST_F(Import, NamesThatATerminalWouldObeyAreRefused) {
  EXPECT_EQ(error_of([&] {
              import_mjcf(body("<body><joint name='a&#27;[31m'/><geom size='.1'/></body>"));
            }),
            "line 1: name of <joint> has a control character: a?[31m");
}

TEST_F(Import, AnExpressionOfJointsToLockEndsSoon) {
  const std::string name(60, 'a');
  const std::string path = body("<body><joint name='" + name + "b'/><geom size='.1'/></body>");
  EXPECT_NE(error_of([&] { import_mjcf(path, {.lock = "(a+)+"}); }).find("matches no joint"),
            std::string::npos);
  EXPECT_NE(error_of([&] { import_mjcf(path, {.lock = "(a*)*c|(a|aa)+"}); }).find("matches no"),
            std::string::npos);
  EXPECT_NE(error_of([&] { import_mjcf(path, {.lock = "(a)\\1"}); }).find("--lock '"),
            std::string::npos);
}

TEST_F(Import, NeedsNoMeshesOfWhatStandsStill) {
  const std::string path = put(
      "<mujoco><asset><mesh name='m' file='gone.stl'/></asset><worldbody><geom type='mesh' "
      "mesh='m'/>"
      "<body><geom type='mesh' mesh='m'/><body><joint name='j'/><geom size='.1' mass='2'/></body>"
      "</body></worldbody></mujoco>");
  EXPECT_EQ(import_mjcf(path).dropped.at("geom (mesh)"), 2);
  EXPECT_EQ(tree_of(load_mjcf(path)).joints.size(), 1u);
}

}  // namespace
}  // namespace tauext::test

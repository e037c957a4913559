// SPDX-License-Identifier: Apache-2.0
// Other people's MJCF (mjcf/import/), as MuJoCo then reads it.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>
#include <vector>

#include "mjcf/import/mjcf_text.h"
#include "mjcf/plant/mjcf_file.h"
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

class Import : public RobotFolder {};

// by MuJoCo alone
Model own_reading(const std::string& path) {
  char why[1000];
  const Model own(mj_loadXML(path.c_str(), nullptr, why, sizeof why),
                  [](const mjModel* m) { mj_deleteModel(const_cast<mjModel*>(m)); });
  EXPECT_NE(own, nullptr) << why;
  return own;
}

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

TEST_F(Import, RefusesDegreesInAFileOfRadians) {
  std::string text = arm(true);
  const std::string pos = "<body name='lower' pos='0 .01 .3'";
  text.insert(text.find(pos) + pos.size(), " euler='0 90 0'");
  EXPECT_NE(error_of([&] { import_mjcf(put(text)); }).find("euler of <body> is '0 90 0', more"),
            std::string::npos);
  text.replace(text.find("'radian'"), 8, "'degree'");
  EXPECT_NO_THROW(import_mjcf(put(text)));
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
  has(error(body("<replicate><body/></replicate>")), "MuJoCo 2.2.2 does not know <replicate>");
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
  has(error("<mujoco><worldbody><composite/><replicate/></worldbody></mujoco>"),
      {"<composite> (line 1)", "<replicate> (line 1)"});
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
  // as bases have that are driven by nothing but the simulation
  has(error(
          "<mujoco><worldbody><body><joint name='a' damping='1e11'/><geom size='.1'/><body><joint "
          "name='b'/><geom size='.1'/></body></body></worldbody></mujoco>"),
      {"damping is 1e+11", "; to mend it: --lock 'a'"});
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

TEST_F(Import, AFreeJointBesideTheArmCanBeLockedByItsNameToo) {
  const std::string path = body(
      "<body><joint name='a' axis='1 0 0'/><geom size='.1'/></body><body name='cup'><freejoint "
      "name='cup_free'/><geom size='.1'/></body>");
  for (const char* lock : {"", "cup_free", "cup.*"}) {
    const ImportedText text = import_mjcf(path, {.lock = lock});
    EXPECT_EQ(text.dropped.count("body that floats beside the arm, and stands now"), *lock == '\0')
        << lock;
    EXPECT_EQ(tree_of(load_mjcf(put(text.xml, "out.xml"))).dof(), 1) << lock;
  }
}

// the flags that a message names, as ImportOptions
ImportOptions remedy_in(const std::string& error, const std::string& path) {
  ImportOptions options;
  const std::string lock = "--lock '";
  std::size_t at = error.rfind("to mend it: ");
  if (at == error.npos) return options;
  std::string command = error.substr(at + 12);
  if (const std::string head = "tauext-import " + path + " "; command.starts_with(head)) {
    options.balance = command.find("--balance --out arm.xml") != command.npos;
    command.erase(0, head.size());
  }
  if (command.starts_with(lock))
    options.lock = command.substr(lock.size(), command.find('\'', lock.size()) - lock.size());
  return options;
}

TEST_F(Import, OneMessageHasAllThatIsWrongAndTheFlagsThatMendIt) {
  const auto robot = [&](const char* base, const char* spring, const char* inertia) {
    return put(fmt::format(
        "<mujoco><worldbody><body name='arm'>{}<geom size='.1'/><body><joint name='a' axis='1 0 "
        "0'/>"
        "<geom size='.1' pos='0 0 .5'/><body name='hand'><joint name='grip (1)' {}/><inertial "
        "pos='0 0 0' mass='1' diaginertia='{}'/></body></body></body></worldbody></mujoco>",
        base, spring, inertia));
  };
  const auto why = [](const std::string& path, const ImportOptions& options = {}) {
    return error_of([&] {
      const Model model = load_mjcf(path, options);
      try {
        tree_of(model);
      } catch (const std::invalid_argument& e) {
        throw std::invalid_argument(why_no_arm(e.what(), path, {}, options));
      }
    });
  };
  const std::string wrong = robot("<freejoint/>", "stiffness='3'", ".01 .02 .04");
  const std::string error = why(wrong);
  for (const char* part : {"'hand' (line 1) 0.01, 0.02 and 0.04", "joint 1 'arm' is free",
                           "has a spring of 3 N m/rad"})
    EXPECT_NE(error.find(part), error.npos) << part << ": " << error;
  const ImportOptions flags = remedy_in(error, wrong);
  EXPECT_EQ(flags.lock, "arm|grip \\(1\\)");
  EXPECT_TRUE(flags.balance);
  EXPECT_EQ(why(wrong, flags), "no error");
  EXPECT_EQ(tree_of(load_mjcf(wrong, flags)).dof(), 1);
  // no more than is needed
  const std::string floats = robot("<freejoint/>", "", ".01 .02 .03");
  EXPECT_TRUE(why(floats).ends_with("; to mend it: --lock 'arm'")) << why(floats);
  const std::string springs = robot("", "stiffness='3'", ".01 .02 .03");
  EXPECT_TRUE(why(springs).ends_with("; to mend it: --lock 'grip \\(1\\)'")) << why(springs);
  // what was locked stays so
  const std::string both = robot("<freejoint/>", "stiffness='3'", ".01 .02 .03");
  EXPECT_TRUE(why(both, {.lock = "arm"}).ends_with("to mend it: --lock 'arm|grip \\(1\\)'"));
}

TEST_F(Import, NamesNoFlagThatWouldLeaveNoArm) {
  const std::string path = body(
      "<body><freejoint/><geom size='.1'/><body><joint name='a' stiffness='1'/><geom size='.1'/>"
      "</body></body>");
  EXPECT_EQ(why_no_arm("it has a spring", path),
            "it has a spring; joint 1 'base' is free: an arm of "
            "hinges and slides on a fixed base is wanted; --lock REGEX fixes such joints; joint 2 "
            "'a' has a spring of 1 N m/rad, which no estimator here knows: take the stiffness out, "
            "or --lock REGEX fixes such joints");
}

// a body with an arm of seven joints, one of two, and a head
TEST_F(Import, WhereThereAreTooManyJointsTheLongestRowIsOffered) {
  const auto row = [](const std::string& name, int n) {
    std::string open, close;
    for (int i = 1; i <= n; ++i) {
      open +=
          fmt::format("<body><joint name='{}{}' axis='1 {} 0'/><geom size='.1'/>", name, i, i % 2);
      close += "</body>";
    }
    return open + close;
  };
  const std::string path = body("<body name='torso'><freejoint/><geom size='.3'/>" +
                                row("left", 2) + row("right", 7) + row("head", 1) + "</body>");
  const std::string error = why_no_arm("10 joints", path, {}, {.lock = "torso"});
  const std::string lock = "(?!(right1|right2|right3|right4|right5|right6|right7)$).*";
  const std::string others = "torso|left1|left2|head1";
  EXPECT_EQ(error,
            "10 joints; estimators take arms of 8 joints at most, and here are 10: --lock '" +
                others + "' keeps the 7 from 'right1' to 'right7'");
  EXPECT_EQ(tree_of(load_mjcf(path, {others})).joint_names().front(), "right1");
  EXPECT_EQ(tree_of(load_mjcf(path, {lock})).dof(), 7) << "the other way to say it";
}

// by MuJoCo's own reading of the bodies that the frames stand for
TEST_F(Import, WhatStandsInAFrameIsCarriedByTheBodyAroundIt) {
  const std::string link = "<geom type='capsule' size='.05' fromto='0 0 0 .2 .1 .4'/>";
  const auto robot = [&](const std::string& open, const std::string& close, const char* own) {
    return body("<body pos='0 0 1'><joint name='a' axis='0 1 0'/>" + std::string(own) + open +
                link + close + "<body pos='0 .1 .4'><joint name='b' axis='1 0 0'/>" + own + open +
                open + link + "<site name='end_effector' pos='0 0 .3'/>" + close + close +
                "</body></body>");
  };
  const char* const shape = "<geom size='.05'/>";
  const std::string frame = "pos='.1 -.2 .3' euler='20 30 -40'";
  const Vec<2> q(0.4, -1.1), qd(0.7, -0.3);
  const std::string path = robot("<frame name='b' " + frame + ">", "</frame>", shape);
  const TreeModel<2> tree = tree_model<2>(load_mjcf(path));
  const ArmTree arm = tree_of(load_mjcf(path));
  const std::string bodies = robot("<body " + frame + ">", "</body>", shape);
  const MjcfArm<2> oracle(own_reading(bodies));
  EXPECT_LT((tree.inertia(q) - oracle.inertia(q)).norm(), 1e-8);
  EXPECT_LT((tree.bias(q, qd) - oracle.bias(q, qd)).norm(), 1e-8);
  EXPECT_EQ(arm.end_effector, tree_of(load_mjcf(bodies)).end_effector);
  // nothing but a frame will do, and what has an <inertial> has no other mass
  const ArmTree bare = tree_of(load_mjcf(robot("<frame " + frame + ">", "</frame>", "")));
  const double ball = 4. / 3 * std::numbers::pi * .05 * .05 * .05 * 1000;
  EXPECT_NEAR(bare.joints[0].mass, arm.joints[0].mass - ball, 1e-9);
  const char* const inertial = "<inertial pos='0 0 .1' mass='2' diaginertia='.1 .1 .1'/>";
  const ArmTree one = tree_of(load_mjcf(robot("<frame " + frame + ">", "</frame>", inertial)));
  EXPECT_EQ(one.joints[0].mass, 2);
  EXPECT_EQ(one.joints[1].mass, 2);
  EXPECT_NE(error_of([&] {
              load_mjcf(body("<body><frame><joint/></frame></body>"));
            }).find("a <joint> in a <frame>"),
            std::string::npos);
}

// an arm in a file of its own, whose bodies are in another one
class Attached : public Import {
 protected:
  static std::string bodies(const char* p) {
    return fmt::format(
        "<body name='{0}upper' childclass='{0}link' pos='0 0 .2' euler='.1 .2 .3'><joint "
        "name='{0}a' axis='0 1 0'/><geom type='capsule' size='.05' fromto='0 0 0 .2 .1 .4'/>"
        "<body name='{0}lower' pos='0 .1 .4'><joint name='{0}b' axis='1 0 0'/><joint name='{0}c' "
        "axis='0 0 1' class='{0}link'/><geom size='.1' pos='.1 0 .3'/></body></body>",
        p);
  }
  static std::string classes(const char* p) {
    return fmt::format(
        "<default><default class='{}link'><joint damping='.3'/><geom density='500'/></default>"
        "</default>",
        p);
  }
  void put_part(const std::string& equality) const {
    std::filesystem::create_directories(folder_ / "parts");
    put("<mujoco>" + kCompiler + classes("") +
            "<worldbody><include file='bodies.xml'/><geom size='.1'/></worldbody>" + equality +
            "</mujoco>",
        "parts/arm.xml");
    put("<mujoco>" + bodies("") + "</mujoco>", "parts/bodies.xml");
  }
  // with another class of that name
  std::string robot(const std::string& attach) const {
    return put("<mujoco>" + kCompiler +
               "<default><default class='link'><joint damping='9'/></default></default><asset>"
               "<model name='arm' file='parts/arm.xml'/></asset><worldbody><body name='stand' "
               "pos='.3 0 1' euler='0 .4 0'>" +
               attach + "</body></worldbody></mujoco>");
  }
  const std::string kCompiler = "<compiler angle='radian'/>";
};

// beside MuJoCo's own reading of the same arm in one file
TEST_F(Attached, ModelIsAsIfItStoodThere) {
  put_part("");
  const MjcfArm<3> oracle(own_reading(put("<mujoco>" + kCompiler + classes("r_") +
                                              "<worldbody><body pos='.3 0 1' euler='0 .4 0'>" +
                                              bodies("r_") + "</body></worldbody></mujoco>",
                                          "written_out.xml")));
  const Vec<3> q(0.4, -1.1, 0.3), qd(0.7, -0.3, 0.2);
  for (const char* part : {"", "body='upper'"}) {
    const Model model = load_mjcf(robot(fmt::format("<attach model='arm' {} prefix='r_'/>", part)));
    EXPECT_EQ(tree_of(model).names, (std::vector<std::string>{"r_a", "r_b", "r_c"}));
    const TreeModel<3> same = tree_model<3>(model);
    EXPECT_LT((same.inertia(q) - oracle.inertia(q)).norm(), 1e-12);
    EXPECT_LT((same.bias(q, qd) - oracle.bias(q, qd)).norm(), 1e-12);
    EXPECT_LT((same.friction(qd) - oracle.friction(qd)).norm(), 1e-15);
  }
  // what ties its joints comes along
  put_part("<equality><joint joint1='c' joint2='b'/></equality>");
  EXPECT_EQ(tree_of(load_mjcf(robot("<attach model='arm' prefix='r_'/>"))).dof(), 2);
}

TEST_F(Attached, ModelThatCannotBeSaysWhy) {
  put_part("");
  const auto why = [&](const std::string& attach) {
    return error_of([&] { import_mjcf(robot(attach)); });
  };
  EXPECT_NE(why("<attach model='arm' body='x' prefix='r_'/>").find("has no body 'x'"),
            std::string::npos);
  EXPECT_NE(why("<attach body='stand' prefix='r_'/>").find("<attach> is known with a model"),
            std::string::npos);
  put("<mujoco><worldbody/></mujoco>", "parts/arm.xml");
  EXPECT_NE(why("<attach model='arm' prefix='r_'/>")
                .find("has angle=\"degree\", and this file has \"radian\""),
            std::string::npos);
}

TEST_F(Import, AFileMayBeIncludedByTwoButNotByItself) {
  put("<mujoco><geom size='.1' mass='2'/></mujoco>", "shape.xml");
  const std::string path = body(
      "<body><include file='shape.xml'/><joint name='a'/><body><include file='shape.xml'/><joint "
      "name='b'/></body></body>");
  const ArmTree arm = tree_of(load_mjcf(path));
  EXPECT_EQ(arm.joints[0].mass, 2);
  EXPECT_EQ(arm.joints[1].mass, 2);
  put("<mujoco><body><include file='ring.xml'/></body></mujoco>", "ring.xml");
  EXPECT_NE(error_of([&] {
              import_mjcf(body("<include file='ring.xml'/>"));
            }).find("'ring.xml' includes itself"),
            std::string::npos);
  // each of twenty files includes the next one twice
  for (int i = 0; i < 20; ++i)
    put(fmt::format("<mujoco><include file='f{0}.xml'/><include file='f{0}.xml'/></mujoco>", i + 1),
        fmt::format("f{}.xml", i));
  put("<mujoco/>", "f20.xml");
  EXPECT_NE(error_of([&] {
              import_mjcf(body("<include file='f0.xml'/>"));
            }).find("more than 1000 files are included"),
            std::string::npos);
}

TEST_F(Import, FindsWhatAnIncludedFileIncludesBesideIt) {
  std::filesystem::create_directories(folder_ / "parts");
  put("<mujoco><body><include file='joint.xml'/><geom size='.1'/></body></mujoco>",
      "parts/link.xml");
  put("<mujoco><joint name='a' axis='0 1 0'/></mujoco>", "parts/joint.xml");
  const std::string path = body("<include file='parts/link.xml'/>");
  EXPECT_EQ(tree_of(load_mjcf(path)).names, std::vector<std::string>{"a"});
  put("<mujoco><joint name='b' axis='0 1 0'/></mujoco>", "joint.xml");
  EXPECT_EQ(tree_of(load_mjcf(path)).names, std::vector<std::string>{"b"}) << "the main folder's";
}

TEST_F(Import, TakesEveryMassThatShapesHave) {
  const auto same = [&](const std::string& compiler, const std::string& shell) {
    const std::string path = put(
        "<mujoco><compiler " + compiler +
        "/><asset><mesh name='m' vertex='0 0 0 .3 0 0 0 .2 0 0 0 "
        ".1'/></asset><worldbody><geom size='.4'/><body><geom type='mesh' mesh='m'/><body><joint "
        "name='a' axis='1 0 0'/><geom type='mesh' mesh='m' pos='0 0 .5' " +
        shell + "/></body></body></worldbody></mujoco>");
    const Vec<1> q(0.4);
    const TreeModel<1> tree = tree_model<1>(load_mjcf(path));
    const MjcfArm<1> oracle(own_reading(path));
    EXPECT_NEAR(tree.inertia(q)(0, 0), oracle.inertia(q)(0, 0), 1e-10) << compiler << shell;
    EXPECT_NEAR(tree.gravity(q)[0], oracle.gravity(q)[0], 1e-9) << compiler << shell;
    return tree.inertia(q)(0, 0);
  };
  const double solid = same("", "");
  if (mjVERSION_HEADER < 300) {
    EXPECT_NE(same("", "shellinertia='true'"), solid);
  }
  EXPECT_NE(same("settotalmass='7'", ""), solid);
}

TEST_F(Import, AMeshWhoseMassIsFoundInANewerWayIsRefusedWhereItCounts) {
  const auto why = [&](const char* inertia, const char* inertial) {
    return error_of([&] {
      import_mjcf(
          put(fmt::format("<mujoco><asset><mesh name='m' file='m.stl' {}/></asset>"
                          "<worldbody><body><joint/>{}<geom type='mesh' mesh='m'/></body>"
                          "</worldbody></mujoco>",
                          inertia, inertial)));
    });
  };
  EXPECT_NE(why("inertia='exact'", "").find("the mesh 'm' has inertia=\"exact\""),
            std::string::npos);
  EXPECT_EQ(why("inertia='legacy'", ""), "no error");
  EXPECT_EQ(why("inertia='exact'", "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>"),
            "no error");
}

TEST_F(Import, AFlagThatSwitchesFrictionOffIsNotOverlooked) {
  const auto why = [&](const char* flag, const char* friction) {
    return error_of([&] {
      tree_of(load_mjcf(put(fmt::format(
          "<mujoco><option><flag {}/></option><worldbody><body><joint name='a' {}/><geom size='.1' "
          "mass='1'/></body></worldbody><actuator><motor joint='a'/></actuator></mujoco>",
          flag, friction))));
    });
  };
  if (mjVERSION_HEADER < 336) {
    EXPECT_NE(why("passive='disable'", "damping='1'").find("switches off damping"),
              std::string::npos);
  }
  EXPECT_NE(why("frictionloss='disable'", "frictionloss='1'").find("switches off frictionloss"),
            std::string::npos);
  EXPECT_EQ(why("frictionloss='disable'", "damping='1'"), "no error");
}

TEST_F(Import, ASpringOfAJointThatAnEqualityHoldsDoesNothing) {
  const auto arm_with = [&](const char* equality) {
    return put(fmt::format(
        "<mujoco><worldbody><body><joint name='a' axis='1 0 0'/><geom size='.1' pos='0 0 .5'/>"
        "<body><joint name='b' stiffness='3' axis='1 0 0'/><geom size='.1' pos='0 0 .5'/></body>"
        "</body></worldbody><equality><joint joint1='b' {}/></equality></mujoco>",
        equality));
  };
  EXPECT_EQ(tree_of(load_mjcf(arm_with(""))).dof(), 1);
  EXPECT_NE(error_of([&] { tree_of(load_mjcf(arm_with("joint2='a'"))); }).find("'b' has a spring"),
            std::string::npos);
}

// MuJoCo's own reading of what it reads
TEST_F(Import, TakesMassAndGravityAsTheFileHasThem) {
  const std::string path = put(
      "<mujoco><compiler inertiagrouprange='3 4'/><option><flag gravity='disable'/></option>"
      "<default><geom group='4'/></default><worldbody><body><joint name='a' axis='1 0 0'/><geom "
      "size='.1' pos='0 0 .5'/><geom size='.3' group='1'/><body><joint name='b' axis='1 0 0'/>"
      "<geom size='.1' pos='0 0 .5'/></body></body></worldbody></mujoco>");
  const Vec<2> q(0.4, -1.1), qd(0.7, -0.3);
  const MjcfArm<2> oracle(own_reading(path));
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

TEST_F(Import, AMeshMayBeThatOfAClass) {
  const std::string path = put(
      "<mujoco><default><default class='link'><geom type='mesh' mesh='m.0'/></default></default>"
      "<asset><mesh name='m.0' vertex='0 0 0 .3 0 0 0 .2 0 0 0 "
      ".1'/></asset><worldbody><body><joint "
      "name='a'/><geom class='link'/></body></worldbody></mujoco>");
  const Vec<1> q(0.4);
  const MjcfArm<1> oracle(own_reading(path));
  EXPECT_NEAR(tree_model<1>(load_mjcf(path)).gravity(q)[0], oracle.gravity(q)[0], 1e-9);
  EXPECT_EQ(import_mjcf(path).dropped.count("mesh"), 0u);
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

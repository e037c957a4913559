// SPDX-License-Identifier: Apache-2.0
// What the actuators of an MJCF file say of its joints (mjcf/import/drives.h).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "mjcf/import/mjcf_text.h"
#include "mjcf/plant/mjcf_file.h"
#include "mjcf/plant/test/robot_folder.h"
#include "mjcf/plant/tree.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

class OfActuators : public RobotFolder {};

// MuJoCo 4 has armature and damping in actuators, times the gear squared: .1 + 2^2 .3, .5 + 2^2 2
TEST_F(OfActuators, ArmatureAndDampingOfAnActuatorAreThoseOfItsJoint) {
  const auto of = [&](const std::string& classes, const std::string& actuators) {
    return put("<mujoco><default><joint armature='.1'/>" + classes +
               "</default><worldbody><body><joint name='a' axis='0 1 0' damping='.5'/><geom "
               "size='.1' pos='0 0 .5'/><body pos='0 0 1'><joint name='b' axis='0 1 0'/><geom "
               "size='.1' pos='0 0 .5'/></body></body></worldbody><tendon><fixed name='t'><joint "
               "joint='b' coef='2'/></fixed></tendon><actuator>" +
               actuators + "</actuator></mujoco>");
  };
  const std::string own = "armature='.3' damping='2'";
  for (const std::string& path :
       {of("", "<motor joint='a' gear='2' " + own + "/>"),
        of("", "<motor jointinparent='a' gear='-2' " + own + "/>"),
        of("<motor gear='2' " + own + "/>", "<position joint='a' kp='9'/>"),
        of("<default class='big'><general gear='2' " + own + "/></default>",
           "<general joint='a' class='big'/>"),
        of("",
           "<motor joint='a' gear='2' armature='.1' damping='2'/><motor joint='a' gear='2' "
           "armature='.2'/>")}) {
    const ArmTree arm = tree_of(load_mjcf(path));
    EXPECT_NEAR(arm.joints[0].armature, 1.3, 1e-15);
    EXPECT_NEAR(arm.joints[0].viscous, 8.5, 1e-15);
    EXPECT_EQ(arm.joints[1].armature, .1);
    EXPECT_EQ(arm.joints[1].viscous, 0);
  }
  const auto changed = import_mjcf(of("", "<motor joint='a' gear='2' " + own + "/>")).changed;
  EXPECT_EQ(changed.count("armature of 'a' by 1.2, its actuator's"), 1u);
  EXPECT_EQ(changed.count("damping of 'a' by 8, its actuator's"), 1u);
  EXPECT_TRUE(import_mjcf(of("", "<motor joint='a' gear='2'/>")).changed.empty());
  // what no joint can have is named, all at once, and --lock mends it where joints have it
  const std::string strange =
      of("",
         "<motor name='m' tendon='t' armature='.3'/><dcmotor joint='b' lugre='1 2 3 4 5'/>"
         "<dcmotor joint='b' cogging='1 2 3'/><dcmotor joint='b' input='none'/><motor joint='b' "
         "damping='1 0 2'/><motor joint='c' damping='1'/>");
  const std::string error = error_of([&] { import_mjcf(strange); });
  for (const char* part :
       {"<motor> 'm' on the tendon 't' has armature", "has friction (lugre)", "has cogging",
        "has a force that nobody asks for", "has damping of higher powers",
        "<motor> has damping, and acts on no joint of the file ('c')"})
    EXPECT_NE(error.find(part), error.npos) << part << ": " << error;
  const std::string locked = of("", "<motor tendon='t' armature='.3'/>");
  EXPECT_EQ(tree_of(load_mjcf(locked, {"b"})).dof(), 1);
}

TEST_F(OfActuators, ForcesOfTendonsAndPluginsThatAreLeftOutElsewhereAreErrors) {
  const auto why = [&](const char* tendon, const char* plugin) {
    return error_of([&] {
      import_mjcf(put(fmt::format(
          "<mujoco><worldbody><body name='b'><joint name='a'/><geom size='.1'/>{}</body>"
          "</worldbody><tendon><spatial {}/></tendon></mujoco>",
          plugin, tendon)));
    });
  };
  EXPECT_EQ(why("width='.1'", ""), "no error");
  EXPECT_NE(why("armature='.1'", "").find("frictionloss or armature"), std::string::npos);
  EXPECT_NE(why("stiffness='0 3 0'", "").find("has stiffness"), std::string::npos) << "a power";
  EXPECT_NE(why("", "<plugin instance='c'/>").find("a <plugin> acts on the body 'b'"),
            std::string::npos);
}

}  // namespace
}  // namespace tauext::test

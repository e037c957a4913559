// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/model.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

TEST(LoadRobot, AnUnknownNameListsTheKnownOnes) {
  EXPECT_EQ(error_of([] { load_robot("wallmobot9"); }),
            "unknown robot 'wallmobot9'; known: testbed1, wallmobot3, wallmobot6");
  EXPECT_EQ(error_of([] { load_robot("wallmobot3", "garden"); }),
            "unknown scene 'garden'; known: load, obstacle, panel_obstacle");
}

TEST(LoadRobot, EveryKnownRobotLoads) {
  ASSERT_FALSE(robot_names().empty());
  for (const std::string& name : robot_names()) EXPECT_GT(load_robot(name)->nv, 0) << name;
  for (const std::string& name : robot_names()) {
    EXPECT_EQ(load_robot(name, "load")->nv, load_robot(name)->nv + 3) << name;
  }
}

TEST(ScaledBody, ScalesMassAndInertiaOfACopy) {
  const Model plain = load_robot("wallmobot3"), light = wallmobot3_with_panel(0);
  const int id = mj_name2id(plain.get(), mjOBJ_BODY, "link5");
  EXPECT_DOUBLE_EQ(plain->body_mass[id], 177);
  EXPECT_DOUBLE_EQ(light->body_mass[id], 27);
  EXPECT_DOUBLE_EQ(light->body_inertia[3 * id + 1], plain->body_inertia[3 * id + 1] * 27 / 177);
}

TEST(ScaledBody, RefusesWhatIsNoBodyOrNoMass) {
  const Model m = load_robot("wallmobot3");
  EXPECT_EQ(error_of([&] { with_scaled_body(m, "head", 2); }), "the robot has no body 'head'");
  EXPECT_EQ(error_of([&] { with_scaled_body(m, "link5", -1); }),
            "body 'link5': a mass factor must be positive, not -1");
}

TEST(Errors, OfMuJoCoAreExceptions) {
  load_robot("wallmobot3");  // installs the handler
  EXPECT_EQ(error_of([] { mju_error("no such thing"); }), "MuJoCo: no such thing");
}

}  // namespace
}  // namespace tauext::test

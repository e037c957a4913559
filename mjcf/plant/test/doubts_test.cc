// SPDX-License-Identifier: Apache-2.0
// Numbers of robots' files that stand for some (mjcf/plant/remedy/doubts.h).
#include "mjcf/plant/remedy/doubts.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "mjcf/plant/mjcf_file.h"
#include "mjcf/plant/test/robot_folder.h"

namespace tauext::test {
namespace {

class Doubts : public RobotFolder {};

TEST_F(Doubts, NameInertiasLargerThanTheArmMassesThatNoArmHasAndLimitsInOtherUnits) {
  const auto doubts = [&](const char* mass, const char* inertia) {
    const std::string link = "<inertial pos='0 0 .1' mass='1' diaginertia='.01 .01 .01'/>";
    return doubts_about(*load_mjcf(body(fmt::format(
        "<body><joint axis='0 1 0'/>{0}<body pos='0 0 .2'><joint axis='0 1 0'/>{0}<body "
        "name='hand' pos='0 0 .2'><joint axis='0 0 1'/><inertial pos='0 0 .1' mass='{1}' "
        "diaginertia='{2} {2} {2}'/></body></body></body>",
        link, mass, inertia))));
  };
  EXPECT_EQ(doubts(".5", ".002"), "");
  EXPECT_EQ(doubts(".5", ".12"), "") << "0.49 m of 0.5";
  // a ring of 0.1 kg and 1 kg m^2 has a diameter of 2 sqrt(10) m
  EXPECT_NE(doubts(".1", "1").find(
                "the arm reaches 0.5 m: 'hand' of 0.1 kg has the inertia of something 6.3 m wide"),
            std::string::npos)
      << doubts(".1", "1");
  // wheels on a base are no arm
  const std::string wheel =
      "<body><joint axis='0 1 0'/><inertial pos='0 0 0' mass='3' diaginertia='1 1 1'/></body>";
  EXPECT_EQ(doubts_about(*load_mjcf(body(wheel + wheel + wheel))), "");
  // placeholders, and another unit; these limits are in degrees
  const auto of_three = [&](double length, double center, double limit) {
    return doubts_about(*load_mjcf(body(fmt::format(
        "<body><joint axis='0 1 0'/>{0}<body pos='0 0 {1}'><joint axis='0 1 0'/>{0}<body "
        "pos='0 0 {1}'><joint name='wrist' axis='0 0 1' limited='true' range='-{2} {2}'/><inertial "
        "pos='0 0 {3}' "
        "mass='1' diaginertia='.01 .01 .01'/></body></body></body>",
        "<inertial pos='0 0 .1' mass='1' diaginertia='.01 .01 .01'/>", length, limit, center))));
  };
  EXPECT_EQ(of_three(.2, .1, 3), "");
  EXPECT_NE(of_three(200, .1, 3).find("it reaches more than 20 m"), std::string::npos);
  EXPECT_NE(of_three(.2, 5, 3).find("is 5 m from its joint"), std::string::npos);
  EXPECT_NE(of_three(.2, .1, 9740.3).find("joint 'wrist' has limits of -170 and 170 rad"),
            std::string::npos);
  const auto of_slide = [&](double upper) {
    return doubts_about(*load_mjcf(body(fmt::format(
        "<body><joint axis='0 1 0'/>{0}<body pos='0 0 .2'><joint axis='0 1 0'/>{0}<body pos='0 0 "
        ".2'><joint name='lift' type='slide' axis='0 0 1' limited='true' range='0 {1}'/>{0}"
        "</body></body></body>",
        "<inertial pos='0 0 .1' mass='1' diaginertia='.01 .01 .01'/>", upper))));
  };
  EXPECT_EQ(of_slide(9), "");
  EXPECT_NE(of_slide(400).find("joint 'lift' has limits of 0 and 400 m, which may be mm: give m"),
            std::string::npos);
  EXPECT_EQ(of_slide(1e9), "") << "no limit is meant";
  // 2000 / 8 kg are 250
  EXPECT_EQ(doubts("240", "9"), "");
  EXPECT_NE(doubts("260", "9").find("it weighs 262 kg"), std::string::npos);
}

}  // namespace
}  // namespace tauext::test

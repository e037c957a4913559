// SPDX-License-Identifier: Apache-2.0
// What every detector of the roster must do, whoever wrote it; and that no robot is forgotten.
#include <gtest/gtest.h>

#include "bench/kit/conformance.h"
#include "bench/roster/roster.h"

namespace tauext::test {
namespace {

TEST(EveryRobot, IsHeldToTheseTests) {
  int robots = 0;
  for_each_robot([&](const char*, const auto&) { ++robots; });
  EXPECT_EQ(robots, 2) << "write conformance_<robot>_test.cc for the new one";
}

TEST(EveryDetector, Conforms) {
  int count = 0;
  const auto check = [&](auto make) {
    conformance::check_detector(make);
    ++count;
  };
  for_each_detector<3>(check);
  for_each_detector<1>(check);
  EXPECT_EQ(count, 20);
}

}  // namespace
}  // namespace tauext::test

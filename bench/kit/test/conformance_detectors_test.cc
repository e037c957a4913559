// SPDX-License-Identifier: Apache-2.0
// What every detector of the roster must do, whoever wrote it; and that no robot is forgotten.
#include <gtest/gtest.h>

#include "bench/kit/conformance.h"
#include "bench/roster/detector_list.h"
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
  for_each_detector([&]<class D>(std::type_identity<D>) {
    for (const int joints : {1, 3, 8})
      conformance::check_detector([=] { return D(joints); }, joints);
    ++count;
  });
  EXPECT_EQ(count, 10);
}

}  // namespace
}  // namespace tauext::test

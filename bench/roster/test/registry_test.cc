// SPDX-License-Identifier: Apache-2.0
// A program of its own: what is registered has to be so before the robots are first asked for.
#include "bench/registry.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "bench/program/program.h"
#include "bench/roster/baselines.h"
#include "bench/roster/robots.h"
#include "estimators/detectors/threshold.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

using Mo1 = MomentumObserver<Testbed1>;

struct Own : Mo1 {
  static constexpr const char* kName = "own";
  using Mo1::Mo1;
};

struct OwnDetector : Threshold {
  static constexpr const char* kName = "own_detector";
  using Threshold::Threshold;
};

// each test registers for the testbed, of which it then makes one
class Registry : public testing::Test {
 protected:
  ~Registry() override {
    detail::registered_estimators<Testbed1>().clear();
    detail::registered_detectors().clear();
    detail::registered_specifications().clear();
  }
  static std::unique_ptr<const Robot> made() { return make_robot("testbed1", Testbed1()); }
  static std::string why_not() {
    return error_of([] { made(); });
  }
  template <class E>
  static void add(double w) {
    register_estimator<Testbed1>(
        [w](const Testbed1& arm) { return E(arm, E::Parameters::for_bandwidth(arm, w)); });
  }
};

bool holds(const std::vector<std::string>& list, const std::string& name) {
  return std::count(list.begin(), list.end(), name) > 0;
}

TEST_F(Registry, TakesAnEstimatorAndADetectorOfNewNamesWhichHaveTheirKeys) {
  add<Own>(10);
  register_detector<OwnDetector>();
  const auto r = made();
  EXPECT_TRUE(holds(r->estimators(), "own"));
  EXPECT_TRUE(holds(r->tunable(), "own"));
  EXPECT_TRUE(holds(r->detectors(), "own_detector"));
  EXPECT_NO_THROW(r->pair("own:bandwidth=90:max_gap=0.1", "own_detector:threshold=3", Trace()));
}

TEST_F(Registry, RefusesAnEstimatorOfATakenName) {
  add<Mo1>(90);
  EXPECT_EQ(why_not(),
            "estimator 'mo1' of testbed1: the name is taken; other parameters of it are a "
            "specification, mo1:key=value");
}

TEST_F(Registry, RefusesOneNameAtThreeBandwidths) {
  for (const double w : {10, 30, 90}) add<Own>(w);
  EXPECT_NE(why_not().find("estimator 'own' of testbed1: the name is taken"), std::string::npos);
}

TEST_F(Registry, RefusesADetectorOfATakenName) {
  register_detector<Threshold>();
  EXPECT_NE(why_not().find("detector 'threshold' of testbed1: the name is taken"),
            std::string::npos);
}

TEST_F(Registry, RefusesARobotAndAScenarioOfATakenName) {
  EXPECT_THROW(register_robot("wallmobot3", Testbed1(), "testbed1.xml"), std::invalid_argument);
  Scenario s = quiet();
  s.name = "mine";
  register_scenario("testbed1", s);
  EXPECT_THROW(register_scenario("testbed1", s), std::invalid_argument);
}

TEST_F(Registry, ListsASpecificationAsARowThatIsRunAsItSays) {
  add<Own>(10);
  register_specification("testbed1", "mo2:bandwidth=50");
  register_specification("testbed1", "own:K=20");
  register_specification("wallmobot3", "mo2:bandwidth=60");
  const auto r = made();
  const std::vector<std::string> all = r->estimators();
  ASSERT_GE(all.size(), 2u);
  EXPECT_EQ(all[all.size() - 2], "mo2:bandwidth=50");
  EXPECT_EQ(all.back(), "own:K=20");
  EXPECT_FALSE(holds(all, "mo2:bandwidth=60")) << "it is another robot's";
  EXPECT_FALSE(is_baseline(all.back()));

  const double q = 0.1, qd = 0.2, tau = 120;
  const auto steps = [&](Pair s) {
    double out = 0;
    for (int k = 0; k < 50; ++k) s.step(1e-3 * k, &q, &qd, &tau, &out);
    return out;
  };
  Mo1 by_hand(Testbed1(), {.K = Vec<1>(20)});
  Vec<1> expected;
  for (int k = 0; k < 50; ++k) {
    expected = by_hand.update({1e-3 * k, Vec<1>(q), Vec<1>(qd), Vec<1>(tau)}).tau_ext;
  }
  EXPECT_EQ(steps(r->pair(all.back(), "", Trace())), expected[0]);
}

TEST_F(Registry, RefusesASpecificationThatIsUnknownOrTakenOrOutOfRange) {
  const auto why = [](const char* text) {
    detail::registered_specifications().clear();
    register_specification("testbed1", text);
    return why_not();
  };
  EXPECT_NE(why("oracle:w=3").find("unknown estimator 'oracle'; known: zero"), std::string::npos);
  EXPECT_NE(why("mo2:w=3").find("there is no key 'w'; known: bandwidth [rad/s]"),
            std::string::npos);
  EXPECT_NE(why("mo2:bandwidth=-1").find("it must be 0.001 to 1e+06"), std::string::npos);
  EXPECT_NE(why("mo2").find("estimator 'mo2' of testbed1: the name is taken"), std::string::npos);
  EXPECT_EQ(why("mo2:bandwidth=50"), "no error");
  register_specification("testbed1", "mo2:bandwidth=50");
  EXPECT_NE(why_not().find("estimator 'mo2:bandwidth=50' of testbed1: the name is taken"),
            std::string::npos);
}

// the last one: after it nothing can be registered
TEST_F(Registry, FailsWhenTheRobotsAreFirstAskedForAndSaysWhy) {
  register_specification("r2d2", "mo2:bandwidth=50");
  EXPECT_EQ(error_of([] { robots(); }),
            "unknown robot 'r2d2'; known: wallmobot3, testbed1, wallmobot6, and files: MJCF, .xml, "
            "URDF, .urdf, or ours, .json");
  detail::registered_specifications() = {{"wallmobot3", "mo2"}};
  // as tauext-bench does: exit code 2 and a line
  CLI::App app("", "own-bench");
  char name[] = "own-bench";
  char* argv[] = {name, nullptr};
  testing::internal::CaptureStderr();
  EXPECT_EQ(run_program(app, 1, argv, [] { return static_cast<int>(robots().size()); }),
            kCouldNotRun);
  EXPECT_EQ(
      testing::internal::GetCapturedStderr(),
      "own-bench: estimator 'mo2' of wallmobot3: the name is taken; other parameters of it are "
      "a specification, mo2:key=value\n");
  detail::registered_specifications() = {{"wallmobot3", "mo2:bandwidth=50"}};
  EXPECT_TRUE(holds(robot("wallmobot3").estimators(), "mo2:bandwidth=50"));
  EXPECT_TRUE(holds(wallmobot3_believing(100)->estimators(), "mo2:bandwidth=50"));
  EXPECT_THROW(register_specification("testbed1", "mo2:bandwidth=50"), std::logic_error);
}

// in a process of its own, in which nobody has asked for scenarios before
TEST(RegistryDeathTest, AScenarioOfARobotThatDoesNotExistIsRefused) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto misspelt = [] {
    register_scenario("wallmobto3", {.name = "mine", .description = "of nobody"});
    std::fputs(error_of([] { scenarios("wallmobot3"); }).c_str(), stderr);
    std::exit(0);
  };
  EXPECT_EXIT(misspelt(), testing::ExitedWithCode(0),
              "unknown robot 'wallmobto3'; known: testbed1, wallmobot3, wallmobot6");
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "bench/score/entry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "bench/roster/robots.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

bool holds(const std::vector<Entry>& all, const std::string& name) {
  return std::any_of(all.begin(), all.end(), [&](const Entry& e) { return e.name() == name; });
}

std::string error(const Selection& s) {
  return error_of([&] { entries(s); });
}

TEST(Entries, NameEachRowOnce) {
  std::set<std::string> names;
  for (const Entry& e : entries()) EXPECT_TRUE(names.insert(e.name()).second) << e.name();
  EXPECT_TRUE(names.contains("wallmobot3/step/ekf"));
  EXPECT_TRUE(names.contains("wallmobot3/collision/ndob+pan_tompkins"));
  EXPECT_FALSE(names.contains("wallmobot3/collision/ndob+high_pass")) << "of the studies alone";
}

TEST(Entries, OfASelectionAreItsSpecificationsAlone) {
  const auto all =
      entries({.estimators = {"mo2:bandwidth=50", "ekf_zero_start"}, .detectors = {"high_pass"}});
  EXPECT_TRUE(holds(all, "wallmobot3/step/mo2:bandwidth=50"));
  EXPECT_TRUE(holds(all, "testbed1/collision/mo2:bandwidth=50+high_pass"));
  EXPECT_TRUE(holds(all, "testbed1/hold/ekf_zero_start"));
  for (const Entry& e : all) {
    EXPECT_TRUE(e.estimator() == "mo2:bandwidth=50" || e.robot().name() == "testbed1")
        << e.name() << ": wallmobot3 has no ekf_zero_start";
    EXPECT_TRUE(e.detector().empty() || e.detector() == "high_pass") << e.name();
  }
}

TEST(Entries, RefuseWhatNoRobotUnderstands) {
  EXPECT_NE(error({.estimators = {"ekf", "guess"}, .detectors = {}})
                .find("unknown estimator 'guess'; known: zero, truth"),
            std::string::npos);
  EXPECT_NE(error({.estimators = {}, .detectors = {"ear"}})
                .find("unknown detector 'ear'; known: pan_tompkins"),
            std::string::npos);
  EXPECT_NE(error({.estimators = {"mo2:gain=3"}, .detectors = {}})
                .find("mo2:gain=3: there is no key 'gain'; known: bandwidth [rad/s]"),
            std::string::npos);
  EXPECT_NE(error({.estimators = {"ekf_zero_start:gain=3"}, .detectors = {}})
                .find("ekf_zero_start:gain=3: there is no key 'gain'"),
            std::string::npos)
      << "and not that wallmobot3 does not know the name";
  EXPECT_NE(error({.estimators = {"truth:delay=3"}, .detectors = {}}).find("known: no keys at all"),
            std::string::npos);
  EXPECT_NE(
      error({.estimators = {"mo2:bandwidth=-1"}, .detectors = {}}).find("bandwidth=-1: it must"),
      std::string::npos);
  EXPECT_NE(error({.estimators = {"ekf", "ekf"}, .detectors = {}}).find("'ekf' is named twice"),
            std::string::npos);
}

TEST(Entries, ARobotOfOneJointLeavesOutWhatIsForThree) {
  const auto all = entries({.estimators = {"ndob:X=600/600/600"}, .detectors = {}});
  EXPECT_TRUE(holds(all, "wallmobot3/step/ndob:X=600/600/600"));
  for (const Entry& e : all) EXPECT_EQ(e.robot().name(), "wallmobot3");
}

TEST(Entry, IsResolvedOrRefused) {
  const Entry e("testbed1", "collision", "mo2:bandwidth=50", "pan_tompkins");
  EXPECT_EQ(&e.robot(), &robot("testbed1"));
  EXPECT_EQ(&e.scenario(), &scenario("testbed1", "collision"));
  EXPECT_EQ(e.name(), "testbed1/collision/mo2:bandwidth=50+pan_tompkins");
  EXPECT_EQ(e.group(), "testbed1/collision");
  EXPECT_TRUE(e.closed_loop());
  EXPECT_FALSE(e.with_detector("").closed_loop());
  EXPECT_THROW(Entry("r2d2", "step", "ekf"), std::invalid_argument);
  EXPECT_THROW(Entry("testbed1", "dance", "ekf"), std::invalid_argument);
  EXPECT_THROW(Entry("testbed1", "hold", "guess"), std::invalid_argument);
  EXPECT_THROW(Entry("testbed1", "hold", "ekf", "ear"), std::invalid_argument);
}

}  // namespace
}  // namespace tauext::test

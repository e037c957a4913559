// SPDX-License-Identifier: Apache-2.0
// The roster's plug-in holds the roster.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>

#include "bench/roster/baselines.h"
#include "bench/roster/robots.h"
#include "bench/roster/test/hinge_robot.h"
#include "regression/host/plugin_host.h"

namespace tauext::gate::test {
namespace {

TEST(RosterPlugin, HoldsEveryEstimatorDetectorAndModelAndNoBaseline) {
  const Plugin plugin(TAUEXT_BIN "/tauext_plugin.so");
  int expected = 0;
  for (const auto& known : robots()) {
    const Robot& r = *known;
    for (const std::string& e : r.estimators()) {
      EXPECT_EQ(plugin.find(r.name() + "/" + e) >= 0, !is_baseline(e)) << r.name() << "/" << e;
      expected += !is_baseline(e);
    }
    for (const std::string& d : r.detectors()) EXPECT_GE(plugin.find(r.name() + "/" + d), 0) << d;
    for (const char* term :
         {"inertia", "gravity", "bias", "momentum_bias", "friction", "forward_dynamics"}) {
      EXPECT_GE(plugin.find(r.name() + "/model." + term), 0) << r.name() << " " << term;
    }
    expected += static_cast<int>(r.detectors().size()) + 6;
  }
  const tauext::test::HingeRobot from_file(7);
  for (const std::string& e : from_file.robot->estimators()) {
    EXPECT_EQ(plugin.find("tree7/" + e) >= 0, !is_baseline(e)) << e;
    expected += !is_baseline(e);
  }
  EXPECT_EQ(plugin.count(), expected + 6) << "and the terms of its model";
}

TEST(RosterPlugin, GivesEachKernelALifeOfItsRobot) {
  const Plugin plugin(TAUEXT_BIN "/tauext_plugin.so");
  constexpr int kSamples = 20'000;
  Lives lives(3, kSamples);
  for (int i = 0; i < plugin.count(); ++i) {
    const Samples samples = lives.of(plugin, i);
    const std::vector<double>& x = samples.plain();
    const std::size_t size = x.size() / kSamples, joints = (size - 1) / 4;
    int bad = 0, restarts = 0, gaps = 0, repeated = 0;
    double largest = 0;
    for (std::size_t k = 0; k < kSamples; ++k) {
      const double* s = &x[k * size];
      bad += !std::all_of(s, s + size, [](double v) { return std::isfinite(v); });
      restarts += s[0] == 0;
      if (k > 0 && s[0] > 0) {
        gaps += s[0] - s[-static_cast<std::ptrdiff_t>(size)] > 0.04;
        repeated += s[0] == s[-static_cast<std::ptrdiff_t>(size)];
      }
      largest = std::max(largest, std::abs(s[1 + 3 * joints]));
    }
    EXPECT_GT(bad, 60) << "1 % of the samples, and a blind torque sensor now and then";
    EXPECT_GE(restarts, 2);
    EXPECT_GE(gaps, 2);
    EXPECT_GT(repeated, 10);
    EXPECT_GT(largest, 50) << "N m, a blow";
    Work(plugin, i, samples).run(2 * kSamples + 500);
  }
}

// every one has parameters, of its own or of its arm; a state of zeros would be anybody's
TEST(RosterPlugin, ShowsTheStateOfEachKernel) {
  const Plugin plugin(TAUEXT_BIN "/tauext_plugin.so");
  Lives lives(1, 1);
  for (int i = 0; i < plugin.count(); ++i) {
    const std::string state = Work(plugin, i, lives.of(plugin, i)).state();
    EXPECT_NE(state.find_first_not_of('\0'), std::string::npos)
        << plugin.name(i) << ": " << state.size() << " bytes";
  }
}

TEST(RosterPlugin, SharesALifeAndRepeatsNothing) {
  const Plugin plugin(TAUEXT_BIN "/tauext_plugin.so");
  Lives lives(3, 5000);
  const Samples& one = lives.of(plugin, plugin.find("wallmobot3/mo1"));
  EXPECT_EQ(one.unpacked(), lives.of(plugin, plugin.find("wallmobot3/ekf")).unpacked());
  Lives others(4, 5000);
  EXPECT_NE(one.plain()[1], others.of(plugin, plugin.find("wallmobot3/mo1")).plain()[1])
      << "another seed, another life";
  std::set<double> q;
  for (std::size_t k = 0; k < 5000; ++k) q.insert(one.plain()[13 * k + 2]);
  EXPECT_GT(q.size(), 3000u) << "where it moves, it is nowhere twice";
}

}  // namespace
}  // namespace tauext::gate::test

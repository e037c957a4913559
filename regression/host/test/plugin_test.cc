// SPDX-License-Identifier: Apache-2.0
// The roster's plug-in holds the roster.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bench/roster/baselines.h"
#include "bench/roster/robots.h"
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
  EXPECT_EQ(plugin.count(), expected);
}

TEST(RosterPlugin, GivesEachKernelASecondOfFiniteSamplesThatMoveAndAreHit) {
  const Plugin plugin(TAUEXT_BIN "/tauext_plugin.so");
  for (int i = 0; i < plugin.count(); ++i) {
    const std::vector<double> x = example(plugin, i);
    const auto size = x.size() / kExampleSamples;
    EXPECT_TRUE(std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); }));
    EXPECT_DOUBLE_EQ(x[size * 999], 0.999) << "t of the last sample";
    EXPECT_NE(x[1], x[size * 500 + 1]) << "q moves";
    EXPECT_GT(std::abs(x[size * 415 + size - 1] - x[size * 300 + size - 1]), 100) << "a blow, N m";
    Work(plugin, i, x).run(2500);
  }
}

}  // namespace
}  // namespace tauext::gate::test

// SPDX-License-Identifier: Apache-2.0
// What every estimator of wallmobot3 must do, whoever wrote it.
#include <gtest/gtest.h>

#include "bench/kit/conformance.h"
#include "bench/kit/test/every_estimator.h"
#include "bench/roster/baselines.h"
#include "bench/score/suite.h"
#include "mjcf/record.h"

namespace tauext::test {
namespace {

TEST(EveryEstimatorOfWallMoBot3, Conforms) {
  const int count = for_every_estimator<WallMoBot3>(
      [](auto make) { conformance::check_estimator(WallMoBot3(), make); });
  EXPECT_GE(count, 10);
}

TEST(EveryEstimatorOfWallMoBot3, EstimatesAForceOnThePanelAsMinusJTransposeF) {
  Scenario s = scenario("wallmobot3", "free");
  s.duration = 12;
  s.force = [](double, const Point&) -> Eigen::Vector3d { return {50, 0, 0}; };
  const Trace t = record(load_robot("wallmobot3"), s);
  const Vec<3> truth = -WallMoBot3().jacobian(t.q.col(t.size() - 1)).transpose() * Vec<3>(50, 0, 0);
  for_every_estimator<WallMoBot3>([&](auto make) {
    auto e = make();
    Vec<3> last;
    for (int k = 0; k < t.size(); ++k) last = e.update(t.measurement<3>(k)).tau_ext;
    EXPECT_LT((last - truth).cwiseAbs().maxCoeff(), 0.05 * truth.norm())
        << e.kName << " " << last.transpose();
  });
}

// within 0.1 N m in the last second after a step of 98.2 N m, which every estimator has had 29 s
// for
TEST(EveryEstimatorOfWallMoBot3, EndsUpAtTheLoadAfterAStep) {
  for (const Entry& e : entries()) {
    if (e.group() != "wallmobot3/step" || is_baseline(e.estimator())) continue;
    static Suite suite{SuiteOptions{}};
    EXPECT_LE(*suite.score(e).get(Metric::kFinal), 0.1) << e.name();
  }
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
// That tunings by one bandwidth hold on every arm, in poses where B is far from that of q = 0.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "bench/roster/robots.h"
#include "bench/roster/test/hinge_robot.h"
#include "bench/score/metrics.h"
#include "mjcf/record.h"

namespace tauext::test {
namespace {

struct Answer {
  double rmse = 0, overshoot = 0;  // [1] of the step
};

// to a step on every joint of an arm that holds this pose [rad]
Trace held(const Model& model, double pose, double step) {
  Scenario s = quiet();
  s.duration = 2;
  s.start_on_reference = true;
  s.reference = [pose](double, int) { return Reference{pose, 0, 0}; };
  s.tau_ext = [step](double t, int) { return t < 0.5 ? 0 : step; };
  return record(model, s);
}

// the estimators that every robot has, by name; the worst joint
std::map<std::string, Answer> answers(const Robot& robot, const Trace& trace, double step) {
  std::map<std::string, Answer> all;
  for (const char* name : {"inverse_dynamics", "mo1", "mo2", "mo3", "ndob_wb", "dkf",
                           "dkf_adaptive", "smo", "aob", "eso", "ekf:bandwidth=30"}) {
    const Output out = robot.run(name, trace);
    Score score;
    add_error_metrics(trace, out, 0, score);
    all[name] = {*score.get(Metric::kRmse) / step, out.tau_ext.maxCoeff() / step - 1};
  }
  return all;
}

class Tuning : public testing::TestWithParam<int> {};

TEST_P(Tuning, OfEveryEstimatorHoldsInEveryPose) {
  const HingeRobot arm(GetParam());
  const auto known = answers(robot("wallmobot3"), held(load_robot("wallmobot3"), 0.1, 50), 50);
  for (const double pose : {-1.3, -0.7, 0., 0.4, 1.1}) {
    constexpr double kStep = 0.5;  // [N m] so little that the arm hardly moves
    const auto found = answers(*arm.robot, held(arm.model, pose, kStep), kStep);
    for (const auto& [name, a] : found) {
      SCOPED_TRACE(fmt::format("{} at {} rad", name, pose));
      EXPECT_LE(a.rmse, 1.5 * known.at(name).rmse);
      EXPECT_LE(a.rmse, 1.5 * found.at("mo2").rmse);
      // smo's sliding terms are for errors of a velocity, so its overshoot depends on the step
      EXPECT_LE(a.overshoot, 1.5 * std::max(known.at(name).overshoot, 0.03));
    }
  }
}
INSTANTIATE_TEST_SUITE_P(SixAndSevenJoints, Tuning, testing::Values(6, 7),
                         [](const auto& i) { return fmt::format("{}_joints", i.param); });

}  // namespace
}  // namespace tauext::test

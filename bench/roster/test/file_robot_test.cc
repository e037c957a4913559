// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/file_robot.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "bench/kit/allocations.h"
#include "bench/roster/baselines.h"
#include "bench/roster/test/hinge_arm.h"
#include "bench/score/metrics.h"
#include "mjcf/plant/tree.h"

namespace tauext {
namespace {

using test::hinge_arm;
namespace fs = std::filesystem;

class FileRobot : public testing::TestWithParam<int> {
 protected:
  FileRobot() : path_(fs::temp_directory_path() / fmt::format("tauext_arm_{}.xml", ::getpid())) {}
  ~FileRobot() override { fs::remove(path_); }
  std::string put(const std::string& xml) const {
    std::ofstream(path_) << xml;
    return path_.string();
  }
  std::string error(const std::string& xml) const {
    try {
      file_robot(put(xml));
    } catch (const std::exception& e) {
      return e.what();
    }
    return "no error";
  }
  fs::path path_;
};

// the truth is what the simulation was given
TEST_P(FileRobot, EveryEstimatorFindsALoadInMotion) {
  const int n = GetParam();
  const std::unique_ptr<const Robot> owned = file_robot(put(hinge_arm(n)));
  const Robot& r = *owned;
  EXPECT_EQ(r.dof(), n);
  Scenario s = quiet();
  s.duration = 3;
  s.start_on_reference = true;
  s.reference = [](double t, int) { return sine_motion(0.3, 3, t); };
  s.tau_ext = [](double t, int) { return t < 1 ? 0 : 5; };
  const Trace trace = record(r.load_for(s), s);
  for (const std::string& e : r.estimators()) {
    if (is_baseline(e)) continue;
    const Output out = r.run(e, trace);
    Score score;
    add_error_metrics(trace, out, 2, score);
    EXPECT_LT(*score.get(Metric::kRmse), 0.02) << e;  // of 5 N m
    Score before;
    add_error_metrics(select_samples(trace,
                                     [] {
                                       std::vector<int> first;
                                       for (int k = 0; k < 990; ++k) first.push_back(k);
                                       return first;
                                     }()),
                      {out.tau_ext.leftCols(990), {}, {}}, 0, before);
    EXPECT_LT(*before.get(Metric::kMax), 0.05) << e;
  }
}
INSTANTIATE_TEST_SUITE_P(OneToEightJoints, FileRobot, testing::Range(1, 9),
                         [](const auto& i) { return fmt::format("{}_joints", i.param); });

TEST_P(FileRobot, NoStepAllocates) {
  const int n = GetParam();
  const std::unique_ptr<const Robot> owned = file_robot(put(hinge_arm(n)));
  const Robot& r = *owned;
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(n, 0.3), qd = q, tau = q;
  Eigen::VectorXd out(n);
  for (const std::string& e : r.estimators()) {
    if (is_baseline(e)) continue;
    Pair pair = r.pair(e, "contact_classifier", Trace());
    pair.step(0, q.data(), qd.data(), tau.data(), out.data());
    EXPECT_EQ(allocations_of([&] {
                for (int k = 1; k < 10; ++k) {
                  pair.step(1e-3 * k, q.data(), qd.data(), tau.data(), out.data());
                }
              }),
              0u)
        << e;
  }
}

TEST_F(FileRobot, AGearIsTheMotorsAndNotTheJoints) {
  std::string geared = hinge_arm(2);
  for (std::size_t at = 0; (at = geared.find("<motor ", at)) != std::string::npos; ++at) {
    geared.insert(at + 7, "gear='100' ");
  }
  const TreeModel<2> with = tree_model<2>(load_mjcf(put(geared))),
                     without = tree_model<2>(load_mjcf(put(hinge_arm(2))));
  const Vec<2> q(0.1, -0.4);
  EXPECT_EQ(with.inertia(q), without.inertia(q));
  EXPECT_EQ(with.gravity(q), without.gravity(q));
}

TEST_F(FileRobot, PositionServosAreFineForAnArmThatIsWatched) {
  const std::string servos = put(hinge_arm(3, false));
  const TreeModel<3> watched = tree_model<3>(load_mjcf(servos)),
                     driven = tree_model<3>(load_mjcf(put(hinge_arm(3))));
  const Vec<3> q(0.1, -0.4, 0.7), qd(1, 0.5, -2);
  EXPECT_EQ(watched.bias(q, qd), driven.bias(q, qd));
  EXPECT_EQ(watched.inertia(q), driven.inertia(q));
}

TEST_F(FileRobot, WhatIsNoArmIsRefusedWithItsName) {
  const auto refuses = [&](const std::string& xml, const std::string& why) {
    const std::string what = error(xml);
    EXPECT_NE(what.find(path_.string()), std::string::npos) << what;
    EXPECT_NE(what.find(why), std::string::npos) << what;
  };
  refuses(hinge_arm(9), "9 joints: 1 to 8 are supported");
  refuses("<mujoco><worldbody><body><freejoint/><geom size='1'/></body></worldbody></mujoco>",
          "hinges and slides");
  refuses("<mujoco><worldbody/></mujoco>", "hinges and slides");
  refuses(
      "<mujoco><worldbody><body><joint stiffness='3'/><geom size='1'/></body></worldbody></mujoco>",
      "joint 1 'joint1' has a spring");
  refuses(
      "<mujoco><option density='1.2'/><worldbody><body><joint/><geom "
      "size='1'/></body></worldbody></mujoco>",
      "air");
  refuses(
      "<mujoco><worldbody><body><joint name='a'/><geom size='1'/></body></worldbody><tendon><fixed "
      "damping='1'>"
      "<joint joint='a' coef='1'/></fixed></tendon></mujoco>",
      "tendons");
  refuses("no xml", "");
}

}  // namespace
}  // namespace tauext

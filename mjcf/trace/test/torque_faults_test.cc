// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include "mjcf/test/error_of.h"
#include "mjcf/trace/sensors.h"
#include "mjcf/trace/test/still.h"

namespace tauext::test {
namespace {

using Eigen::MatrixXd;

// sensors of torque, in shares of what joints are used to
TEST(TorqueFaults, AreSharesOfWhatAJointIsUsedTo) {
  Trace t = still(20000);
  t.usual_torque = Eigen::Vector3d(10, 100, 1000);
  t.tau = t.usual_torque * Eigen::RowVectorXd::Ones(t.size());
  t.q.row(0).setLinSpaced(t.size(), 0, 1), t.q.row(1) = t.q.row(2) = t.q.row(0);
  const auto off = [&](const TorqueFaults& f, std::uint64_t seed) {
    const Trace m = measure(t, {.torque = f, .seed = seed});
    EXPECT_EQ(m.q, t.q);
    return MatrixXd(t.usual_torque.cwiseInverse().asDiagonal() * (m.tau - t.tau));
  };
  double least = 1, most = -1;
  for (std::uint64_t seed = 1; seed < 100; ++seed) {
    const MatrixXd gain = off({.gain = 0.05}, seed), bias = off({.bias = 0.02}, seed);
    EXPECT_LT((gain.colwise() - gain.col(0)).cwiseAbs().maxCoeff(), 1e-12) << "the same all along";
    EXPECT_LE(gain.cwiseAbs().maxCoeff(), 0.05 + 1e-12);
    EXPECT_LE(bias.cwiseAbs().maxCoeff(), 0.02 + 1e-12);
    least = std::min(least, gain(0, 0)), most = std::max(most, gain(0, 0));
  }
  EXPECT_LT(least, -0.045) << "each seed is another arm";
  EXPECT_GT(most, 0.045);
  const MatrixXd noise = off({.noise = 0.01}, 3);
  for (int j = 0; j < 3; ++j)
    EXPECT_NEAR(std::sqrt(noise.row(j).squaredNorm() / t.size()), 0.01, 2.5e-4);
  // 200 waves a turn: over 1 rad 100 / pi of them
  const MatrixXd ripple = off({.ripple = 0.03}, 3);
  for (int j = 0; j < 3; ++j) {
    EXPECT_NEAR(ripple.row(j).maxCoeff(), 0.03, 1e-5);
    EXPECT_NEAR(ripple.row(j).minCoeff(), -0.03, 1e-5);
    int crossings = 0;
    for (int k = 1; k < t.size(); ++k) crossings += ripple(j, k - 1) < 0 && ripple(j, k) >= 0;
    EXPECT_NEAR(crossings, 200 / (2 * std::numbers::pi), 1);
  }
}

TEST(TorqueFaults, OfATorqueThatRisesAndFallsHysteresisLeavesALoop) {
  Trace t = still(2001);
  t.usual_torque = Eigen::Vector3d::Constant(100);
  for (int k = 0; k < t.size(); ++k) t.tau.col(k).setConstant(50 - std::abs(k - 1000) * 0.1);
  const Trace m = measure(t, {.torque = {.hysteresis = 0.02}});
  EXPECT_NEAR(m.tau(1, 800) - t.tau(1, 800), -1, 1e-12);
  EXPECT_NEAR(m.tau(1, 1200) - t.tau(1, 1200), 1, 1e-12);
}

TEST(TorqueFaults, RippleIsThatOfWhereTheMotorWasWhenTorqueWasRead) {
  Trace t = still(2000);
  t.usual_torque = Eigen::Vector3d::Constant(100);
  for (int k = 0; k < t.size(); ++k) t.q.col(k).setConstant(2 * t.t[static_cast<std::size_t>(k)]);
  const TorqueFaults ripple{.ripple = 0.01};
  const Trace now = measure(t, {.torque = ripple}),
              late = measure(t, {.torque = ripple, .tau_latency = 0.008});
  EXPECT_GT((now.tau.leftCols(1900) - late.tau.leftCols(1900)).cwiseAbs().maxCoeff(), 1);
  EXPECT_LT((now.tau.leftCols(1900) - late.tau.middleCols(8, 1900)).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(TorqueFaults, SharesOfTorquesThatNobodyKnowsAreAnError) {
  const std::string error = error_of([] { measure(still(10), {.torque = {.gain = 0.1}}); });
  EXPECT_NE(error.find("known of a simulated arm alone"), std::string::npos) << error;
  EXPECT_NE(error_of([] {
              measure(still(10), {.torque = {.ripple = 20}});
            }).find("torque ripple [1] must be 0 to 10, not 20"),
            std::string::npos);
}

}  // namespace
}  // namespace tauext::test

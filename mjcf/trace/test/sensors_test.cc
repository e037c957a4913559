// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/sensors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include "mjcf/test/error_of.h"
#include "mjcf/trace/test/still.h"

namespace tauext::test {
namespace {

using Eigen::MatrixXd;

TEST(Sensors, IdealOnesChangeNothing) {
  const Trace t = still(100), m = measure(t, {});
  EXPECT_EQ(m.q, t.q);
  EXPECT_EQ(m.qd, t.qd);
  EXPECT_EQ(m.tau, t.tau);
}

TEST(Sensors, NoiseIsWhiteGaussianAndOfTheStatedSize) {
  const int n = 100000;
  const Trace m = measure(still(n), {.velocity_noise = 1e-3, .loadcell_noise = 2, .seed = 5});
  for (int j = 0; j < 3; ++j) {
    // a standard deviation of n samples is good to 1 / sqrt(2 n) = 0.22 %: five of these
    EXPECT_NEAR(std::sqrt(m.qd.row(j).squaredNorm() / n), 1e-3, 1.1e-5);
    EXPECT_NEAR(std::sqrt(m.tau.row(j).squaredNorm() / n), 2, 0.022);
    EXPECT_NEAR(m.tau.row(j).mean(), 0, 5 * 2 / std::sqrt(n));
    const double beyond_2_sigma = (m.tau.row(j).array().abs() > 4).cast<double>().mean();
    EXPECT_NEAR(beyond_2_sigma, 0.0455, 0.004);
    const double lag_1 = m.tau.row(j).head(n - 1).dot(m.tau.row(j).tail(n - 1)) / (4. * n);
    EXPECT_NEAR(lag_1, 0, 5 / std::sqrt(n));
  }
  EXPECT_NEAR(m.qd.row(0).dot(m.qd.row(1)) / (1e-6 * n), 0, 5 / std::sqrt(n))
      << "joints are independent";
}

TEST(Sensors, TheSeedAndNothingElseDecides) {
  const Trace t = still(1000);
  const Sensors s{.velocity_noise = 1e-3, .seed = 9};
  EXPECT_EQ(measure(t, s).qd, measure(t, s).qd);
  EXPECT_NE(measure(t, s).qd, measure(t, {.velocity_noise = 1e-3, .seed = 10}).qd);
  // another channel's noise leaves this one's bits alone
  EXPECT_EQ(measure(t, s).qd,
            measure(t, {.velocity_noise = 1e-3, .loadcell_noise = 1, .seed = 9}).qd);
}

TEST(Sensors, OfOneSeedShareTheNumbersThatWereDrawn) {
  const Trace t = still(1000);
  std::vector<Normals> drawn = velocity_noise(t.dof(), 9);
  for (const Sensors& s :
       {Sensors{.velocity_noise = 1e-3, .seed = 9},
        Sensors{.velocity_noise = 1e-4, .latency = 3e-3, .dropped = 0.1, .seed = 9}})
    EXPECT_EQ(measure(t, s, drawn).qd, measure(t, s).qd);
}

TEST(Sensors, AnEncoderRoundsToWholeSteps) {
  const Trace m = measure(still(10), {.encoder_step = 0.01});
  EXPECT_DOUBLE_EQ(m.q(0, 0), 0.12);
}

TEST(Sensors, TheTruthStaysTheTruth) {
  const Trace t = still(10);
  EXPECT_EQ(measure(t, {.loadcell_noise = 1}).tau_ext, t.tau_ext);
}

TEST(Sensors, NegativeNoiseIsRefusedByName) {
  EXPECT_EQ(error_of([] { measure(still(2), {.velocity_noise = -1}); }),
            "velocity noise [rad/s] must be 0 to 1e+09, not -1");
}

// one joint with the testbed's screw, at rest at q under forces along it
constexpr Screw kScrew{.a = 0.3, .c = 0.4, .gamma0 = std::numbers::pi / 2};

Trace under_forces(double q, const std::vector<double>& forces) {
  Trace t;
  const auto n = static_cast<Eigen::Index>(forces.size());
  t.q = Eigen::MatrixXd::Constant(1, n, q);
  t.qd = Eigen::MatrixXd::Zero(1, n);
  t.tau.resize(1, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    t.t.push_back(1e-3 * static_cast<double>(k));
    t.tau(0, k) = forces[k] * kScrew.lever(q);
  }
  t.screws = {kScrew};
  return t;
}

// what the loadcell makes of these forces, back in N
std::vector<double> read(const std::vector<double>& forces, const Loadcell& l, double q = 0) {
  const Trace m = measure(under_forces(q, forces), {.loadcell = l});
  std::vector<double> out;
  for (int k = 0; k < m.size(); ++k) out.push_back(m.tau(0, k) / kScrew.lever(q));
  return out;
}

TEST(Loadcell, ScaleAndOffsetActOnTheForceSoTheirTorqueDependsOnThePose) {
  for (const double q : {-0.4, 0., 0.6}) {
    const Trace m = measure(under_forces(q, {500}), {.loadcell = {.scale = 1.02, .offset = 5}});
    // (33)-(34) by the law of cosines
    const double theta =
        std::acos((0.09 + std::pow(kScrew.length(q), 2) - 0.16) / (2 * 0.3 * kScrew.length(q)));
    EXPECT_NEAR(m.tau(0, 0), (500 * 1.02 + 5) * 0.3 * std::sin(theta), 1e-9) << q;
  }
}

TEST(Loadcell, NonlinearityIsLargestAtHalfScaleAndNoneAtTheEnds) {
  const Loadcell l{.nonlinearity = 0.005, .full_scale = 1000};
  const auto f = read({0, 500, 1000, -500, -1000}, l);
  const double expected[] = {0, 505, 1000, -505, -1000};
  for (int k = 0; k < 5; ++k) EXPECT_NEAR(f[k], expected[k], 1e-9);
}

TEST(Loadcell, HysteresisLagsByHalfTheLoopEachWay) {
  const auto f = read({0, 400, 200, 199, 600}, {.hysteresis = 0.01, .full_scale = 1000});
  const double expected[] = {0, 395, 205, 204, 595};
  for (int k = 0; k < 5; ++k) EXPECT_NEAR(f[k], expected[k], 1e-9) << k;
}

TEST(Loadcell, ReadsInWholeStepsOfForce) {
  const auto f = read({100.2, 100.3, -0.1}, {.step = 0.5}, 0.3);
  EXPECT_NEAR(f[0], 100, 1e-9);
  EXPECT_NEAR(f[1], 100.5, 1e-9);
  EXPECT_NEAR(f[2], 0, 1e-9);
}

TEST(Loadcell, NoiseOfTheForceReachesTauByTheLever) {
  const std::vector<double> forces(20000, 450);
  for (const double q : {-0.4, 0.6}) {
    const Trace m = measure(under_forces(q, forces), {.loadcell = {.noise = 2}});
    const Eigen::ArrayXd e = m.tau.row(0).array() - 450 * kScrew.lever(q);
    // 20,000 samples give the deviation to 0.5 %
    EXPECT_NEAR(std::sqrt(e.square().mean()), 2 * kScrew.lever(q), 0.02 * 2 * kScrew.lever(q));
  }
}

TEST(Loadcell, AnEncoderErrorReachesTauByTheGeometryToo) {
  // q = 0.05 is read as 0.1: the force is right, its lever is not
  const Trace m = measure(under_forces(0.0501, {450}), {.encoder_step = 0.1});
  EXPECT_NEAR(m.q(0, 0), 0.1, 1e-15);
  EXPECT_NEAR(m.tau(0, 0), 450 * kScrew.lever(0.1), 1e-9);
}

TEST(Loadcell, RefusesFaultsOutOfRangeByName) {
  EXPECT_NE(error_of([] { read({1}, {.full_scale = -1}); }).find("loadcell full_scale [N]"),
            std::string::npos);
  EXPECT_NE(error_of([] { read({1}, {.hysteresis = 2}); }).find("loadcell hysteresis"),
            std::string::npos);
}

TEST(Loadcell, OfARobotWithoutScrewsIsATorqueSensorInEachJoint) {
  Trace t = still(3);
  t.tau.row(1).setConstant(1500);  // half of 3000 N m
  const Trace m = measure(t, {.loadcell = {.scale = 1.02, .offset = -30, .nonlinearity = 0.005}});
  EXPECT_DOUBLE_EQ(m.tau(1, 2), 1500 + 15);
  const Trace biased = measure(t, {.loadcell = {.scale = 1.1, .offset = 3}});
  EXPECT_DOUBLE_EQ(biased.tau(1, 0), 1653);
  EXPECT_DOUBLE_EQ(biased.tau(0, 0), 3);
}

// q, qd and tau say which sample they are of
Trace counting(int samples) {
  Trace t = still(samples);
  for (int k = 0; k < samples; ++k) {
    t.q.col(k).setConstant(k);
    t.qd.col(k).setConstant(k);
    t.tau.col(k).setConstant(k);
    t.tau_ext.col(k).setConstant(k);
  }
  return t;
}

TEST(Latency, ReadingsAreAsOldAsItSaysAndTauOlderStill) {
  const Trace m = measure(counting(20), {.latency = 3e-3, .tau_latency = 2e-3});
  for (int k = 0; k < 20; ++k) {
    EXPECT_EQ(m.q(0, k), std::max(0, k - 3));
    EXPECT_EQ(m.qd(1, k), std::max(0, k - 3));
    EXPECT_EQ(m.tau(2, k), std::max(0, k - 5));
    EXPECT_EQ(m.tau_ext(0, k), k) << "the truth is not late";
    EXPECT_EQ(m.t[k], k * 1e-3);
  }
}

TEST(Jitter, MovesTimeStampsWithinItsRangeAndKeepsTheirOrder) {
  const Trace t = counting(20000), m = measure(t, {.jitter = 0.9e-3});
  double least = 1, most = -1;
  for (int k = 0; k < t.size(); ++k) {
    least = std::min(least, m.t[k] - t.t[k]);
    most = std::max(most, m.t[k] - t.t[k]);
    if (k > 0) {
      ASSERT_GT(m.t[k], m.t[k - 1]);
    }
  }
  EXPECT_GT(least, -0.9e-3);
  EXPECT_LT(least, -0.85e-3);
  EXPECT_GT(most, 0.85e-3);
  EXPECT_EQ(m.q, t.q);
}

TEST(DroppedSamples, AreMissingWithTheirTruthAndAsManyAsStated) {
  const Trace t = counting(20000), m = measure(t, {.dropped = 0.1});
  EXPECT_NEAR(m.size(), 18000, 5 * std::sqrt(20000 * 0.1 * 0.9));
  for (int k = 0; k < m.size(); ++k) {
    ASSERT_EQ(m.q(0, k), m.tau_ext(0, k));
    ASSERT_EQ(m.t[k], 1e-3 * m.q(0, k));
  }
}

TEST(RepeatedSamples, RepeatTheValuesBeforeThemUnderANewTimeStamp) {
  const Trace t = counting(20000), m = measure(t, {.repeated = 0.2});
  int repeated = 0;
  for (int k = 1; k < m.size(); ++k) {
    ASSERT_EQ(m.t[k], t.t[k]);
    if (m.q(0, k) == k) continue;
    ASSERT_EQ(m.q(0, k), m.q(0, k - 1));
    ASSERT_EQ(m.tau(0, k), m.tau(0, k - 1));
    ++repeated;
  }
  EXPECT_NEAR(repeated, 4000, 5 * std::sqrt(20000 * 0.2 * 0.8));
}

TEST(Sensors, RefusesALinkThatLosesEverything) {
  EXPECT_EQ(error_of([] { measure(still(2), {.dropped = 1}); }),
            "dropped [1] must be 0 to 0.99, not 1");
  // q / step would be infinite
  EXPECT_EQ(error_of([] { measure(still(3), {.encoder_step = 1e-320}); }),
            "encoder step [rad] must be 0 for none, or 1e-12 or more, not 1e-320");
}

}  // namespace
}  // namespace tauext::test

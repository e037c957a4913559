// SPDX-License-Identifier: Apache-2.0
#include "mjcf/sensors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

using Eigen::MatrixXd;

Trace still(int samples) {
  Trace t;
  for (int k = 0; k < samples; ++k) t.t.push_back(k * 1e-3);
  t.q = MatrixXd::Constant(3, samples, 0.12345);
  t.qd = t.tau = t.tau_ext = MatrixXd::Zero(3, samples);
  return t;
}

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

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "bench/score/bandwidth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mjcf/scenarios/scenario.h"

namespace tauext::test {
namespace {

using namespace metrics;  // NOLINT(google-build-using-namespace)
using Eigen::RowVectorXd;

// a swept sine through a first-order low-pass K, exactly discretised for a held input
struct Swept {
  Times t;
  Eigen::RowVectorXd truth, estimate;
  explicit Swept(double K, double h = 1e-3) {
    const Scenario& chirp = scenario("wallmobot3", "chirp");
    const int n = static_cast<int>(chirp.duration / h);
    truth.resize(n);
    estimate.resize(n);
    double y = 0;
    for (int k = 0; k < n; ++k) {
      t.push_back(k * h);
      estimate[k] = y;
      truth[k] = chirp.tau_ext(t[k], 0);
      y += -std::expm1(-K * h) * (truth[k] - y);
    }
  }
};

TEST(Bandwidth, OfAFirstOrderLowPassIsItsPole) {
  for (const double K : {2., 10., 30., 100., 200.}) {
    const Swept s(K);
    EXPECT_NEAR(bandwidth(s.t, s.truth, s.estimate), K, 0.02 * K);
    EXPECT_NEAR(bandwidth(s.t, 1e-6 * s.truth, 1e-6 * s.estimate), K, 0.02 * K) << "of a wrist";
  }
}

TEST(Bandwidth, DoesNotExistWhereNothingFallsOrNothingIsSwept) {
  const Swept s(10);
  const RowVectorXd nothing = RowVectorXd::Zero(s.truth.size());
  EXPECT_TRUE(std::isnan(bandwidth(s.t, s.truth, s.truth)));
  EXPECT_TRUE(std::isnan(bandwidth(s.t, s.truth, nothing)));
  EXPECT_TRUE(std::isnan(bandwidth(s.t, nothing, s.estimate)));
  Times uneven = s.t;
  uneven[100] += 0.5e-3;
  EXPECT_TRUE(std::isnan(bandwidth(uneven, s.truth, s.estimate)));
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/torque_sampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace tauext::test {
namespace {

// estimates that differ by a sine on the first joint of two, with noise
struct Estimates {
  Estimates(double weight, double noise, int samples = 4000) {
    std::mt19937_64 generator(3);
    const auto uniform = [&] { return static_cast<double>(generator() >> 11) * 0x1p-52 - 1; };
    trace.q = trace.qd = trace.tau = held = instant = Eigen::MatrixXd::Zero(2, samples);
    for (int k = 0; k < samples; ++k) {
      trace.t.push_back(k * 1e-3);
      const double delta = std::sin(2e-3 * k);
      held(0, k) = weight * delta + noise * uniform();
      instant(0, k) = held(0, k) - delta;
    }
    status.assign(static_cast<std::size_t>(samples), Status::kOk);
  }
  std::optional<TorqueWeight> weigh() const {
    return torque_weight(trace, held, instant, status, 30);
  }
  Trace trace;
  Eigen::MatrixXd held, instant;
  std::vector<Status> status;
};

TEST(TorqueWeight, IsThatOfTheDifferenceInTheEstimate) {
  for (const double weight : {0., 1.}) {
    const auto w = Estimates(weight, 0.1).weigh();
    ASSERT_TRUE(w);
    EXPECT_NEAR(w->weight, weight, w->sure);
    EXPECT_LT(w->sure, 0.1);
    EXPECT_TRUE(w->contradicts(weight == 0));
    EXPECT_FALSE(w->contradicts(weight == 1));
  }
}

TEST(TorqueWeight, SaysNothingWhereTheLogDoesNot) {
  for (const Estimates& e :
       {Estimates(1, 100), Estimates(30, 0.1), Estimates(-2, 0.1), Estimates(0.6, 0.1)}) {
    const auto w = e.weigh();
    ASSERT_TRUE(w);
    EXPECT_FALSE(w->contradicts(false) || w->contradicts(true)) << w->weight;
  }
  EXPECT_FALSE(Estimates(1, 0.1, 999).weigh()) << "too short";
  Estimates in_contact(1, 0.1);
  in_contact.trace.contact.assign(4000, 1);
  EXPECT_FALSE(in_contact.weigh());
  Estimates unused(1, 0.1);
  unused.status.assign(4000, Status::kJump);
  EXPECT_FALSE(unused.weigh());
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/torque_sampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

namespace tauext::test {
namespace {

// of estimates that differ by a sine on the first joint of two, with noise
std::optional<TorqueWeight> weight_of(double weight, double noise, int samples = 4000) {
  std::mt19937_64 generator(3);
  const auto uniform = [&] { return static_cast<double>(generator() >> 11) * 0x1p-52 - 1; };
  TorqueWeigher weigher(2);
  for (int k = 0; k < samples; ++k) {
    const double delta = std::sin(2e-3 * k);
    const double held[] = {weight * delta + noise * uniform(), 0};
    const double instant[] = {held[0] - delta, 0};
    weigher.take(held, instant);
  }
  return weigher.weight(30, 1e-3);
}

TEST(TorqueWeight, IsThatOfTheDifferenceInTheEstimate) {
  for (const double weight : {0., 1.}) {
    const auto w = weight_of(weight, 0.1);
    ASSERT_TRUE(w);
    EXPECT_NEAR(w->weight, weight, w->sure);
    EXPECT_LT(w->sure, 0.1);
    EXPECT_TRUE(w->contradicts(weight == 0));
    EXPECT_FALSE(w->contradicts(weight == 1));
    EXPECT_TRUE(w->leans_from(weight == 0));
    EXPECT_FALSE(w->leans_from(weight == 1));
  }
}

TEST(TorqueWeight, LeansToTheNearerReading) {
  EXPECT_TRUE(weight_of(2.2, 0.1)->leans_from(false));
  EXPECT_FALSE(weight_of(2.2, 0.1)->leans_from(true));
  EXPECT_TRUE(weight_of(-2, 0.1)->leans_from(true));
  EXPECT_FALSE(weight_of(0.5, 0.1)->leans_from(false) || weight_of(0.5, 0.1)->leans_from(true));
}

TEST(TorqueWeight, SaysNothingWhereTheLogDoesNot) {
  for (const auto& w :
       {weight_of(1, 100), weight_of(30, 0.1), weight_of(-2, 0.1), weight_of(0.6, 0.1)}) {
    ASSERT_TRUE(w);
    EXPECT_FALSE(w->contradicts(false) || w->contradicts(true)) << w->weight;
  }
  EXPECT_FALSE(weight_of(1, 0.1, 199)) << "too short";
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "estimators/math/tanh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace tauext::test {
namespace {

// largest relative error against long double, whose own is 1e-19
template <int N>
double relative_error(const Vec<N>& x) {
  const Vec<N> t = tanh(x);
  long double e = 0;
  for (int i = 0; i < N; ++i) {
    const long double right = std::tanh(static_cast<long double>(x[i]));
    e = std::max(e, right == 0 ? std::abs(t[i]) : std::abs(t[i] / right - 1));
  }
  return static_cast<double>(e);
}

TEST(Tanh, IsGoodToSevenParts1e16) {
  std::mt19937_64 generator(3);
  for (const double limit : {1e-300, 1e-9, .01, .2, 1., 3., 30., 1e6}) {
    std::uniform_real_distribution<double> u(-limit, limit);
    for (int i = 0; i < 50000; ++i) {
      const double a = u(generator), b = u(generator), c = u(generator);
      ASSERT_LT(relative_error<3>({a, b, c}), 7e-16) << a << ' ' << b << ' ' << c;
    }
  }
}

TEST(Tanh, IsGoodAtTheSeamsOfItsReduction) {
  for (int k = -120; k <= 120; ++k) {
    for (const double offset : {-1e-9, -1e-16, 0., 1e-16, 1e-9}) {
      const double x = k * (std::log(2) / 4) + offset;
      ASSERT_LT(relative_error<3>({x, x, x}), 7e-16) << x;
    }
  }
}

TEST(Tanh, HoldsForWhatIsNoNumberOrNoFiniteOne) {
  const double infinity = std::numeric_limits<double>::infinity();
  const Vec<4> t = tanh(Vec<4>(0, infinity, -infinity, std::nan("")));
  EXPECT_EQ(t[0], 0);
  EXPECT_EQ(t[1], 1);
  EXPECT_EQ(t[2], -1);
  EXPECT_TRUE(std::isnan(t[3]));
}

TEST(Tanh, FillsEveryNumberOfLanes) {
  EXPECT_LT(relative_error<1>(Vec<1>(0.7)), 7e-16);
  Vec<8> x;
  x << -4, -3, -2, -1, 0, 1, 2, 3;
  EXPECT_LT(relative_error<8>(x), 7e-16);
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "estimators/math/sin_cos.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace tauext::test {
namespace {

// largest absolute error against long double, whose own is 1e-19
template <int N>
double error(const Vec<N>& x) {
  Vec<N> s, c;
  sin_cos(x, s, c);
  long double e = 0;
  for (int i = 0; i < N; ++i) {
    const long double xi = x[i];
    e = std::max({e, std::abs(s[i] - std::sin(xi)), std::abs(c[i] - std::cos(xi))});
  }
  return static_cast<double>(e);
}

TEST(SinCos, IsGoodToTwoParts1e16UpToAMillionRadians) {
  std::mt19937_64 generator(3);
  for (const double limit : {1., 10., 1e3, 1e6}) {
    std::uniform_real_distribution<double> u(-limit, limit);
    for (int i = 0; i < 50000; ++i) {
      const double a = u(generator), b = u(generator), c = u(generator);
      ASSERT_LT(error<3>({a, b, c}), 2.1e-16) << a << ' ' << b << ' ' << c;
    }
  }
}

TEST(SinCos, IsGoodAtTheSeamsOfItsReduction) {
  for (int k = -1000; k <= 1000; ++k) {
    for (const double offset : {-1e-9, -1e-16, 0., 1e-16, 1e-9}) {
      const double x = k * (std::numbers::pi / 4) + offset;
      ASSERT_LT(error<3>({x, x, x}), 2.1e-16) << x;
    }
  }
}

TEST(SinCos, FillsEveryNumberOfLanes) {
  EXPECT_LT(error<1>(Vec<1>(0.7)), 2.1e-16);
  Vec<8> x;
  x << -4, -3, -2, -1, 0, 1, 2, 3;
  EXPECT_LT(error<8>(x), 2.1e-16);
}

}  // namespace
}  // namespace tauext::test

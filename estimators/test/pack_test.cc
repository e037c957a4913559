// SPDX-License-Identifier: Apache-2.0
#include "estimators/math/pack.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace tauext::test {
namespace {

template <class P>
class PackOf : public testing::Test {
 protected:
  static constexpr int W = P::kWidth;

  // numbers of every sign and size, and what is no number
  static P numbers(int shift) {
    constexpr double kAll[] = {1.5, -2, 0., -0., 1e-3, -7e5, 3, 0.25, -1e-8, 12};
    P p;
    for (int i = 0; i < W; ++i) p.set(i, kAll[static_cast<std::size_t>(i + shift) % 10]);
    return p;
  }
  // all(i) is what one(run i's numbers) is
  template <class One>
  static void expect(const P& all, const One& one) {
    for (int i = 0; i < W; ++i) {
      const double wanted = one(numbers(0)[i], numbers(3)[i]);
      EXPECT_EQ(all[i], wanted) << "run " << i;
      EXPECT_EQ(std::signbit(all[i]), std::signbit(wanted)) << "run " << i;
    }
  }
};
using Widths = testing::Types<Pack<4>, Pack<8>>;
TYPED_TEST_SUITE(PackOf, Widths);

TYPED_TEST(PackOf, IsComputedWithRunByRun) {
  const TypeParam a = this->numbers(0), b = this->numbers(3);
  this->expect(a + b, [](double x, double y) { return x + y; });
  this->expect(a - b, [](double x, double y) { return x - y; });
  this->expect(a * b, [](double x, double y) { return x * y; });
  this->expect(a / (b + 100.), [](double x, double y) { return x / (y + 100); });
  this->expect(-a, [](double x, double) { return -x; });
  this->expect(abs(a), [](double x, double) { return std::abs(x); });
  this->expect(copysign(a, b), [](double x, double y) { return std::copysign(x, y); });
  this->expect(sqrt(abs(a)), [](double x, double) { return std::sqrt(std::abs(x)); });
  this->expect(min(a, b), [](double x, double y) { return y < x ? y : x; });
  this->expect(max(a, b), [](double x, double y) { return x < y ? y : x; });
  this->expect(expm1(-abs(b)), [](double, double y) { return std::expm1(-std::abs(y)); });
  TypeParam c = a;
  c += b, c -= 2., c *= a, c /= 4.;
  this->expect(c, [](double x, double y) { return (x + y - 2) * x / 4; });
}

TYPED_TEST(PackOf, ChoosesByWhatIsSoOfEachRun) {
  const TypeParam a = this->numbers(0), b = this->numbers(3);
  const auto check = [&](const auto& compare) {
    this->expect(select(compare(a, b), a, TypeParam(9)),
                 [&](double x, double y) { return compare(x, y) ? x : 9.; });
  };
  check([](const auto& x, const auto& y) { return x < y; });
  check([](const auto& x, const auto& y) { return x <= y; });
  check([](const auto& x, const auto& y) { return x > y; });
  check([](const auto& x, const auto& y) { return x >= y; });
  check([](const auto& x, const auto& y) { return x == y; });
  check([](const auto& x, const auto& y) { return x != y; });
  this->expect(select((a < b) & !(a == b), a, b), [](double x, double y) { return x < y ? x : y; });
  this->expect(select((a < b) | (b < a), a, TypeParam(9)),
               [](double x, double y) { return x != y ? x : 9; });
}

TYPED_TEST(PackOf, AllAndAnyLookAtEveryRun) {
  for (int i = 0; i < this->W; ++i) {
    TypeParam a = 1;
    EXPECT_TRUE(all(a > 0.) && !any(a < 0.));
    a.set(i, -1);
    EXPECT_TRUE(!all(a > 0.) && any(a < 0.)) << "run " << i;
    a.set(i, std::numeric_limits<double>::quiet_NaN());
    EXPECT_TRUE(!all(a > 0.) && !any(a < 0.) && any(a != a)) << "run " << i;
  }
}

TYPED_TEST(PackOf, SinesAndTanhAreThoseOfEachRun) {
  TypeParam x;
  for (int i = 0; i < this->W; ++i) x.set(i, 1.7 * i - 4);
  Vec<1, TypeParam> s, c;
  sin_cos(Vec<1, TypeParam>(x), s, c);
  for (int i = 0; i < this->W; ++i) {
    EXPECT_NEAR(s[0][i], std::sin(x[i]), 3e-16);
    EXPECT_NEAR(c[0][i], std::cos(x[i]), 3e-16);
    EXPECT_NEAR(tanh(x)[i], std::tanh(x[i]), 1e-15);
  }
}

}  // namespace
}  // namespace tauext::test

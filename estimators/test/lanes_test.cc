// SPDX-License-Identifier: Apache-2.0
#include "estimators/math/lanes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimators/math/block.h"

namespace tauext::test {
namespace {

// registers of both lengths, where this build has both
template <class L>
class LanesOf : public testing::Test {};
#ifdef __AVX__
using Lengths = testing::Types<detail::BasicLanes<2>, detail::BasicLanes<4>>;
#else
using Lengths = testing::Types<detail::BasicLanes<2>>;
#endif
TYPED_TEST_SUITE(LanesOf, Lengths);

template <class L>
void expect(const L& x, double a, double b, double c, double d) {
  const double wanted[] = {a, b, c, d};
  for (int i = 0; i < 4; ++i) EXPECT_EQ(x[i], wanted[i]) << "lane " << i;
}

TYPED_TEST(LanesOf, AreComputedWithOneByOne) {
  using L = TypeParam;
  static_assert(sizeof(L) == 4 * sizeof(double) && alignof(L) == sizeof(L));
  const L a(1, 2, -3, 4), b(2, 0.5, 4, -8);
  expect(a + b, 3, 2.5, 1, -4);
  expect(a - b, -1, 1.5, -7, 12);
  expect(2 * a * b, 4, 2, -24, -64);
  expect(a / b, 0.5, 4, -0.75, -0.5);
  expect(-a, -1, -2, 3, -4);
  L c = a;
  c.set(2, 7);
  expect(c, 1, 2, 7, 4);
  double memory[] = {0, 5, 6, 7, 8, 0};
  expect(L::load(memory + 1), 5, 6, 7, 8);
  a.store(memory + 2);
  expect(L::load(memory + 2), 1, 2, -3, 4);
  EXPECT_EQ(memory[1], 5);
}

TYPED_TEST(LanesOf, LesserAndGreaterKeepWhatIsNoNumber) {
  using L = TypeParam;
  expect(min(L(1, 5, 2, -0.5), L(2)), 1, 2, 2, -0.5);
  expect(max(L(1, 5, 2, -0.5), L(2)), 2, 5, 2, 2);
  EXPECT_TRUE(std::isnan(min(L(std::nan("")), L(2))[3]));
  EXPECT_TRUE(std::isnan(max(L(std::nan("")), L(2))[3]));
}

TYPED_TEST(LanesOf, PowersOfTwoAreExact) {
  constexpr double kRound = 0x1.8p+52;
  expect(power_of_two(TypeParam(kRound, kRound - 1022, kRound + 1022, kRound + 5)), 1, 0x1p-1022,
         0x1p+1022, 32);
}

TYPED_TEST(LanesOf, TurnIntoRows) {
  using L = TypeParam;
  L c[] = {{0, 1, 2, 3}, {4, 5, 6, 7}, {8, 9, 10, 11}, {12, 13, 14, 15}};
  turn(c[0], c[1], c[2], c[3]);
  for (int i = 0; i < 4; ++i) expect(c[i], i, i + 4, i + 8, i + 12);
}

template <int N>
void blocks_are_matrices() {
  using detail::Block;
  const Mat<N> A = Mat<N>::Random(), B = Mat<N>::Random(), C = Mat<N>::Random();
  const Vec<N> x = Vec<N>::Random(), y = Vec<N>::Random();
  const auto a = Block<N>::from(A), b = Block<N>::from(B), c = Block<N>::from(C);
  const auto u = detail::Column<N>::template from<N>(x), v = detail::Column<N>::template from<N>(y);
  EXPECT_EQ(a.matrix(), A);
  EXPECT_EQ(a(N - 1, 0), A(N - 1, 0));
  EXPECT_EQ(transposed(a).matrix(), A.transpose());
  EXPECT_EQ(Block<N>::diagonal(x).matrix(), Mat<N>(x.asDiagonal()));
  Block<N> sum = c;
  sum.add(b);
  EXPECT_EQ(sum.matrix(), C + B);
  detail::products<detail::Into::kSet, 1>({&a, &c}, {&b, &a}, sum);  // A B^T + C A
  EXPECT_LT((sum.matrix() - A * B.transpose() - C * A).norm(), 1e-14 * N);
  detail::products<detail::Into::kAdd>({&b}, {&b}, sum);
  detail::products<detail::Into::kSubtract>({&a}, {&c}, sum);
  EXPECT_LT((sum.matrix() - A * B.transpose() - C * A - B * B + A * C).norm(), 1e-14 * N);
  sum = a;
  sum.subtract(u, v);
  EXPECT_LT((sum.matrix() - A + x * y.transpose()).norm(), 1e-15 * N);
  sum = Block<N>::zero();
  sum.subtract_square(u, 3);
  EXPECT_LT((sum.matrix() + 3 * x * x.transpose()).norm(), 1e-15 * N);
  EXPECT_EQ(sum.matrix(), sum.matrix().transpose()) << "to the last bit";
  for (const auto& column : sum.column) {
    for (int i = N; i < detail::kPadded<N>; ++i) EXPECT_EQ(column[i], 0);
  }
}

TEST(Block, IsAMatrixInLanes) {
  blocks_are_matrices<1>();
  blocks_are_matrices<2>();
  blocks_are_matrices<3>();
  blocks_are_matrices<4>();
  blocks_are_matrices<6>();
  blocks_are_matrices<8>();
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "estimators/math/ldlt.h"

#include <gtest/gtest.h>

#include <limits>

namespace tauext::test {
namespace {

template <int N>
void solves_exactly() {
  for (int i = 0; i < 50; ++i) {
    const Mat<N> A = Mat<N>::Random();
    const Mat<N> B = A * A.transpose() + 0.1 * Mat<N>::Identity();
    const Ldlt<N> factor(B);
    ASSERT_TRUE(factor.ok());
    const Vec<N> b = Vec<N>::Random();
    EXPECT_LT((B * factor.solve(b) - b).norm(), 1e-11) << "condition number up to 1e3";
    EXPECT_LT((B * factor.solve(Mat<N>(Mat<N>::Identity())) - Mat<N>::Identity()).norm(), 1e-11);
    EXPECT_LT((B * factor.minus_inverse().matrix() + Mat<N>::Identity()).norm(), 1e-11);
    if constexpr (Ldlt<N>::kLanes) {
      const Ldlt<N> lanes(detail::Block<N>::from(B));
      ASSERT_TRUE(lanes.ok());
      EXPECT_LT((B * lanes.solve(b) - b).norm(), 1e-11);
      EXPECT_LT((B * lanes.minus_inverse().matrix() + Mat<N>::Identity()).norm(), 1e-11);
    }
  }
}

TEST(Ldlt, SolvesWhatItFactorised) {
  solves_exactly<1>();
  solves_exactly<3>();
  solves_exactly<5>();
  solves_exactly<7>();
  solves_exactly<8>();
}

TEST(Ldlt, SaysSoWhenAMatrixIsNotPositiveDefinite) {
  for (int i = 0; i < 6; ++i) {
    Mat<6> wide = Mat<6>::Identity();
    wide(i, i) = i % 2 == 0 ? -1 : std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(Ldlt<6>(wide).ok());
    EXPECT_FALSE(Ldlt<6>(detail::Block<6>::from(wide)).ok());
  }
  Mat<3> B = Mat<3>::Identity();
  B(2, 2) = -1;
  EXPECT_FALSE(Ldlt<3>(B).ok());
  EXPECT_FALSE(Ldlt<3>(Mat<3>::Zero()).ok());
  B(2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(Ldlt<3>(B).ok());
}

}  // namespace
}  // namespace tauext::test

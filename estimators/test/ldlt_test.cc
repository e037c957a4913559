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
  }
}

TEST(Ldlt, SolvesWhatItFactorised) {
  solves_exactly<1>();
  solves_exactly<3>();
  solves_exactly<7>();
}

TEST(Ldlt, SaysSoWhenAMatrixIsNotPositiveDefinite) {
  Mat<3> B = Mat<3>::Identity();
  B(2, 2) = -1;
  EXPECT_FALSE(Ldlt<3>(B).ok());
  EXPECT_FALSE(Ldlt<3>(Mat<3>::Zero()).ok());
  B(2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(Ldlt<3>(B).ok());
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/joint_fit.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <string>

namespace tauext::test {
namespace {

// theta is beyond what a joint can have; the oracle is QR of the columns that are left
TEST(JointFit, WhatIsHeldIsHeldAndTheOthersAreFittedAgain) {
  constexpr int m = 400;
  JointRows rows;
  rows.terms.resize(m, 5), rows.others.resize(m, 0);
  rows.rigid = rows.measured = Eigen::VectorXd::Zero(m);
  for (int i = 0; i < m; ++i) {
    const double t = 0.1 * i, qd = std::cos(t) + 0.4 * std::cos(2.7 * t), s = qd > 0 ? 1 : -1;
    const double noise = 0.3 * std::sin(37. * i * i);
    rows.terms.row(i) << -std::sin(t) - 1.08 * std::sin(2.7 * t), s, qd, std::abs(qd), 1;
    rows.rigid[i] = 5 * std::sin(0.3 * t);
    rows.measured[i] = rows.rigid[i] + 2 * s - 0.01 * rows.terms(i, 0) + 1.5 * qd +
                       1.55 * std::abs(qd) + 0.2 + noise;
  }
  rows.term_instruments = rows.terms, rows.rigid_instrument = rows.rigid;
  const CalibratedJoint j =
      calibrated_joint(rows, {"armature", "coulomb", "viscous", "viscous_skew", "offset"}, false);
  ASSERT_EQ(j.held.size(), 2u);
  EXPECT_TRUE(j.doubts.empty());
  Eigen::MatrixXd A(m, 3);  // coulomb, viscous with as much skew, offset
  A << rows.terms.col(1), rows.terms.col(2) + rows.terms.col(3), rows.terms.col(4);
  const Eigen::VectorXd y = rows.measured - rows.rigid;
  const Eigen::Vector3d theta = A.colPivHouseholderQr().solve(y);
  const double expected[] = {0, theta[0], theta[1], theta[1], theta[2]};
  for (std::size_t k = 0; k < 5; ++k)
    EXPECT_NEAR(j.terms[k].value, expected[k], 1e-9) << j.terms[k].name;
  EXPECT_NEAR(j.after, (y - A * theta).norm() / std::sqrt(m), 1e-9);
}

}  // namespace
}  // namespace tauext::test

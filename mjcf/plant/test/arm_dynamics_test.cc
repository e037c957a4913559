// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/test/arm_dynamics.h"

#include <gtest/gtest.h>

#include <random>

#include "estimators/testbed1.h"
#include "estimators/wallmobot3.h"

namespace tauext {
namespace {

// the closed form is the oracle: it was made from the paper, not from MuJoCo
TEST(ArmDynamicsTest, TermsAreThoseOfTheClosedForm) {
  const MjcfArm<3> arm(load_robot("wallmobot3"));
  const WallMoBot3 closed;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  for (int i = 0; i < 300; ++i) {
    const Vec<3> q = Vec<3>::NullaryExpr([&] { return uniform(random); });
    const Vec<3> qd = Vec<3>::NullaryExpr([&] { return uniform(random); });
    const double scale = closed.bias(q, qd).norm() + 100;  // [N m]
    EXPECT_LT((arm.inertia(q) - closed.inertia(q)).norm(), 1e-9 * closed.inertia(q).norm());
    EXPECT_LT((arm.bias(q, qd) - closed.bias(q, qd)).norm(), 1e-9 * scale);
    EXPECT_LT((arm.gravity(q) - closed.gravity(q)).norm(), 1e-9 * scale);
    // differences of fourth order, 0.01 rad wide
    EXPECT_LT((arm.momentum_bias(q, qd) - closed.momentum_bias(q, qd)).norm(), 1e-7 * scale);
    EXPECT_EQ(arm.friction(qd), Vec<3>::Zero());
  }
}

TEST(ArmDynamicsTest, MomentumBiasAtRestIsMinusGravity) {
  const MjcfArm<3> arm(load_robot("wallmobot3"));
  const Vec<3> q(0.3, -0.2, 0.1);
  EXPECT_EQ(arm.momentum_bias(q, Vec<3>::Zero()), -arm.gravity(q));
}

TEST(ArmDynamicsTest, FrictionIsTheFilesOwn) {
  const MjcfArm<1> arm(load_robot("testbed1"));
  EXPECT_NEAR(arm.friction(Vec<1>(1))[0], Testbed1::Parameters().theta4, 1e-9);
  EXPECT_NEAR(arm.friction(Vec<1>(-1))[0], -Testbed1::Parameters().theta4, 1e-9);
  EXPECT_EQ(arm.friction(Vec<1>(0))[0], 0);
}

TEST(ArmDynamicsTest, CopiesDoNotDisturbEachOther) {
  const MjcfArm<3> arm(load_robot("wallmobot3"));
  const MjcfArm<3> copy = arm;
  const Vec<3> q(0.3, -0.2, 0.1), qd(1, 2, 3);
  const Vec<3> before = arm.bias(q, qd);
  copy.bias(qd, q);
  EXPECT_EQ(arm.bias(q, qd), before);
}

}  // namespace
}  // namespace tauext

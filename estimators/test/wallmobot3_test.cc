// SPDX-License-Identifier: Apache-2.0
// B, C qd and g themselves are checked against MuJoCo in mjcf/test/wallmobot3_test.cc; here is what
// must hold between them.
#include "estimators/wallmobot3.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "estimators/test/precise.h"
#include "estimators/test/random_states.h"

namespace tauext::test {
namespace {

using WallMoBot3Test = RandomStates;

TEST_F(WallMoBot3Test, BdotMinusTwoCIsSkew) {
  const WallMoBot3 arm;
  for (int i = 0; i < 200; ++i) {
    const Vec<3> q = vector(3), qd = vector(2);
    // Bdot by a central difference along qd, whose error is of order h^2 = 1e-10
    const double h = 1e-5;
    const Mat<3> Bdot = (arm.inertia(q + h * qd) - arm.inertia(q - h * qd)) / (2 * h);
    const Mat<3> N = Bdot - 2 * arm.coriolis(q, qd);
    EXPECT_LT((N + N.transpose()).cwiseAbs().maxCoeff(), 1e-6) << "N m s, of terms up to 400";
    // and exactly the Christoffel form: Bdot = C + C^T
    const Mat<3> C = arm.coriolis(q, qd);
    EXPECT_LT((Bdot - C - C.transpose()).cwiseAbs().maxCoeff(), 1e-6);
  }
}

TEST_F(WallMoBot3Test, BiasIsCoriolisTimesVelocityPlusGravity) {
  const WallMoBot3 arm;
  for (int i = 0; i < 200; ++i) {
    const Vec<3> q = vector(3), qd = vector(2);
    const Mat<3> C = arm.coriolis(q, qd);
    const double scale = arm.bias(q, qd).norm();
    EXPECT_LT((arm.bias(q, qd) - C * qd - arm.gravity(q)).norm(), 1e-13 * scale);
    EXPECT_LT((arm.momentum_bias(q, qd) - C.transpose() * qd + arm.gravity(q)).norm(),
              1e-13 * scale);
    const Dynamics<3> d = dynamics(arm, q, qd);
    EXPECT_EQ(d.B, arm.inertia(q));
    EXPECT_LT((d.bias - arm.bias(q, qd)).norm(), 1e-13 * scale);
  }
}

TEST_F(WallMoBot3Test, InertiaIsPositiveDefiniteForEveryPanelOfThePaper) {
  for (const double panel : {0., 50., 150.}) {
    const WallMoBot3 arm(WallMoBot3::Parameters::with_panel(panel));
    for (int i = 0; i < 300; ++i) {
      const Eigen::SelfAdjointEigenSolver<Mat<3>> eigen(arm.inertia(vector(4)));
      EXPECT_GT(eigen.eigenvalues().minCoeff(), 0.01) << "panel " << panel;
    }
  }
}

TEST_F(WallMoBot3Test, JacobiansAgreeWith100DigitDifferences) {
  use_100_digits();
  const Precise h("1e-30");  // a forward difference is then good to 30 digits
  // with friction, too, in whose steepest part the speeds lie
  const auto check = [&]<bool kDry>(std::bool_constant<kDry>) {
    typename BasicWallMoBot3<double, kDry>::Parameters p;
    typename BasicWallMoBot3<Precise, kDry>::Parameters same;
    if constexpr (kDry) {
      p.viscous = same.viscous = Vec<3>(3, 5, 7);
      p.coulomb = same.coulomb = Vec<3>(20, 30, 10);
      p.v_s = same.v_s = 1;
    }
    const BasicWallMoBot3<double, kDry> arm(p);
    const BasicWallMoBot3<Precise, kDry> precise(same);
    for (int i = 0; i < 50; ++i) {
      const Vec<3> q = vector(2), qd = vector(2), u = vector(500);
      const ForwardDynamics<3> f = arm.forward_dynamics(q, qd, u);
      ASSERT_TRUE(f.ok);
      using V = Vec<3, Precise>;
      const V pq = q.cast<Precise>(), pqd = qd.cast<Precise>(), pu = u.cast<Precise>();
      const V qdd = precise.forward_dynamics(pq, pqd, pu).qdd;
      EXPECT_LT((qdd.template cast<double>() - f.qdd).norm(), 1e-12 * f.qdd.norm());
      for (int j = 0; j < 3; ++j) {
        V e = V::Zero();
        e[j] = h;
        const auto column = [&](const V& moved) -> Vec<3> {
          return V((moved - qdd) / h).template cast<double>();
        };
        const Vec<3> by_q = column(precise.forward_dynamics(pq + e, pqd, pu).qdd);
        const Vec<3> by_qd = column(precise.forward_dynamics(pq, pqd + e, pu).qdd);
        const Vec<3> by_u = column(precise.forward_dynamics(pq, pqd, pu + e).qdd);
        EXPECT_LT((by_q - f.dqdd_dq.col(j)).norm(), 1e-11 * f.dqdd_dq.norm());
        EXPECT_LT((by_qd - f.dqdd_dqd.col(j)).norm(), 1e-11 * (1 + f.dqdd_dqd.norm()));
        EXPECT_LT((by_u + f.dqdd_dtau_ext.col(j)).norm(), 1e-11 * f.dqdd_dtau_ext.norm());
      }
    }
  };
  check(std::false_type());
  check(std::true_type());
}

TEST_F(WallMoBot3Test, DryFrictionWantsTheDryArm) {
  WallMoBot3::Parameters p;
  p.coulomb << 1, 0, 0;
  EXPECT_THROW(WallMoBot3{p}, std::invalid_argument);
  DryWallMoBot3::Parameters dry;
  dry.coulomb << 1, 2, 3;
  EXPECT_LT((DryWallMoBot3(dry).friction(Vec<3>(1, -1, 0)) - Vec<3>(1, -2, 0)).norm(), 1e-12);
}

TEST_F(WallMoBot3Test, JacobiansIncludeViscousFriction) {
  WallMoBot3::Parameters p;
  p.viscous << 3, 5, 7;
  const WallMoBot3 arm(p), smooth;
  const Vec<3> q = vector(1), qd = vector(1), u = vector(100);
  const auto with = arm.forward_dynamics(q, qd, u);
  const auto without = smooth.forward_dynamics(q, qd, u - arm.friction(qd));
  EXPECT_LT((with.qdd - without.qdd).norm(), 1e-12 * with.qdd.norm());
  const Mat<3> expected = without.dqdd_dqd + without.dqdd_dtau_ext * Mat<3>(p.viscous.asDiagonal());
  EXPECT_LT((with.dqdd_dqd - expected).norm(), 1e-12 * expected.norm());
}

TEST_F(WallMoBot3Test, EndEffectorStandsWhereTableIPutsIt) {
  // at q = 0 link 4 points forward and link 5 down: the panel's point is 0.93 m below joint 5 and
  // 0.109 + 0.2025 m before it
  const WallMoBot3 arm;
  Mat<3> expected;
  expected << 0.5, -0.93, -0.93,     // vx: link 2 is 0.5 m up, link 5 0.93 m down
      0, -(0.85 + 0.3115), -0.3115,  // vz: positive rotation takes x to -z
      0, 1, 1;                       // pitch
  EXPECT_LT((arm.jacobian(Vec<3>::Zero()) - expected).norm(), 1e-15);
}

}  // namespace
}  // namespace tauext::test

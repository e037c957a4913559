// SPDX-License-Identifier: Apache-2.0
#include "estimators/ndob.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "estimators/test/arm.h"

namespace tauext::test {
namespace {

using ArmNdob = Ndob<WallMoBot3>;

TEST(Ndob, PolesAreTheEigenvaluesOfXOverB) {
  // independently published values at q = 0 with the paper's X
  const Vec<3> X = ArmNdob::Parameters::paper().X;
  const Mat<3> A = X.asDiagonal() * WallMoBot3().inertia(Vec<3>::Zero()).inverse();
  Vec<3> poles = A.eigenvalues().real();
  std::sort(poles.begin(), poles.end());
  EXPECT_NEAR(poles[0], 2.62, 0.005);
  EXPECT_NEAR(poles[1], 12.3, 0.05);
  EXPECT_NEAR(poles[2], 34.8, 0.05);
}

TEST(Ndob, ErrorDecaysAtTheRatesOfXOverB) {
  // the arm held at q = 0: (18) is linear, e' = -A e with A = X B^-1, stepped by either rule
  const WallMoBot3 arm;
  const Vec<3> load(30, -20, 10);
  const double h = 1e-3;
  const Mat<3> I = Mat<3>::Identity();
  const Mat<3> A = Vec<3>(600, 1000, 600).asDiagonal() * arm.inertia(Vec<3>::Zero()).inverse();
  for (const Integration rule : {Integration::kSecondOrder, Integration::kEuler}) {
    ArmNdob::Parameters p = ArmNdob::Parameters::paper();
    p.integration = rule;
    const Mat<3> decay = rule == Integration::kEuler
                             ? Mat<3>(I - h * A)
                             : Mat<3>((I + h / 2 * A).inverse() * (I - h / 2 * A));
    ArmNdob ndob(arm, p);
    Measurement<3> y;
    y.tau = arm.gravity(y.q) + load;  // at rest (3) is tau = g + tau_ext
    Vec<3> error = -load;
    for (int k = 0; k < 2000; ++k) {
      y.t = k * h;
      const Estimate<3> e = ndob.update(y);
      ASSERT_LT((e.tau_ext - load - error).norm(), 1e-9) << "k = " << k;
      error = decay * error;
    }
    EXPECT_LT(error.norm(), 0.2);
  }
}

TEST(Ndob, IsTheVelocityObserverOfItsGain) {
  // r = -X (qd - qd_0 - integral of B^-1 (tau - C qd - g - F - r)), with the sign of (3)
  const WallMoBot3 arm;
  const ArmNdob::Parameters p = ArmNdob::Parameters::paper();
  constexpr double h = 0.1e-3;
  const auto load = [](double t) -> Vec<3> { return Vec<3>(30, -20, 10) * (t < 0.3 ? 0 : 1); };
  ArmNdob ndob(arm, p);
  Vec<3> begun = Vec<3>::Zero(), integral = begun, r = begun, before = begun;
  bool first = true;
  for (const auto& y : simulate(grid(1.5, h), load, {.amplitude = 0.3, .w = 2})) {
    const Vec<3> d = ndob.update(y).tau_ext;
    if (first) begun = y.qd;
    integral += h * before;
    if (!first) r = -p.X.cwiseProduct(y.qd - begun - integral);
    first = false;
    before = arm.inertia(y.q).inverse() * (y.tau - arm.bias(y.q, y.qd) - arm.friction(y.qd) - r);
    ASSERT_LT((d - r).norm(), 0.15) << "N m at t = " << y.t;
  }
  EXPECT_GT(r.norm(), 30);
}

// [N m] rms in free motion
double rms_in_motion(Integration rule) {
  ArmNdob::Parameters p = ArmNdob::Parameters::paper();
  p.integration = rule;
  ArmNdob ndob(WallMoBot3(), p);
  double sum = 0;
  const auto samples = simulate(grid(5, 1e-3), constant(0), {.amplitude = 0.3, .w = 2});
  for (const auto& y : samples) sum += ndob.update(y).tau_ext.squaredNorm();
  return std::sqrt(sum / 3 / static_cast<double>(samples.size()));
}

TEST(Ndob, ThePrintedEulerStepMistakesMotionForALoadAndTheDefaultDoesNot) {
  EXPECT_GT(rms_in_motion(Integration::kEuler), 0.1) << "h/2 B qddd";
  EXPECT_LT(rms_in_motion(Integration::kSecondOrder), 0.001);
}

TEST(Ndob, IsStableForEveryStepOfItsGain) {
  ArmNdob ndob(WallMoBot3(), {.X = Vec<3>::Constant(1e9)});
  Estimate<3> e;
  double worst = 0;
  for (const auto& y : simulate(grid(2, 1e-3), constant(0))) {
    e = ndob.update(y);
    worst = std::max(worst, e.tau_ext.norm());
  }
  EXPECT_LT(worst, 1) << "h lambda = 10^5 differentiates, and that is all";
}

TEST(Ndob, ConvergesToAConstantLoadWithItsOwnSign) {
  ArmNdob ndob(WallMoBot3(), ArmNdob::Parameters::paper());
  Estimate<3> e;
  for (const auto& y : simulate(grid(6, 1e-3), constant(5))) e = ndob.update(y);
  EXPECT_LT((e.tau_ext - Vec<3>::Constant(5)).cwiseAbs().maxCoeff(), 0.1);
}

TEST(Ndob, StartingFromZeroInMotionGivesMinusXQd) {
  // (17) with z_0 = 0, the paper's choice, for an arm that moves: why it is not the default
  ArmNdob::Parameters p = ArmNdob::Parameters::paper();
  p.start = Start::kZero;
  ArmNdob ndob(WallMoBot3(), p);
  Measurement<3> y;
  y.qd.setConstant(0.5);
  EXPECT_EQ(ndob.update(y).tau_ext, Vec<3>(-300, -500, -300));
}

}  // namespace
}  // namespace tauext::test

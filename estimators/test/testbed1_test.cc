// SPDX-License-Identifier: Apache-2.0
#include "estimators/testbed1.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "bench/peers/textbook_ekf.h"
#include "estimators/ekf.h"
#include "estimators/test/precise.h"

namespace tauext::test {
namespace {

using peers::TextbookEkf;

Vec<1> vec(double x) {
  return Vec<1>(x);
}

// (36) with the numbers of (37), as printed
double printed_tau(double q, double qd, double qdd) {
  return 0.41937 * qdd + 11.668 * 9.81 * std::cos(q) - 0.74 * 9.81 * std::sin(q) +
         2.163 * (qd > 0   ? 1
                  : qd < 0 ? -1
                           : 0);
}

TEST(Testbed1, IsEquation36WithTheNumbersOf37) {
  const Testbed1 arm(Testbed1::Parameters::raw_sign());
  for (const double q : {-0.9, -0.2, 0., 0.5, 1.2}) {
    for (const double qd : {-0.7, 0., 0.3}) {
      for (const double qdd : {-5., 0., 2.}) {
        const double tau = (arm.inertia(vec(q)) * qdd)(0, 0) + arm.bias(vec(q), vec(qd))[0] +
                           arm.friction(vec(qd))[0];
        EXPECT_NEAR(tau, printed_tau(q, qd, qdd), 1e-12);
        EXPECT_NEAR(arm.forward_dynamics(vec(q), vec(qd), vec(tau)).qdd[0], qdd, 1e-11);
      }
    }
  }
}

TEST(Testbed1, WithGAbsorbedAFirstMomentOf3Point4KgSuffices) {
  // a point mass m at distance d has the least inertia m d^2 of its first moment m d
  const auto lightest = [](const Testbed1::Parameters& p) {
    const double moment = std::hypot(p.theta2, p.theta3) * p.g / kGravity;
    return moment * moment / p.theta1;
  };
  EXPECT_NEAR(lightest(Testbed1::Parameters()), 326, 1);
  EXPECT_NEAR(lightest(Testbed1::Parameters::absorbed()), 3.4, 0.05);
}

TEST(Testbed1, JacobiansAreTheDifferencesOfItsAcceleration) {
  const Testbed1 arm;
  constexpr double kStep = 1e-6;
  for (const double q : {-0.4, 0.5}) {
    for (const double qd : {-0.2, -0.004, 0., 0.003, 0.6}) {
      const auto qdd = [&](double dq, double dqd, double du) {
        return arm.forward_dynamics(vec(q + dq), vec(qd + dqd), vec(100 + du)).qdd[0];
      };
      const auto f = arm.forward_dynamics(vec(q), vec(qd), vec(100));
      // central differences: h^2 / 6 of the third derivative, and round-off of 100 N m / theta_1 /
      // h
      EXPECT_NEAR(f.dqdd_dq(0, 0), (qdd(kStep, 0, 0) - qdd(-kStep, 0, 0)) / (2 * kStep), 1e-6);
      EXPECT_NEAR(f.dqdd_dqd(0, 0), (qdd(0, kStep, 0) - qdd(0, -kStep, 0)) / (2 * kStep), 1e-4);
      EXPECT_NEAR(f.dqdd_dtau_ext(0, 0), -(qdd(0, 0, kStep) - qdd(0, 0, -kStep)) / (2 * kStep),
                  1e-6);
    }
  }
}

TEST(CoulombFriction, SmoothedItIsTheSignAwayFromStandstill) {
  const CoulombFriction smooth{2.163, 0.005}, sign{2.163, 0};
  for (const double qd : {-1., -0.1, 0.1, 1.}) {
    EXPECT_NEAR(smooth.torque(qd), sign.torque(qd), 1e-12);
  }
  EXPECT_EQ(smooth.torque(0), 0);
  EXPECT_EQ(sign.torque(0), 0);
  EXPECT_NEAR(smooth.torque(0.005), 2.163 * std::tanh(1), 1e-12);
}

TEST(CoulombFriction, AtStandstillSignChattersByTwiceItsLevelAndTheSmoothOneByTheNoise) {
  const CoulombFriction smooth{2.163, 0.005}, sign{2.163, 0};
  for (const double round_off : {1e-17, -1e-17}) {
    EXPECT_EQ(std::abs(sign.torque(round_off)), 2.163);
    EXPECT_LT(std::abs(smooth.torque(round_off)), 1e-13);
  }
}

// (36) smoothed, in 100 digits, written anew
struct PreciseTestbed {
  static constexpr int kDof = 1;
  using V = Vec<1, Precise>;
  ForwardDynamics<1, Precise> forward_dynamics(const V& q, const V& qd, const V& u) const {
    const Precise b = 1 / Precise(0.41937), level(2.163), g(9.81);
    const Precise th = tanh(qd[0] / Precise(0.005));
    ForwardDynamics<1, Precise> f;
    f.qdd[0] = b * (u[0] - level * th - g * (11.668 * cos(q[0]) - 0.74 * sin(q[0])));
    f.dqdd_dq(0, 0) = b * g * (11.668 * sin(q[0]) + 0.74 * cos(q[0]));
    f.dqdd_dqd(0, 0) = -b * level * (1 - th * th) / Precise(0.005);
    f.dqdd_dtau_ext(0, 0) = -b;
    f.ok = true;
    return f;
  }
};

TEST(EkfOfTestbed1, WithThePrintedCovariancesAgreesWith100DigitArithmetic) {
  // R = diag(1e-20, 1e-17) and Q = diag(1e-14, 1e-14, 1e-2): sixteen orders apart, and harmless
  using E = Ekf<Testbed1>;
  use_100_digits();
  E ekf(Testbed1(), E::Parameters::paper());
  TextbookEkf<Precise, PreciseTestbed> precise(E::Parameters::paper());
  double worst = 0;
  for (int k = 0; k < 2000; ++k) {
    const double t = k * 1e-3;
    const Measurement<1> y{t, vec(0.3 * std::sin(3 * t)), vec(0.9 * std::cos(3 * t)),
                           vec(100 + 20 * std::sin(5 * t))};
    const double ours = ekf.update(y).tau_ext[0];
    worst = std::max(worst, std::abs(ours - precise.update(y).tau_ext[0]));
  }
  EXPECT_LT(worst, 1e-9) << "N m";
}

TEST(Testbed1, RefusesParametersOutOfRange) {
  Testbed1::Parameters p;
  p.theta1 = 0;
  EXPECT_THROW(Testbed1{p}, std::invalid_argument);
  p = {};
  p.v_s = -1;
  EXPECT_THROW(Testbed1{p}, std::invalid_argument);
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "mjcf/record.h"

#include <gtest/gtest.h>

#include <chrono>
#include <numbers>

#include "estimators/wallmobot3.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

using Eigen::MatrixXd;

class EveryScenario : public testing::TestWithParam<std::string> {};

// (3) with MuJoCo's acceleration and the closed form's B and bias, which know nothing of each other
TEST_P(EveryScenario, ObeysEquationThreeAtEverySample) {
  const Trace t = record(load_robot("wallmobot3"), scenario(GetParam()));
  ASSERT_EQ(t.size(), 30000);
  const WallMoBot3 arm;
  double worst = 0;
  for (int k = 0; k < t.size(); ++k) {
    const Vec<3> q = t.q.col(k), qd = t.qd.col(k), qdd = t.qdd.col(k);
    const Vec<3> residual = arm.inertia(q) * qdd + arm.bias(q, qd) + Vec<3>(t.friction.col(k)) +
                            Vec<3>(t.tau_ext.col(k)) - Vec<3>(t.tau.col(k));
    worst = std::max(worst, residual.cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst, 1e-9 * t.tau.cwiseAbs().maxCoeff())
      << "largest torque " << t.tau.cwiseAbs().maxCoeff();
}

TEST_P(EveryScenario, IsBitIdenticalWhenRepeated) {
  const Model m = load_robot("wallmobot3");
  Scenario s = scenario(GetParam());
  s.duration = 6;
  const Trace a = record(m, s), b = record(m, s);
  EXPECT_EQ(a.q, b.q);
  EXPECT_EQ(a.tau, b.tau);
  EXPECT_EQ(a.tau_ext, b.tau_ext);
}

// tau is held, so a finer integration of each sample must converge: RK4's error falls 16-fold when its
// step is halved. At 1 ms nothing is left of it but round-off, so the rate is taken at 20 ms
TEST_P(EveryScenario, ConvergesWithTheStepSize) {
  const Model m = load_robot("wallmobot3");
  Scenario s = scenario(GetParam());
  s.duration = 6;
  const auto run = [&](double Ts, int substeps) {
    return record(m, s, {}, {.Ts = Ts, .substeps = substeps}).q;
  };
  const MatrixXd one = run(0.02, 1), two = run(0.02, 2), four = run(0.02, 4);
  const double coarse = (one - two).cwiseAbs().maxCoeff();
  const double fine = (two - four).cwiseAbs().maxCoeff();
  EXPECT_GT(coarse / fine, 8) << coarse << " rad, then " << fine;
  EXPECT_LT((run(1e-3, 1) - run(1e-3, 2)).cwiseAbs().maxCoeff(), 1e-11) << "rad";
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const Scenario& s : scenarios()) all.push_back(s.name);
  return all;
}
INSTANTIATE_TEST_SUITE_P(Scenarios, EveryScenario, testing::ValuesIn(names()),
                         [](const auto& i) { return i.param; });

TEST(Record, SampleKHoldsTheTorqueOfTheIntervalThatFollows) {
  // momentum over [t_k, t_k+1) by the trapezium of B qdd's other terms: closes with tau_k and
  // tau_ext_k (error of order h^2), and opens by h dtau/dt with tau_k+1
  const Trace t = record(load_robot("wallmobot3"), scenario("in_motion"));
  const WallMoBot3 arm;
  double held = 0, late = 0;
  for (int k = 0; k + 1 < 5000; ++k) {
    const double h = t.t[k + 1] - t.t[k];
    const auto momentum = [&](int i) -> Vec<3> { return arm.inertia(t.q.col(i)) * t.qd.col(i); };
    const auto other = [&](int i) -> Vec<3> { return arm.momentum_bias(t.q.col(i), t.qd.col(i)); };
    const Vec<3> rate = (momentum(k + 1) - momentum(k)) / h - 0.5 * (other(k) + other(k + 1)) +
                        Vec<3>(t.tau_ext.col(k));
    held = std::max(held, (rate - t.tau.col(k)).norm());
    late = std::max(late, (rate - t.tau.col(k + 1)).norm());
  }
  EXPECT_LT(held, 0.01);
  EXPECT_GT(late, 0.5);
}

TEST(Record, AppliesTheScenariosLoadAndMarksItsCollision) {
  const Trace t = record(load_robot("wallmobot3"), scenario("collision"));
  const WallMoBot3 arm;
  for (const int k : {4999, 5000, 5007, 5019, 5020}) {
    const double s = t.t[k];
    const bool hit = k >= 5000 && k < 5020;
    EXPECT_EQ(t.contact[k], hit) << k;
    const double fx = hit ? -200 * std::sin(std::numbers::pi * (s - 5) / 0.02) : 0;
    const Vec<3> expected = Vec<3>::Constant(5 * std::sin(s / 2)) -
                            arm.jacobian(t.q.col(k)).transpose() * Vec<3>(fx, 0, 0);
    EXPECT_LT((t.tau_ext.col(k) - expected).norm(), 1e-9) << k;
  }
}

TEST(Record, TracksItsReference) {
  const Trace t = record(load_robot("wallmobot3"), scenario("free"));
  double worst = 0;
  for (int k = 2000; k < t.size(); ++k) {
    worst = std::max(worst, (t.q.col(k).array() - 0.1 * std::sin(t.t[k])).abs().maxCoeff());
  }
  EXPECT_LT(worst, 1e-4) << "rad; the held torque leaves h / 2 of delay";
}

TEST(Record, TakesLessThanASecondFor30Seconds) {
  const Model m = load_robot("wallmobot3");
  const auto start = std::chrono::steady_clock::now();
  record(m, scenario("sine"));
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
#ifdef NDEBUG
  EXPECT_LT(took.count(), 1);
#else
  EXPECT_LT(took.count(), 30) << "unoptimised or with sanitizers";
#endif
}

TEST(Record, RefusesARecordingOutOfRange) {
  const Model m = load_robot("wallmobot3");
  EXPECT_NE(error_of([&] { record(m, scenario("free"), {}, {.Ts = 0}); }).find("sampling time 0 s"),
            std::string::npos);
  EXPECT_NE(
      error_of([&] { record(m, scenario("free"), {}, {.tracking = {.Kp = -1}}); }).find("Kp = -1"),
      std::string::npos);
}

TEST(Record, AnUnstableRunIsAnErrorThatNamesItsCause) {
  const Recording stiff{.tracking = {.Kp = 1e6, .Kd = 1e4}};
  const std::string error =
      error_of([&] { record(load_robot("wallmobot3"), scenario("free"), {}, stiff); });
  EXPECT_NE(error.find("scenario free: MuJoCo warned at t = "), std::string::npos) << error;
  EXPECT_NE(error.find("Kp = 1000000 1/s^2, Kd = 10000 1/s"), std::string::npos) << error;
}

TEST(Scenarios, AnUnknownNameListsTheKnownOnes) {
  EXPECT_EQ(error_of([] { scenario("dance"); }),
            "unknown scenario 'dance'; known: free, step, ramp, sine, collision, in_motion");
}

}  // namespace
}  // namespace tauext::test

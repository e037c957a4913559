// SPDX-License-Identifier: Apache-2.0
#include "estimators/ekf.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bench/peers/textbook_ekf.h"
#include "estimators/test/arm.h"
#include "estimators/test/precise.h"
#include "estimators/test/random_tree.h"
#include "estimators/testbed1.h"

namespace tauext::test {
namespace {

using peers::TextbookEkf;

using ArmEkf = Ekf<WallMoBot3>;

Vec<3> sine_load(double t) {
  return Vec<3>::Constant(10 * std::sin(t) - 5);
}

// (32) in both integrations, and honest noise that scales with the step
std::vector<ArmEkf::Parameters> parameter_sets() {
  std::vector<ArmEkf::Parameters> sets(2, ArmEkf::Parameters::paper());
  sets[1].integration = Integration::kEuler;
  sets.push_back(ArmEkf::Parameters::honest());
  return sets;
}

TEST(Ekf, AgreesWithTheDenseTextbookFormFor30SecondsAndPStaysSymmetric) {
  const auto samples = simulate(grid(30, 1e-3), sine_load);
  for (const auto& p : parameter_sets()) {
    ArmEkf ekf(WallMoBot3(), p);
    TextbookEkf<double> textbook(p);
    double worst = 0;
    for (const auto& y : samples) {
      const Estimate<3> e = ekf.update(y), t = textbook.update(y);
      ASSERT_LE(e.status, Status::kStarted);
      worst = std::max(worst, (e.tau_ext - t.tau_ext).cwiseAbs().maxCoeff());
      const Mat<9> P = ekf.covariance();
      ASSERT_TRUE(P.allFinite());
      ASSERT_EQ(P, P.transpose()) << "t = " << y.t;
      ASSERT_GE(P.diagonal().minCoeff(), 0);
    }
    EXPECT_LT(worst, 1e-9) << "N m";
    EXPECT_LT((ekf.covariance() - textbook.P).norm(), 1e-9 * textbook.P.norm());
  }
}

// the blocks of more than four joints take whole registers, and learn from all of q, or qd, at once
template <int N>
void expect_textbook_on_a_tree() {
  SCOPED_TRACE(std::to_string(N) + " joints");
  RandomTree<N> random(N);
  const auto arm = random.template model<double>();
  EkfParameters<N> p;
  p.P0.setConstant(1e-3);
  p.Q.setConstant(1e-12);
  p.R << Vec<N>::Constant(1e-10), Vec<N>::Constant(1e-6);
  p.Q_load = 25;
  p.Ts = 2e-3;
  Ekf<TreeModel<N>> ekf(arm, p);
  auto smooth = arm.parameters();  // dry friction is part of tau
  for (TreeJoint& j : smooth.joints) j.dry = j.viscous_skew = 0;
  TextbookEkf<double, TreeModel<N>> textbook(p, TreeModel<N>(smooth));
  const Vec<N> middle = random.template vector<N>(1), load = random.template vector<N>(5);
  const auto sample = [&](int k) {
    const double t = 1e-3 * k, w = 3;
    Measurement<N> y;
    y.t = t;
    y.q = middle + Vec<N>::Constant(0.2 * std::sin(w * t));
    y.qd = Vec<N>::Constant(0.2 * w * std::cos(w * t));
    y.tau = arm.inertia(y.q) * Vec<N>::Constant(-0.2 * w * w * std::sin(w * t)) +
            arm.bias(y.q, y.qd) + arm.friction(y.qd) + load;
    return y;
  };
  double worst = 0;
  for (int k = 0; k < 1000; ++k) {
    const Measurement<N> y = sample(k);
    Measurement<N> without_dry = y;
    without_dry.tau -= 0.5 * (arm.dry_friction(y.qd) + arm.dry_friction(sample(k + 1).qd));
    const Estimate<N> e = ekf.update(y), exact = textbook.update(without_dry);
    worst = std::max(worst, (e.tau_ext - exact.tau_ext).cwiseAbs().maxCoeff());
    const Mat<3 * N> P = ekf.covariance();
    ASSERT_EQ(P, P.transpose()) << "t = " << y.t;
  }
  EXPECT_LT((textbook.x.template tail<N>() - load).norm(), 0.1 * load.norm()) << "it works";
  EXPECT_LT(worst, 1e-8 * load.norm()) << "N m";
  EXPECT_LT((ekf.covariance() - textbook.P).norm(), 1e-9 * textbook.P.norm());
}

TEST(Ekf, AgreesWithTheDenseTextbookFormOnTreesOf2And7Joints) {
  expect_textbook_on_a_tree<2>();  // a size more takes half a minute to compile
  expect_textbook_on_a_tree<7>();
}

// of a load at 0.2 s on a joint that was stuck, by dry friction [N m]: by how much of it the
// estimate exceeds it, at most, and when that reaches 90 % [s]
struct StepAnswer {
  double overshoot = 0, rise = INFINITY;
};
StepAnswer answer_to_a_step(double dry) {
  TreeJoint rotor;
  rotor.axis = Vec<3>::UnitY();
  rotor.armature = 0.3;
  rotor.viscous = 0.4;
  rotor.dry = dry;
  const TreeModel<1> arm({{rotor}, {0, 0, 0}});
  Ekf<TreeModel<1>> ekf(arm, EkfParameters<1>::for_bandwidth(arm, 30));
  constexpr double kLoad = 5, kFine = 1e-5;
  Measurement<1> y;
  StepAnswer answer;
  for (int k = 0; k < 2000; ++k) {
    y.t = 1e-3 * k;
    y.tau = Vec<1>(-50 * y.q[0] - 2 * y.qd[0]);
    const double share = ekf.update(y).tau_ext[0] / kLoad;
    answer.overshoot = std::max(answer.overshoot, share - 1);
    if (share > 0.9) answer.rise = std::min(answer.rise, y.t - 0.2);
    for (int i = 0; i < 100; ++i) {
      const Vec<1> u(y.tau[0] - (k < 200 ? 0 : kLoad));
      y.qd += kFine * arm.forward_dynamics(y.q, y.qd, u).qdd;
      y.q += kFine * y.qd;
    }
  }
  return answer;
}

TEST(Ekf, AnswersAStepWithDryFrictionAsWithout) {
  const StepAnswer smooth = answer_to_a_step(0), dry = answer_to_a_step(2);
  EXPECT_LT(smooth.overshoot, 0.06);
  EXPECT_LT(dry.overshoot, 0.06);
  EXPECT_LT(smooth.rise, 0.12);
  EXPECT_NEAR(dry.rise, smooth.rise, 0.005);
}

TEST(Ekf, AgreesWith100DigitArithmeticOn200Samples) {
  use_100_digits();
  for (const auto& p : parameter_sets()) {
    ArmEkf ekf(WallMoBot3(), p);
    TextbookEkf<Precise> precise(p);
    for (const auto& y : simulate(grid(0.2, 1e-3), sine_load)) {
      const Estimate<3> e = ekf.update(y), exact = precise.update(y);
      ASSERT_LT((e.tau_ext - exact.tau_ext).cwiseAbs().maxCoeff(), 1e-9) << "N m at t = " << y.t;
      ASSERT_LT((ekf.state() - precise.x.cast<double>()).cwiseAbs().maxCoeff(), 1e-9);
    }
  }
}

// [N m] rms in free motion
double rms_in_motion(const ArmEkf::Parameters& p) {
  ArmEkf ekf(WallMoBot3(), p);
  double sum = 0;
  const auto samples = simulate(grid(5, 1e-3), constant(0), {.amplitude = 0.3, .w = 2});
  for (const auto& y : samples) sum += ekf.update(y).tau_ext.squaredNorm();
  return std::sqrt(sum / 3 / static_cast<double>(samples.size()));
}

TEST(Ekf, ThePrintedEulerStepMistakesMotionForALoadAndTheDefaultDoesNot) {
  ArmEkf::Parameters p = ArmEkf::Parameters::paper();
  EXPECT_LT(rms_in_motion(p), 0.001);
  p.integration = Integration::kEuler;
  EXPECT_GT(rms_in_motion(p), 0.1) << "h/2 B qddd";
}

TEST(Ekf, PassesASineAtItsBandwidthAtAbout3dB) {
  // no dry friction: under a swinging load an arm that slips and one that sticks are two systems
  Testbed1::Parameters smooth;
  smooth.theta4 = 0;
  const Testbed1 arm(smooth);
  for (const double w : {10., 30., 100., 300.}) {
    Ekf<Testbed1> ekf(arm, Ekf<Testbed1>::Parameters::for_bandwidth(arm, w));
    const auto sine = [=](double t) -> Vec<1> { return Vec<1>(5 * std::sin(w * t)); };
    double a = 0, b = 0;
    const double from = 2 * M_PI / w * 4, to = 2 * M_PI / w * 8;
    for (const auto& y : simulate<Testbed1>(grid(to, 0.25e-3), sine, {}, arm)) {
      if (const double d = ekf.update(y).tau_ext[0]; y.t >= from) {
        a += d * std::cos(w * y.t), b += d * std::sin(w * y.t);
      }
    }
    const double gain = std::hypot(a, b) * 0.25e-3 * 2 / (to - from) / 5;
    EXPECT_NEAR(gain, std::sqrt(0.5), 0.1) << "w = " << w << ": exact for each noise alone";
  }
}

TEST(Ekf, InSteadyStateIsAnNdobWithXTheRootOfQTauOverQv) {
  // scalar case, R negligible, h small against the poles: the Riccati equation of (qd, d) gives the
  // gain of d on qd as -sqrt(Q_tau / Q_v) = -(2000, 1581, 2000), and (ii) of math/covariance.h
  // gives that gain as P_dv / R_v
  const ArmEkf::Parameters p = ArmEkf::Parameters::paper();
  ArmEkf ekf(WallMoBot3(), p);
  for (const auto& y : simulate(grid(2, 1e-4), sine_load)) ekf.update(y);
  const Mat<9> P = ekf.covariance();
  for (int j = 0; j < 3; ++j) {
    const double gain = P(6 + j, 3 + j) / p.R[3 + j], X = std::sqrt(p.Q[6 + j] / p.Q[3 + j]);
    EXPECT_NEAR(-gain, X, 0.01 * X) << "joint " << j << ": the poles leave h lambda / 2 = 0.5 %";
  }
}

TEST(Ekf, ThePaperAlignmentReadsTheTorqueASampleLate) {
  // a step of tau at sample 100: the held form explains it, the printed form takes it for a load of
  // B K h, which (facts of the gain above) is some newton metres
  std::vector<Measurement<3>> samples = simulate(grid(0.3, 1e-3), constant(0));
  ArmEkf::Parameters p = ArmEkf::Parameters::paper();
  ArmEkf held(WallMoBot3(), p);
  p.alignment = Alignment::kPaper;
  ArmEkf printed(WallMoBot3(), p);
  // the torque reading jumps in the last sample alone: it acts on the interval that follows
  samples.back().tau += Vec<3>::Constant(100);
  Estimate<3> a, b;
  for (const auto& y : samples) a = held.update(y), b = printed.update(y);
  EXPECT_LT(a.tau_ext.cwiseAbs().maxCoeff(), 0.1);
  EXPECT_GT(b.tau_ext.cwiseAbs().maxCoeff(), 1);
}

TEST(Ekf, StartsFromZeroIfAsked) {
  ArmEkf::Parameters p = ArmEkf::Parameters::paper();
  p.start = Start::kZero;
  ArmEkf ekf(WallMoBot3(), p);
  Measurement<3> y;
  y.q.setConstant(0.3);
  y.qd.setConstant(0.5);
  EXPECT_EQ(ekf.update(y).tau_ext, Vec<3>::Zero());
  EXPECT_EQ(ekf.state(), Vec<9>::Zero());
}

}  // namespace
}  // namespace tauext::test

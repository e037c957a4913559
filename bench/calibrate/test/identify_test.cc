// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/identify.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <random>
#include <stdexcept>

#include "mjcf/record.h"

namespace tauext::test {
namespace {

const std::vector<Term> kEquation36 =
    find_terms({"inertia", "gravity_cos", "gravity_sin", "coulomb"});
constexpr std::array<double, 4> kTheta = {0.41937, 11.668, -0.74, 2.163};  // (37)

Trace motion() {
  const Scenario& s = scenario("testbed1", "identify");
  return record(load_for("testbed1", s), s);
}

// a log of 20 s at 1 kHz along q = 0.3 sin 2t + 0.2 sin 5t, whose torque is torque(q, qd, qdd):
// held over the sample, the value in its middle, or read at instants
template <class Torque>
Trace synthetic(Torque&& torque, bool at_instants = false) {
  Trace log;
  log.torque_at_instants = at_instants;
  constexpr int n = 20000;
  log.q.resize(1, n), log.qd.resize(1, n), log.tau.resize(1, n);
  for (int k = 0; k < n; ++k) {
    const double t = k * 1e-3, s2 = std::sin(2 * t), s5 = std::sin(5 * t);
    log.t.push_back(t);
    log.q(0, k) = 0.3 * s2 + 0.2 * s5;
    log.qd(0, k) = 0.6 * std::cos(2 * t) + std::cos(5 * t);
    const double m = at_instants ? t : t + 0.5e-3,
                 qm = 0.3 * std::sin(2 * m) + 0.2 * std::sin(5 * m);
    log.tau(0, k) = torque(qm, 0.6 * std::cos(2 * m) + std::cos(5 * m),
                           -1.2 * std::sin(2 * m) - 5 * std::sin(5 * m));
  }
  return log;
}

TEST(Identify, RecoversTheParametersOfAMotionWithoutNoise) {
  const Identification id = identify(motion(), kEquation36);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(id.parameters[i].theta, kTheta[i], 1e-4) << i;
  EXPECT_LT(id.residual, 1e-3) << "N m";
  EXPECT_LT(id.condition, 100);
  EXPECT_GT(id.windows, 200);
}

TEST(Identify, OtherFrictionModelsFitByNamingTheirTerms) {
  const auto model = find_terms({"inertia", "coulomb_up", "coulomb_down", "viscous", "quadratic"});
  const Trace log = synthetic([](double, double qd, double qdd) {
    return 0.5 * qdd + (qd > 0 ? 1.5 : -2.5) + 0.7 * qd + 0.2 * qd * std::abs(qd);
  });
  const Identification id = identify(log, model);
  const double expected[] = {0.5, 1.5, 2.5, 0.7, 0.2};
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(id.parameters[i].theta, expected[i], 1e-5) << i;
}

TEST(Identify, TorqueReadAtInstantsIsTakenAsItIs) {
  Trace log = synthetic(
      [](double q, double qd, double qdd) { return 0.5 * qdd + 0.7 * qd + 9 * std::cos(q); }, true);
  const auto model = find_terms({"inertia", "viscous", "gravity_cos"});
  const double viscous = identify(log, model).parameters[1].theta;
  EXPECT_NEAR(viscous, 0.7, 1e-5);
  log.torque_at_instants = false;
  EXPECT_GT(std::abs(identify(log, model).parameters[1].theta - 0.7), 1e-3) << "half a sample late";
}

// what an arm with this torque beside (36) makes of the model of (36)
template <class Torque>
Identification with_untold(Torque&& untold) {
  Trace log = synthetic([&](double q, double qd, double qdd) {
    const double tau = kTheta[0] * qdd +
                       kGravity * (kTheta[1] * std::cos(q) + kTheta[2] * std::sin(q)) +
                       (qd > 0 ? kTheta[3] : -kTheta[3]);
    return tau + untold(qd, tau);
  });
  Sensors sensors;
  sensors.velocity_noise = 1e-3;
  sensors.loadcell_noise = 0.2;
  return identify(measure(log, sensors), kEquation36);
}

TEST(Identify, NamesTheTermThatIsMissing) {
  const Identification white = with_untold([](double, double) { return 0; });
  EXPECT_LT(white.colour, 3);
  EXPECT_TRUE(white.missing.empty());
  const Identification viscous = with_untold([](double qd, double) { return 0.5 * qd; });
  EXPECT_GT(viscous.colour, 3);
  ASSERT_FALSE(viscous.missing.empty());
  EXPECT_EQ(viscous.missing[0].name, "viscous");
  const Identification bent = with_untold([](double, double tau) { return 1e-4 * tau * tau; });
  EXPECT_GT(bent.colour, 3);
  ASSERT_FALSE(bent.missing.empty());
  EXPECT_EQ(bent.missing[0].name, "a loadcell that is not linear (tau^2)");
}

// y = theta x with noise of first order, the exact variance of whose mean is known by simulation
TEST(Residuals, RobustErrorsHoldForColouredNoiseAndTheOthersDoNot) {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  constexpr int kRuns = 400, kSamples = 500;
  double spread = 0, robust = 0, white = 0;
  for (int run = 0; run < kRuns; ++run) {
    Eigen::MatrixXd A(kSamples, 1);
    Eigen::VectorXd noise(kSamples);
    double state = 0;
    for (int k = 0; k < kSamples; ++k) {
      state = 0.8 * state + normal(generator);
      noise[k] = state;
      A(k, 0) = 1 + 0.5 * std::sin(0.05 * k);
    }
    const Eigen::MatrixXd inverse = (A.transpose() * A).inverse();
    const double theta = (inverse * A.transpose() * noise)(0);  // of 0
    const Eigen::VectorXd residuals = noise - A * theta;
    spread += theta * theta / kRuns;
    robust += std::pow(robust_errors(A, inverse, residuals)[0], 2) / kRuns;
    white += residuals.squaredNorm() / (kSamples - 1) * inverse(0) / kRuns;
  }
  EXPECT_NEAR(std::sqrt(robust / spread), 1, 0.2);
  EXPECT_LT(std::sqrt(white / spread), 0.5) << "what they were";
}

TEST(Residuals, ColourIsAStandardNormalOfWhiteNoise) {
  std::mt19937_64 generator(2);
  std::normal_distribution<double> normal;
  double sum = 0, squares = 0;
  constexpr int kRuns = 400;
  for (int run = 0; run < kRuns; ++run) {
    Eigen::VectorXd noise(300);
    for (double& x : noise) x = normal(generator);
    const double z = colour(noise);
    sum += z / kRuns, squares += z * z / kRuns;
  }
  EXPECT_NEAR(sum, 0, 0.2);
  EXPECT_NEAR(std::sqrt(squares), 1, 0.2);
}

TEST(Identify, UnderNoiseItIsWithinThreeSigmaAndSigmaIsHonest) {
  // a 17-bit encoder, 1e-3 rad/s on its velocity, 1 N on the loadcell: 50 runs of 4 parameters
  const Trace truth = motion();
  int inside = 0;
  Eigen::Array4d sum = Eigen::Array4d::Zero();
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Sensors sensors{
        .velocity_noise = 1e-3, .encoder_step = 4.8e-5, .loadcell = {.noise = 1}, .seed = seed};
    const Identification id = identify(measure(truth, sensors), kEquation36);
    for (int i = 0; i < 4; ++i) {
      const double z = (id.parameters[i].theta - kTheta[i]) / id.parameters[i].sigma;
      inside += std::abs(z) <= 3;
      sum[i] += z * z;
    }
  }
  EXPECT_GE(inside, 198) << "99 % of 200";
  // neither too small nor too large: rms of 50 normal numbers is 1 +- 0.1; 0.7 to 1.3 is 3 sigma
  for (int i = 0; i < 4; ++i) {
    EXPECT_GT(std::sqrt(sum[i] / 50), 0.7) << i;
    EXPECT_LT(std::sqrt(sum[i] / 50), 1.3) << i;
  }
}

TEST(Identify, ConditionAndOwnShareSayWhatTheMotionShows) {
  const Identification id = identify(motion(), kEquation36);
  for (const Parameter& p : id.parameters) {
    EXPECT_GT(p.own, 0.1);
    EXPECT_LE(p.own, 1);
    EXPECT_GT(p.excitation, 0);
  }
  // |qd| > 0.02 rad/s in every window, so sign(qd) has the rms 1; g cos q at most g
  EXPECT_NEAR(id.parameters[3].excitation, 1, 1e-12);
  EXPECT_LT(id.parameters[1].excitation, 9.81);
  EXPECT_GT(id.parameters[1].excitation, 9.81 * std::cos(0.55));
}

std::string error_of_identify(const Trace& log, const std::vector<Term>& model) {
  try {
    identify(log, model);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

TEST(Identify, AMotionThatCannotTellTermsApartIsAnErrorThatNamesOne) {
  const Trace constant_speed = synthetic([](double, double, double) { return 1; });
  Trace log = constant_speed;
  for (int k = 0; k < log.size(); ++k) log.qd(0, k) = 0.5;
  const std::string error =
      error_of_identify(log, find_terms({"coulomb", "viscous", "gravity_cos"}));
  EXPECT_NE(error.find("cannot tell '"), std::string::npos) << error;
  for (const auto& terms :
       {find_terms({"coulomb", "coulomb_down"}), find_terms({"coulomb_down"})}) {
    const std::string nothing = error_of_identify(log, terms);
    EXPECT_NE(nothing.find("cannot tell 'coulomb_down'"), std::string::npos) << nothing;
  }
  for (int k = 0; k < log.size(); ++k) log.qd(0, k) = 0;
  EXPECT_NE(error_of_identify(log, kEquation36).find("0 usable windows"), std::string::npos);
}

TEST(Identify, LeavesOutWindowsAcrossAGap) {
  Trace log = motion();
  const int before = identify(log, kEquation36).windows;
  for (int k = 15000; k < log.size(); ++k) log.t[k] += 1;
  const Identification id = identify(log, kEquation36);
  EXPECT_LE(before - id.windows, 2);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(id.parameters[i].theta, kTheta[i], 1e-4) << i;
}

TEST(Identify, RefusesALogOfSeveralJointsAndUnknownTerms) {
  const Scenario& s = scenario("wallmobot3", "free");
  Scenario brief = s;
  brief.duration = 1;
  EXPECT_NE(
      error_of_identify(record(load_robot("wallmobot3"), brief), kEquation36).find("3 joints"),
      std::string::npos);
  EXPECT_THROW(find_terms({"magic"}), std::invalid_argument);
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/least_squares.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

namespace tauext::test {
namespace {

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

TEST(LeastSquares, NamesTheColumnThatTheOthersImitate) {
  Eigen::MatrixXd A(50, 3);
  for (int i = 0; i < 50; ++i) A.row(i) << 1, std::sin(i), 2 + 3 * std::sin(i);
  const Eigen::VectorXd y = Eigen::VectorXd::Ones(50);
  try {
    fit(A, A, y, {"coulomb", "viscous", "gravity"});
    FAIL() << "nothing is wrong";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("cannot tell '"), std::string::npos) << e.what();
  }
}

// of y = 2 x + noise + what the model lacks
TEST(LeastSquares, NamesTheTermThatIsMissing) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd A(300, 1), others(300, 2);
  Eigen::VectorXd noise(300);
  for (int i = 0; i < 300; ++i) {
    A(i, 0) = std::sin(0.1 * i);
    others.row(i) << std::cos(0.23 * i), std::sin(0.37 * i);
    noise[i] = 0.1 * normal(generator);
  }
  const auto missing = [&](double untold) {
    const Fit f = fit(A, A, 2 * A.col(0) + untold * others.col(1) + noise, {"known"});
    EXPECT_NEAR(f.parameters[0].theta, 2, 0.1);
    return suspects(f.shown, f.inverse, f.residuals, others, {"no", "yes"});
  };
  EXPECT_TRUE(missing(0).empty());
  ASSERT_EQ(missing(0.5).size(), 1u);
  EXPECT_EQ(missing(0.5)[0].name, "yes");
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "estimators/extended_state_observer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "estimators/momentum_observer.h"
#include "estimators/test/arm.h"
#include "estimators/testbed1.h"

namespace tauext::test {
namespace {

template <class Arm>
using Eso = ExtendedStateObserver<Arm>;

// the estimates of joint 1 of an arm held at q = 0 that bears 5 N m from its second sample on
std::vector<double> answer_to_a_step(double w, double h, int samples) {
  const Testbed1 arm;
  Eso<Testbed1> eso(arm, {.w = w});
  std::vector<double> all;
  Measurement<1> y;
  for (int k = 0; k < samples; ++k) {
    y.t = k * h;
    y.tau = arm.gravity(y.q) + Vec<1>(5);
    all.push_back(eso.update(y).tau_ext[0]);
  }
  return all;
}

TEST(Eso, HasItsThreePolesWhereWPutsThem) {
  // so (1 - b z)^3 takes away all that is left of a step, after the first samples
  constexpr double kW = 80;
  for (const double h : {0.5e-3, 1e-3, 4e-3}) {
    const double b = std::exp(-kW * h);
    const std::vector<double> d = answer_to_a_step(kW, h, 800);
    for (std::size_t k = 5; k < d.size(); ++k) {
      const double left = (d[k] - 5) - 3 * b * (d[k - 1] - 5) + 3 * b * b * (d[k - 2] - 5) -
                          b * b * b * (d[k - 3] - 5);
      ASSERT_NEAR(left, 0, 1e-9) << "sample " << k << ", every " << h << " s";
    }
    EXPECT_NEAR(d.back(), 5, 5e-3);
  }
}

TEST(Eso, AnswersAStepAsThreeEqualPolesDoWhateverTheSamplingTime) {
  constexpr double kW = 60;
  for (const double h : {0.1e-3, 0.5e-3}) {
    const std::vector<double> d = answer_to_a_step(kW, h, 3000);
    double worst = 0;
    for (std::size_t k = 0; k < d.size(); ++k) {
      const double wt = kW * h * static_cast<double>(k);
      worst = std::max(worst, std::abs(d[k] - 5 * (1 - std::exp(-wt) * (1 + wt + wt * wt / 2))));
    }
    EXPECT_LT(worst, 5 * kW * h) << "a sample or two of its steepest slope, w / 4";
  }
}

TEST(Eso, PassesASineAtItsBandwidthAt3dB) {
  Testbed1::Parameters smooth;
  smooth.theta4 = 0;
  const Testbed1 arm(smooth);
  for (const double w : {10., 30., 100.}) {
    Eso<Testbed1> eso(arm, Eso<Testbed1>::Parameters::for_bandwidth(arm, w));
    const auto sine = [=](double t) -> Vec<1> { return Vec<1>(5 * std::sin(w * t)); };
    double a = 0, b = 0;
    const double from = 2 * M_PI / w * 4, to = 2 * M_PI / w * 8;
    for (const auto& y : simulate<Testbed1>(grid(to, 0.1e-3), sine, {}, arm)) {
      if (const double d = eso.update(y).tau_ext[0]; y.t >= from) {
        a += d * std::cos(w * y.t), b += d * std::sin(w * y.t);
      }
    }
    const double gain = std::hypot(a, b) * 0.1e-3 * 2 / (to - from) / 5;
    EXPECT_NEAR(gain, std::sqrt(0.5), 0.01) << "w = " << w;
  }
}

TEST(Eso, HardlyHearsTheNoiseOfTheMeasuredSpeed) {
  // of which mo1 of its bandwidth makes N m
  const WallMoBot3 arm;
  Eso<WallMoBot3> eso(arm, Eso<WallMoBot3>::Parameters::for_bandwidth(arm, 30));
  auto mo1 = MomentumObserver<WallMoBot3>(
      arm, MomentumObserver<WallMoBot3>::Parameters::for_bandwidth(arm, 30));
  Eso<WallMoBot3> eso_in_noise = eso;
  auto mo1_in_noise = mo1;
  double of_eso = 0, of_mo1 = 0;
  int k = 0;
  for (auto y : simulate(grid(3, 1e-3), constant(20), {.amplitude = 0.3, .w = 2})) {
    const Vec<3> clean_eso = eso.update(y).tau_ext, clean_mo1 = mo1.update(y).tau_ext;
    if (k > 0) y.qd += Vec<3>::Constant(1e-3 * (k % 2 == 0 ? 1 : -1));
    of_eso = std::max(of_eso, (eso_in_noise.update(y).tau_ext - clean_eso).norm());
    of_mo1 = std::max(of_mo1, (mo1_in_noise.update(y).tau_ext - clean_mo1).norm());
    ++k;
  }
  EXPECT_GT(of_mo1, 1) << "N m";
  EXPECT_LT(of_eso, 0.01 * of_mo1);
}

TEST(Eso, StartedInMotionItIsRightFromTheFirstSample) {
  Eso<WallMoBot3> eso(WallMoBot3(), {.w = 60});
  double worst = 0;
  for (const auto& y : simulate(grid(5, 1e-3), constant(0), {.amplitude = 0.3, .w = 2})) {
    worst = std::max(worst, eso.update(y).tau_ext.cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst, 0.05) << "N m";
}

TEST(Eso, RefusesAPoleThatMeansNothing) {
  EXPECT_THROW(Eso<WallMoBot3>(WallMoBot3(), {.w = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace tauext::test

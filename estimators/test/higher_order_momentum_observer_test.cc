// SPDX-License-Identifier: Apache-2.0
#include "estimators/higher_order_momentum_observer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <stdexcept>

#include "estimators/test/arm.h"

namespace tauext::test {
namespace {

template <class Observer>
class HigherOrder : public testing::Test {
 public:
  static constexpr int kOrder = Observer::kName[2] - '0';
  static Observer observer(double w) {
    return Observer(WallMoBot3(), Observer::Parameters::for_bandwidth(WallMoBot3(), w));
  }
};
using Observers = testing::Types<MomentumObserver2<WallMoBot3>, MomentumObserver3<WallMoBot3>>;
TYPED_TEST_SUITE(HigherOrder, Observers);

// Butterworth's step response at normalised time a, from the residues at its poles
double step_response(int order, double a) {
  std::complex<double> sum = 1;
  for (int i = 0; i < order; ++i) {
    const auto pole = [=](int k) {
      return std::polar(1., M_PI * (2. * k + order + 1) / (2. * order));
    };
    std::complex<double> residue = 1. / pole(i);
    for (int k = 0; k < order; ++k) residue /= k == i ? 1 : pole(i) - pole(k);
    sum += residue * std::exp(pole(i) * a);
  }
  return sum.real();
}

TYPED_TEST(HigherOrder, StepResponseIsButterworthsToTheLastDigitsAtAnyStep) {
  for (const double h : {0.1e-3, 1e-3, 20e-3}) {
    TypeParam mo = this->observer(30);
    for (int k = 0; k < 60; ++k) {
      const Vec<3> d = mo.update(held(k * h, 50)).tau_ext;
      const double expected = 50 * step_response(this->kOrder, 30 * h * k);
      ASSERT_LT((d - Vec<3>::Constant(expected)).norm(), 1e-9) << "h " << h << " k " << k;
    }
  }
}

TYPED_TEST(HigherOrder, StepResponseIsTheSameOnUnevenSteps) {
  TypeParam mo = this->observer(30);
  double t = 0;
  for (int k = 0; k < 200; ++k) {
    const double d = mo.update(held(t, 50)).tau_ext[1];
    ASSERT_NEAR(d, 50 * step_response(this->kOrder, 30 * t), 1e-9);
    t += 1e-3 * (1 + k % 3);
  }
}

TYPED_TEST(HigherOrder, PassesASineAtItsBandwidthAt3dB) {
  for (const double w : {10., 40.}) {
    TypeParam mo = this->observer(w);
    const auto sine = [=](double t) -> Vec<3> { return Vec<3>::Constant(50 * std::sin(w * t)); };
    Vec<3> a = Vec<3>::Zero(), b = Vec<3>::Zero();
    const double from = 2 * M_PI / w * 3, to = 2 * M_PI / w * 6;
    for (const auto& y : simulate(grid(to, 0.25e-3), sine)) {
      const Vec<3> d = mo.update(y).tau_ext;
      if (y.t < from) continue;
      a += d * std::cos(w * y.t), b += d * std::sin(w * y.t);
    }
    const Vec<3> gain =
        (a.cwiseAbs2() + b.cwiseAbs2()).cwiseSqrt() * 0.25e-3 * 2 / (to - from) / 50;
    EXPECT_LT((gain - Vec<3>::Constant(std::sqrt(0.5))).cwiseAbs().maxCoeff(), 0.005) << gain;
  }
}

TYPED_TEST(HigherOrder, FollowsARampTheSumOfItsLagsBehind) {
  constexpr double kSlope = 20;  // [N m/s]
  const double lag =
      (this->kOrder == 2 ? std::sqrt(2.) : 2.) / 30;  // [s] the coefficient of d' in (i)
  TypeParam mo = this->observer(30);
  Vec<3> behind = Vec<3>::Zero();
  const auto ramp = [](double t) -> Vec<3> { return Vec<3>::Constant(kSlope * t); };
  for (const auto& y : simulate(grid(3, 1e-3), ramp)) behind = ramp(y.t) - mo.update(y).tau_ext;
  // a held sample is half a step ahead of its mean
  for (int j = 0; j < 3; ++j) EXPECT_NEAR(behind[j], kSlope * lag, kSlope * (0.01 * lag + 1e-3));
}

TYPED_TEST(HigherOrder, StartedInMotionItIsRightFromTheFirstSample) {
  TypeParam mo = this->observer(30);
  double worst = 0;
  for (const auto& y : simulate(grid(5, 1e-3), constant(0), {.amplitude = 0.3, .w = 2})) {
    worst = std::max(worst, mo.update(y).tau_ext.cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst, 0.01) << "N m";
}

TYPED_TEST(HigherOrder, IsStableForEveryStepOfItsBandwidth) {
  TypeParam mo = this->observer(1e6);
  const auto step = [](double t) -> Vec<3> { return Vec<3>::Constant(t < 1 ? 0 : 50); };
  double worst = 0;
  for (const auto& y : simulate(grid(3, 1e-3), step)) {
    const Vec<3> d = mo.update(y).tau_ext;
    if (y.t > 1.01) worst = std::max(worst, (d - step(y.t)).norm());
  }
  EXPECT_LT(worst, 0.5) << "N m: w h = 1000 differentiates, and that is all";
}

TYPED_TEST(HigherOrder, RefusesABandwidthOfZero) {
  EXPECT_THROW(this->observer(0), std::invalid_argument);
}

}  // namespace
}  // namespace tauext::test

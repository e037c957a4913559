// SPDX-License-Identifier: Apache-2.0
#include "estimators/disturbance_kalman_filter.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <utility>

#include "estimators/higher_order_momentum_observer.h"
#include "estimators/test/arm.h"
#include "estimators/testbed1.h"

namespace tauext::test {
namespace {

template <class Arm>
using Dkf = DisturbanceKalmanFilter<Arm>;

template <class Arm>
Dkf<Arm> dkf(double w) {
  return Dkf<Arm>(Arm(), Dkf<Arm>::Parameters::for_bandwidth(Arm(), w));
}

TEST(Dkf, WithAConstantBIsTheSecondOrderMomentumObserver) {
  // the Kalman filter of (i) between samples has its poles and zeros; sampled it leads by about h/2
  constexpr double kLoad = 50;
  auto filter = dkf<Testbed1>(30);
  MomentumObserver2<Testbed1> mo2(Testbed1(), {.bandwidth = 30});
  const auto step = [](double t) -> Vec<1> { return Vec<1>(t < 1 ? 0 : kLoad); };
  double worst = 0;
  for (const auto& y : simulate<Testbed1>(grid(2, 0.1e-3), step)) {
    worst = std::max(worst, std::abs(filter.update(y).tau_ext[0] - mo2.update(y).tau_ext[0]));
  }
  EXPECT_LT(worst, 0.01 * kLoad) << "N m";
}

TEST(Dkf, HeldAtQ0EveryJointIsTheSecondOrderMomentumObserver) {
  // B(0) couples the joints by up to nine tenths, and w undoes it
  const WallMoBot3 arm;
  auto filter = dkf<WallMoBot3>(30);
  MomentumObserver2<WallMoBot3> mo2(arm, {.bandwidth = 30});
  Measurement<3> y;
  for (int k = 0; k < 10000; ++k) {
    y.t = k * 0.1e-3;
    y.tau = arm.gravity(y.q) + (k < 5000 ? Vec<3>(0, 0, 0) : Vec<3>(50, -20, 30));
    const Vec<3> d = filter.update(y).tau_ext, e = mo2.update(y).tau_ext;
    ASSERT_LT((d - e).norm(), 0.01 * 50) << "N m at t = " << y.t;
  }
}

// (ii) to (iv) as a textbook has them, dense and with an inverse
struct TextbookDkf {
  const WallMoBot3 arm = WallMoBot3();
  const Dkf<WallMoBot3>::Parameters p;
  Vec<6> x;
  Mat<6> P;
  Mat<3> V = Mat<3>::Zero();
  Measurement<3> before;
  bool started = false;

  Vec<3> rest(const Measurement<3>& y) const {
    return arm.momentum_bias(y.q, y.qd) - arm.friction(y.qd);
  }
  Vec<3> update(const Measurement<3>& y) {
    const Mat<3> B = arm.inertia(y.q), I = Mat<3>::Identity(), O = Mat<3>::Zero();
    const Mat<3> R = B * p.Q_qd.asDiagonal() * B.transpose(), Q_d = std::pow(p.w, 4) * R;
    if (!started) {
      started = true;
      x << B * y.qd, Vec<3>::Zero();
      P << B * p.P0_qd.asDiagonal() * B.transpose(), O, O, std::sqrt(2.) * std::pow(p.w, 3) * R;
    } else {
      const double h = y.t - before.t;
      Mat<6> Phi, Q;
      Phi << I, -h * I, O, I;
      Q << h * h * h / 3 * Q_d + h * Mat<3>(p.Q_p.asDiagonal()), -h * h / 2 * Q_d, -h * h / 2 * Q_d,
          h * Q_d;
      Eigen::Matrix<double, 3, 6> H;
      H << I, O;
      x = Phi * x;
      x.head<3>() += h * (before.tau + 0.5 * (rest(y) + rest(before)));
      P = Mat<6>(Phi * P * Phi.transpose());
      if (p.window > 0) {
        const Vec<3> nu = B * y.qd - H * x;
        const double stays = std::exp(-h / p.window);
        V = stays * V + (1 - stays) * nu * nu.transpose();
        const Mat<3> weights = R.diagonal().cwiseInverse().asDiagonal();
        const double N = (weights * (V - p.weakening * R / h - H * Q * H.transpose())).trace(),
                     M = (weights * (H * P * H.transpose())).trace();
        P *= std::max(1., N / M);
      }
      P += Q;
      const Mat<3> S = H * P * H.transpose() + R / h;
      const Eigen::Matrix<double, 6, 3> K = P * H.transpose() * S.inverse();
      x += K * (B * y.qd - H * x);
      P = Mat<6>((Mat<6>::Identity() - K * H) * P);
      P = Mat<6>(0.5 * (P + P.transpose()));
    }
    before = y;
    return x.tail<3>();
  }
};

void expect_textbook(const Dkf<WallMoBot3>::Parameters& p) {
  Dkf<WallMoBot3> filter(WallMoBot3(), p);
  TextbookDkf textbook{.p = p};
  const auto sine = [](double t) -> Vec<3> {
    return Vec<3>::Constant(10 * std::sin(t) - (t < 15 ? 5 : 60));
  };
  double worst = 0;
  for (const auto& y : simulate(grid(30, 1e-3), sine, {.amplitude = 0.3, .w = 2})) {
    worst = std::max(worst, (filter.update(y).tau_ext - textbook.update(y)).norm());
    const Mat<6> P = filter.covariance();
    ASSERT_TRUE(P.allFinite());
    ASSERT_EQ(P, P.transpose()) << "t = " << y.t;
    ASSERT_GT(P.diagonal().minCoeff(), 0);
  }
  EXPECT_LT(worst, 1e-7) << "N m";
  EXPECT_LT((filter.covariance() - textbook.P).norm(), 1e-9 * textbook.P.norm());
}

TEST(Dkf, AgreesWithTheDenseTextbookFormFor30SecondsAndPStaysSymmetric) {
  auto p = Dkf<WallMoBot3>::Parameters::for_bandwidth(WallMoBot3(), 30);
  p.Q_p.setConstant(0.1);
  expect_textbook(p);
  p.window = 0.05;
  SCOPED_TRACE("adapts");
  expect_textbook(p);
}

// [s] from a load of 50 N m until 45 are seen, and the estimate's standard deviation before it
// [N m], at this noise of qd
template <class Filter>
std::pair<double, double> rise_and_noise(Filter filter, double noise) {
  const WallMoBot3 arm;
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  double squares = 0;
  Measurement<3> y;
  for (int k = 0; k < 4000; ++k) {
    y.t = k * 1e-3;
    const Vec<3> load = Vec<3>::Constant(k < 3000 ? 0 : 50);
    y.tau = arm.gravity(y.q) + load;
    for (int j = 0; j < 3; ++j) y.qd[j] = noise * normal(generator);
    const double d = filter.update(y).tau_ext[1];
    if (k >= 1000 && k < 3000) squares += d * d / 2000;
    if (k >= 3000 && d > 45) return {y.t - 3, std::sqrt(squares)};
  }
  return {1e9, std::sqrt(squares)};
}

TEST(DkfAdaptive, SeesALoadSoonerWithHardlyMoreNoise) {
  const WallMoBot3 arm;
  const auto p = AdaptiveKalmanFilter<WallMoBot3>::Parameters::for_bandwidth(arm, 20);
  EXPECT_GT(p.window, 0);
  const auto adapts = rise_and_noise(AdaptiveKalmanFilter<WallMoBot3>(arm, p), 1e-3);
  const auto stays = rise_and_noise(dkf<WallMoBot3>(20), 1e-3);
  EXPECT_LT(adapts.first, 0.6 * stays.first);
  EXPECT_LT(adapts.second, 2 * stays.second);
}

TEST(Dkf, StartedInMotionItIsRightFromTheFirstSample) {
  auto filter = dkf<WallMoBot3>(30);
  double worst = 0;
  for (const auto& y : simulate(grid(5, 1e-3), constant(0), {.amplitude = 0.3, .w = 2})) {
    worst = std::max(worst, filter.update(y).tau_ext.cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst, 0.01) << "N m";
}

TEST(Dkf, RefusesParametersThatMeanNothing) {
  const WallMoBot3 arm;
  EXPECT_THROW(Dkf<WallMoBot3>(arm, {}), std::invalid_argument) << "Q_d = 0";
  auto p = Dkf<WallMoBot3>::Parameters::for_bandwidth(arm, 30);
  p.Q_qd[1] = 0;
  EXPECT_THROW(Dkf<WallMoBot3>(arm, p), std::invalid_argument);
}

}  // namespace
}  // namespace tauext::test

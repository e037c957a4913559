// SPDX-License-Identifier: Apache-2.0
// What every estimator must do when it is built from nothing but a model and a bandwidth.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "estimators/active_observer.h"
#include "estimators/disturbance_kalman_filter.h"
#include "estimators/ekf.h"
#include "estimators/higher_order_momentum_observer.h"
#include "estimators/inverse_dynamics.h"
#include "estimators/momentum_observer.h"
#include "estimators/ndob.h"
#include "estimators/ndob_inertia.h"
#include "estimators/sliding_mode_observer.h"
#include "estimators/test/arm.h"
#include "estimators/testbed1.h"

namespace tauext::test {
namespace {

// an arm, and the load [N m] of a step that it can bear
template <class Arm>
struct Case {
  static Arm arm() { return Arm(); }
  static constexpr double kLoad = 50;
};
template <>
struct Case<Testbed1> {
  static Testbed1 arm() {
    Testbed1::Parameters p;
    p.v_s = 0.02;  // friction.h: the default is for steps of up to 1.9 ms, and here they are longer
    return Testbed1(p);
  }
  static constexpr double kLoad = 5;
};

template <template <class> class E, class M>
struct Kind {
  using Estimator = E<M>;
  using Arm = M;
};

template <class K>
class Bandwidth : public testing::Test {
 public:
  using E = typename K::Estimator;
  using Arm = typename K::Arm;
  static constexpr int N = Arm::kDof;
  using Samples = std::vector<Measurement<N>>;

  // not inlined: a copy in each test would take long to compile, and may round differently
  [[gnu::noinline]] static Estimate<N> step(E& e, const Measurement<N>& y) { return e.update(y); }
  [[gnu::noinline]] static E estimator(double w) {
    const Arm arm = Case<Arm>::arm();
    static_assert(TorqueEstimator<E>);
    return E(arm, E::Parameters::for_bandwidth(arm, w));
  }
  static Samples samples(const std::vector<double>& times, double from, double load) {
    return simulate<Arm>(
        times, [=](double t) -> Vec<N> { return Vec<N>::Constant(t < from - 1e-9 ? 0 : load); },
        {.amplitude = 0.3, .w = 2}, Case<Arm>::arm());
  }
  // at 30, 60, 100 and 200 ms after a step of the load at 0.5 s, between samples by a straight line
  static Eigen::Matrix<double, N, 4> response(const std::vector<double>& times) {
    constexpr double kAt[] = {0.53, 0.56, 0.6, 0.7};
    Eigen::Matrix<double, N, 4> out;
    E e = estimator(10);
    Vec<N> before = Vec<N>::Zero();
    double t = 0;
    for (const auto& y : samples(times, 0.5, Case<Arm>::kLoad)) {
      const Vec<N> d = step(e, y).tau_ext;
      for (int i = 0; i < 4; ++i) {
        if (t < kAt[i] && kAt[i] <= y.t) {
          out.col(i) = before + (d - before) * (kAt[i] - t) / (y.t - t);
        }
      }
      before = d;
      t = y.t;
    }
    return out;
  }
};

using Kinds = testing::Types<  //
    Kind<InverseDynamics, WallMoBot3>, Kind<InverseDynamics, Testbed1>,
    Kind<MomentumObserver, WallMoBot3>, Kind<MomentumObserver, Testbed1>,
    Kind<MomentumObserver2, WallMoBot3>, Kind<MomentumObserver2, Testbed1>,
    Kind<MomentumObserver3, WallMoBot3>, Kind<MomentumObserver3, Testbed1>,  //
    Kind<Ndob, WallMoBot3>, Kind<Ndob, Testbed1>,                            //
    Kind<NdobInertia, WallMoBot3>, Kind<NdobInertia, Testbed1>,              //
    Kind<Ekf, WallMoBot3>, Kind<Ekf, Testbed1>,                              //
    Kind<DisturbanceKalmanFilter, WallMoBot3>, Kind<DisturbanceKalmanFilter, Testbed1>,
    Kind<SlidingModeObserver, WallMoBot3>, Kind<SlidingModeObserver, Testbed1>,
    Kind<ActiveObserver, WallMoBot3>, Kind<ActiveObserver, Testbed1>>;
TYPED_TEST_SUITE(Bandwidth, Kinds);

TYPED_TEST(Bandwidth, ALoadOfPlus5IsEstimatedAsPlus5) {
  auto e = this->estimator(30);
  Vec<TestFixture::N> d;
  for (const auto& y : this->samples(grid(6, 1e-3), 0, 5)) d = this->step(e, y).tau_ext;
  EXPECT_LT((d.array() - 5).abs().maxCoeff(), 0.1) << d.transpose();
}

TYPED_TEST(Bandwidth, StartedInMotionThereIsNoLoadAndNoSpike) {
  auto e = this->estimator(30);
  const auto samples = this->samples(grid(8, 1e-3), 0, 0);
  double sum = 0, worst = 0;
  for (const auto& y : samples) {
    const auto d = this->step(e, y).tau_ext;
    sum += d.squaredNorm();
    worst = std::max(worst, d.cwiseAbs().maxCoeff());
  }
  EXPECT_LT(std::sqrt(sum / static_cast<double>(samples.size()) / TestFixture::N), 0.1) << "N m";
  EXPECT_LT(worst, 1) << "N m";
}

TYPED_TEST(Bandwidth, AnswersAreAlikeAtEverySampleTimeAndWithJitter) {
  using C = Case<typename TestFixture::Arm>;
  const auto reference = this->response(grid(0.8, 1e-3));
  const auto difference = [&](const std::vector<double>& times) {
    return (this->response(times) - reference).cwiseAbs().maxCoeff();
  };
  for (const double Ts : {0.25e-3, 0.5e-3, 2e-3}) {
    EXPECT_LT(difference(grid(0.8, Ts)), 0.02 * C::kLoad) << "Ts = " << Ts << " s";
  }
  std::mt19937_64 generator(4);
  std::vector<double> times = grid(0.8, 1e-3);
  for (double& t : times) {  // but for the sample at which the load appears
    if (t > 0 && std::abs(t - 0.5) > 1e-9) {
      t += 0.6e-3 * (static_cast<double>(generator() >> 11) * 0x1p-53 - 0.5);
    }
  }
  EXPECT_LT(difference(times), 0.02 * C::kLoad) << "jitter";
}

// an arm whose torque changes continuously, read at the instants of its samples
TYPED_TEST(Bandwidth, TorqueReadAtInstantsCostsAMovingArmNothing) {
  using V = Vec<TestFixture::N>;
  const auto arm = Case<typename TestFixture::Arm>::arm();
  const auto rms = [&](TorqueSampling torque) {
    auto p = TestFixture::E::Parameters::for_bandwidth(arm, 30);
    p.torque = torque;
    typename TestFixture::E e(arm, p);
    double sum = 0;
    int count = 0;
    for (int k = 0; k < 6000; ++k) {
      const double t = k * 1e-3;
      Measurement<TestFixture::N> y;
      y.t = t;
      y.q = V::Constant(0.3 * std::sin(2 * t));
      y.qd = V::Constant(0.6 * std::cos(2 * t));
      const V qdd = V::Constant(-1.2 * std::sin(2 * t));
      y.tau = arm.inertia(y.q) * qdd + arm.bias(y.q, y.qd) + arm.friction(y.qd);  // (3)
      const V d = this->step(e, y).tau_ext;
      if (t < 1) continue;
      sum += d.cwiseAbs2().maxCoeff();
      ++count;
    }
    return std::sqrt(sum / count);
  };
  const double instant = rms(TorqueSampling::kInstant), held = rms(TorqueSampling::kHeld);
  EXPECT_LE(instant, 0.01) << "N m";
  EXPECT_GE(held, 4 * instant) << "N m";
}

TYPED_TEST(Bandwidth, ANaNSampleIsFlaggedAndHeld) {
  auto e = this->estimator(30);
  auto samples = this->samples(grid(2, 1e-3), 0, 5);
  samples[500].qd[0] = std::numeric_limits<double>::quiet_NaN();
  Estimate<TestFixture::N> before, now;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    now = this->step(e, samples[k]);
    EXPECT_EQ(now.status, k == 0     ? Status::kStarted
                          : k == 500 ? Status::kBadMeasurement
                                     : Status::kOk);
    if (k == 500) {
      EXPECT_EQ(now.tau_ext, before.tau_ext);
    }
    before = now;
  }
  EXPECT_LT((now.tau_ext.array() - 5).abs().maxCoeff(), 0.1);
}

TYPED_TEST(Bandwidth, TheEstimateIsFiniteWhateverComesIn) {
  auto e = this->estimator(30);
  std::mt19937_64 generator(8);
  constexpr double kOdd[] = {kNaN, 1e308, -1e308, 9e5, -9e5, 1e-308, 0, 1, -1};
  auto samples = this->samples(grid(2, 1e-3), 0, 5);
  for (std::size_t k = 0; k < samples.size(); k += 1 + generator() % 3) {
    auto& y = samples[k];
    (generator() % 4 == 0   ? y.t
     : generator() % 3 == 0 ? y.q[0]
     : generator() % 2      ? y.qd[TestFixture::N / 2]
                            : y.tau[TestFixture::N - 1]) = kOdd[generator() % std::size(kOdd)];
  }
  for (const auto& y : samples) ASSERT_TRUE(this->step(e, y).tau_ext.allFinite());
}

TYPED_TEST(Bandwidth, AResetRepeatsEveryBit) {
  auto e = this->estimator(30);
  const auto samples = this->samples(grid(0.5, 1e-3), 0.2, 5);
  std::vector<Vec<TestFixture::N>> runs[2];
  for (auto& run : runs) {
    e.reset();
    for (const auto& y : samples) run.push_back(this->step(e, y).tau_ext);
  }
  EXPECT_EQ(runs[0], runs[1]);
}

}  // namespace
}  // namespace tauext::test

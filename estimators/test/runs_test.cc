// SPDX-License-Identifier: Apache-2.0
// Every estimator of the roster beside others of its kind, by bench/kit's claims on runs.
#include "estimators/runs/runs.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <tuple>
#include <vector>

#include "bench/kit/conformance_runs.h"
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
#include "estimators/test/random_tree.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

using conformance::expect_runs_alike;
using conformance::SamplesOfRuns;

// moves and loads that differ from run to run, with the noise of sensors
template <class M, int W>
SamplesOfRuns<M::kDof, W> different(const M& arm, double seconds) {
  SamplesOfRuns<M::kDof, W> all;
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise;
  for (int i = 0; i < W; ++i) {
    auto& mine = all[static_cast<std::size_t>(i)];
    mine = simulated_arm::simulate<M>(simulated_arm::grid(seconds, i % 2 ? 1e-3 : 2e-3),
                                      simulated_arm::constant<M::kDof>(3. * i - 5),
                                      {.amplitude = 0.1 + 0.02 * i, .w = 1. + 0.3 * i}, arm);
    for (auto& y : mine) {
      for (double& x : y.q) x += 1e-5 * noise(random);
      for (double& x : y.qd) x += 1e-3 * noise(random);
    }
  }
  return all;
}

// runs of other samples and other bandwidths
template <ForRuns E, int W>
void expect_alike(const typename E::Model& arm) {
  SCOPED_TRACE(E::kName);
  std::array<typename E::Parameters, static_cast<std::size_t>(W)> p;
  for (int i = 0; i < W; ++i)
    p[static_cast<std::size_t>(i)] = E::Parameters::for_bandwidth(arm, 20. + 5 * i);
  const int odd = expect_runs_alike<E, W>(arm, p, different<typename E::Model, W>(arm, 1));
  EXPECT_GE(odd, W) << "each run starts";
}

TEST(Runs, FourAtOnceAreAsAlone) {
  using M = WallMoBot3;
  const M arm;
  expect_alike<ActiveObserver<M>, 4>(arm);
  expect_alike<DisturbanceKalmanFilter<M>, 4>(arm);
  expect_alike<Ekf<M>, 4>(arm);
  expect_alike<InverseDynamics<M>, 4>(arm);
  expect_alike<MomentumObserver<M>, 4>(arm);
  expect_alike<MomentumObserver2<M>, 4>(arm);
  expect_alike<MomentumObserver3<M>, 4>(arm);
  expect_alike<Ndob<M>, 4>(arm);
  expect_alike<NdobInertia<M>, 4>(arm);
  expect_alike<SlidingModeObserver<M>, 4>(arm);
}

TEST(Runs, EightAtOnceAreAsAlone) {
  const WallMoBot3 arm;
  expect_alike<Ekf<WallMoBot3>, 8>(arm);
  expect_alike<SlidingModeObserver<WallMoBot3>, 8>(arm);
}

TEST(Runs, ArmsFromTreesAreAsAlone) {
  const auto arm = RandomTree<2, 3>(5).model<double>();
  using Arm = TreeModel<2, double, 3>;
  expect_alike<Ekf<Arm>, 4>(arm);
  expect_alike<MomentumObserver2<Arm>, 4>(arm);
  expect_alike<Ndob<Arm>, 4>(arm);
}

TEST(Runs, ThePapersEkfIsAsAlone) {
  const WallMoBot3 arm;
  std::array<EkfParameters<3>, 4> p;
  p.fill(EkfParameters<3>::paper());
  p[2] = EkfParameters<3>::paper();
  p[2].Q *= 2;
  expect_runs_alike<Ekf<WallMoBot3>, 4>(arm, p, different<WallMoBot3, 4>(arm, 1));
  for (auto& mine : p) mine.integration = Integration::kEuler, mine.start = Start::kZero;
  expect_runs_alike<Ekf<WallMoBot3>, 4>(arm, p, different<WallMoBot3, 4>(arm, 0.5));
}

TEST(Runs, AGateAndATorqueReadAtInstantsAreThoseOfTheRun) {
  const WallMoBot3 arm;
  std::array<EkfParameters<3>, 4> p;
  p.fill(EkfParameters<3>::for_bandwidth(arm, 30));
  for (auto& mine : p) mine.torque = TorqueSampling::kInstant;
  auto samples = different<WallMoBot3, 4>(arm, 1);
  samples[1][700].q[1] += 4e-3;  // less than any arm may jump, and more than the filter believes
  samples[3][250].q[0] -= 4e-3;
  int unlikely = 0;
  Ekf<WallMoBot3> alone(arm, p[1]);
  for (const auto& y : samples[1]) unlikely += alone.update(y).status == Status::kUnlikely;
  EXPECT_EQ(unlikely, 1);
  expect_runs_alike<Ekf<WallMoBot3>, 4>(arm, p, samples);
}

// one joint whose inertia is none beyond 1 rad: Number() for S = Pack
template <class S>
struct Folding {
  static constexpr int kDof = 1;
  using Number = S;
  template <class Other>
  Folding<Other> with() const {
    return {};
  }
  Mat<1, S> inertia(const Vec<1, S>& q) const noexcept {
    return Mat<1, S>(select(q[0] < S(1), S(2), S(-2)));
  }
  Vec<1, S> gravity(const Vec<1, S>&) const noexcept { return Vec<1, S>::Zero(); }
  Vec<1, S> bias(const Vec<1, S>&, const Vec<1, S>&) const noexcept { return gravity({}); }
  Vec<1, S> momentum_bias(const Vec<1, S>&, const Vec<1, S>&) const noexcept { return gravity({}); }
  Vec<1, S> friction(const Vec<1, S>&) const noexcept { return gravity({}); }
  ArmLimits<1> limits() const { return {}; }
};

TEST(Runs, ARunWhoseInertiaIsSingularStartsAnewAndLeavesTheOthersAlone) {
  SamplesOfRuns<1, 4> samples;
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 400; ++k) {
      Measurement<1> y;
      y.t = 1e-3 * k;
      y.q[0] = (i == 2 ? 0.9 : 0.3) + 0.2 * std::sin(10 * y.t);
      y.qd[0] = 2 * std::cos(10 * y.t);
      y.tau[0] = i + std::sin(20 * y.t);
      samples[static_cast<std::size_t>(i)].push_back(y);
    }
  }
  const Folding<double> arm;
  std::array<Ndob<Folding<double>>::Parameters, 4> p;
  for (auto& mine : p) mine.X[0] = 60;
  Ndob<Folding<double>> alone(arm, p[2]);
  int singular = 0;
  for (const auto& y : samples[2]) singular += alone.update(y).status == Status::kSingularInertia;
  EXPECT_GT(singular, 10);
  const int odd = expect_runs_alike<Ndob<Folding<double>>, 4>(arm, p, samples);
  EXPECT_GT(odd, singular);
}

TEST(Runs, ARunThatDivergesStartsAnewAndLeavesTheOthersAlone) {
  const WallMoBot3 arm;
  auto samples = different<WallMoBot3, 4>(arm, 0.3);
  std::array<Ndob<WallMoBot3>::Parameters, 4> p;
  p.fill({.X = {600, 1000, 600}});
  p[1].X.setConstant(1e10);  // of a velocity that is never 0
  p[1].integration = p[0].integration = p[2].integration = p[3].integration = Integration::kEuler;
  Ndob<WallMoBot3> alone(arm, p[1]);
  int diverged = 0;
  for (const auto& y : samples[1]) diverged += alone.update(y).status == Status::kDiverged;
  EXPECT_GT(diverged, 10);
  expect_runs_alike<Ndob<WallMoBot3>, 4>(arm, p, samples);
}

TEST(Runs, ForgetAllOrOneOfThem) {
  using E = MomentumObserver2<WallMoBot3>;
  const WallMoBot3 arm;
  const auto samples = different<WallMoBot3, 4>(arm, 0.2);
  Runs<E, 4> runs(arm, E::Parameters());
  std::array<E, 4> alone = {E(arm), E(arm), E(arm), E(arm)};
  for (std::size_t k = 0; k < 90; ++k) {
    if (k == 40) runs.reset(2), alone[2].reset();
    if (k == 60) {
      runs.reset();
      for (auto& e : alone) e.reset();
    }
    Measurement<3, Pack<4>> y;
    for (int i = 0; i < 4; ++i) put(samples[static_cast<std::size_t>(i)][k], i, y);
    const auto& all = runs.update(y);
    for (std::size_t i = 0; i < 4; ++i) {
      const Estimate<3> e = alone[i].update(samples[i][k]);
      ASSERT_EQ(all.status[i], e.status) << k;
      ASSERT_EQ(e.status == Status::kStarted, k == 0 || k == 60 || (k == 40 && i == 2));
      for (int j = 0; j < 3; ++j)
        EXPECT_NEAR(all.tau_ext[j][static_cast<int>(i)], e.tau_ext[j], 1e-10) << k;
    }
  }
}

struct ThreeMembers {
  double w = 1;
  Vec<6> Q = Vec<6>::Zero();
  Start start = Start::kZero;
};
static_assert(detail::count_members<ThreeMembers>() == 3);
using T = ThreeMembers;
static_assert(detail::all_differ(std::tuple(&T::w, &T::Q, &T::start)));
static_assert(!detail::all_differ(std::tuple(&T::w, &T::Q, &T::w)));

TEST(Runs, MayDifferInNumbersAlone) {
  using E = MomentumObserver2<WallMoBot3>;
  std::array<E::Parameters, 4> p;
  const auto error = [&] { return error_of([&] { Runs<E, 4>(WallMoBot3(), p); }); };
  p[1].torque = TorqueSampling::kInstant;
  EXPECT_EQ(error().find("run 1 has another torque than run 0; "), 0u) << error();
  p[1] = {.bandwidth = -1};
  EXPECT_EQ(error().find("run 1: bandwidth [rad/s] of mo2 is -1: "), 0u) << error();
}

}  // namespace
}  // namespace tauext::test

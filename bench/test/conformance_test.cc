// SPDX-License-Identifier: Apache-2.0
// What every estimator and detector of the roster must do, whoever wrote it.
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <type_traits>
#include <vector>

#include "bench/allocations.h"
#include "bench/robot.h"
#include "bench/roster.h"
#include "estimators/test/arm.h"
#include "mjcf/record.h"

namespace tauext::test {
namespace {

template <int N>
using Samples = std::vector<Measurement<N>>;

template <int N>
Samples<N> samples_of(const Trace& t) {
  Samples<N> s;
  for (int k = 0; k < t.size(); ++k) s.push_back(t.measurement<N>(k));
  return s;
}

template <class E>
std::vector<Estimate<E::kDof>> run(E& e, const Samples<E::kDof>& samples) {
  std::vector<Estimate<E::kDof>> out;
  for (const auto& y : samples) out.push_back(e.update(y));
  return out;
}

// calls claim(estimator) with a fresh one of every kind that estimates; baselines only know their trace
template <class Arm, class Claim>
void for_every_estimator(Claim&& claim) {
  int count = 0;
  for_each_estimator(Arm(), [&](auto make) {
    using E = decltype(make(Trace()));
    static_assert(TorqueEstimator<E>);
    if (is_baseline(E::kName)) return;
    SCOPED_TRACE(E::kName);
    auto e = make(Trace());
    claim(e);
    ++count;
  });
  ASSERT_GE(count, 3);
}

// the paper's literal forms are in the suite to be compared, and keep no promise beyond being finite
template <class E>
constexpr bool is_printed_form = requires {
  E::kPrintedForm;
};

template <class Arm, class Claim>
void for_every_sound_estimator(Claim&& claim) {
  for_every_estimator<Arm>([&](auto& e) {
    if constexpr (!is_printed_form<std::decay_t<decltype(e)>>) claim(e);
  });
}

template <class Arm>
class EveryEstimator : public testing::Test {};
using Arms = testing::Types<WallMoBot3, Testbed1>;
TYPED_TEST_SUITE(EveryEstimator, Arms);

TEST(EveryRobot, IsHeldToTheseTests) {
  int robots = 0;
  for_each_robot([&](const char*, const auto&) { ++robots; });
  EXPECT_EQ(robots, 2) << "add the new one to Arms above";
}

TYPED_TEST(EveryEstimator, EstimatesALoadOfPlus5AsPlus5) {
  using Arm = TypeParam;
  constexpr int N = Arm::kDof;
  const auto samples = simulate<Arm>(grid(12, 1e-3), constant<N>(5));
  for_every_sound_estimator<Arm>([&](auto& e) {
    const Vec<N> last = run(e, samples).back().tau_ext;
    EXPECT_LT((last - Vec<N>::Constant(5)).cwiseAbs().maxCoeff(), 0.1) << last.transpose();
  });
}

TEST(EveryEstimatorOfWallMoBot3, EstimatesAForceOnThePanelAsMinusJTransposeF) {
  Scenario s = scenario("wallmobot3", "free");
  s.duration = 12;
  s.force = [](double, const Point&) -> Eigen::Vector3d { return {50, 0, 0}; };
  const Trace t = record(load_robot("wallmobot3"), s);
  const Vec<3> truth = -WallMoBot3().jacobian(t.q.col(t.size() - 1)).transpose() * Vec<3>(50, 0, 0);
  for_every_estimator<WallMoBot3>([&](auto& e) {
    const Vec<3> last = run(e, samples_of<3>(t)).back().tau_ext;
    EXPECT_LT((last - truth).cwiseAbs().maxCoeff(), 0.05 * truth.norm()) << last.transpose();
  });
}

TYPED_TEST(EveryEstimator, StartedInMotionShowsNoLoadAndNoSpike) {
  // gravity alone is 2,000 N m on wallmobot3, and X qd_0 of its NDOB 600
  using Arm = TypeParam;
  constexpr int N = Arm::kDof;
  const auto samples = simulate<Arm>(grid(12, 1e-3), constant<N>(0), {.amplitude = 0.3, .w = 2});
  for_every_sound_estimator<Arm>([&](auto& e) {
    double worst = 0;
    for (const auto& x : run(e, samples)) worst = std::max(worst, x.tau_ext.cwiseAbs().maxCoeff());
    EXPECT_LT(worst, 0.5) << "N m";
  });
}

// at 0.5 s after a step of 50 N m, where every estimator is still under way
template <class Arm, class E>
Vec<Arm::kDof> half_way(E& e, const std::vector<double>& times) {
  constexpr int N = Arm::kDof;
  e.reset();
  const auto load = [](double t) -> Vec<N> { return Vec<N>::Constant(t < 0.5 ? 0 : 50); };
  return run(e, simulate<Arm>(times, load)).back().tau_ext;
}

TYPED_TEST(EveryEstimator, AnswersAlikeAtEverySampleTime) {
  using Arm = TypeParam;
  constexpr int N = Arm::kDof;
  for_every_sound_estimator<Arm>([](auto& e) {
    const Vec<N> reference = half_way<Arm>(e, grid(0.8, 1e-3));
    for (const double Ts : {0.25e-3, 0.5e-3, 2e-3}) {
      EXPECT_LT((half_way<Arm>(e, grid(0.8, Ts)) - reference).norm(), 0.02 * 50)
          << "Ts = " << Ts << " s";
    }
  });
}

TYPED_TEST(EveryEstimator, AnswersAlikeWithJitteredTimeStamps) {
  using Arm = TypeParam;
  std::mt19937_64 generator(4);
  std::vector<double> times = grid(0.8, 1e-3);
  for (double& t : times) t += 0.6e-3 * (static_cast<double>(generator() >> 11) * 0x1p-53 - 0.5);
  for_every_sound_estimator<Arm>([&](auto& e) {
    EXPECT_LT((half_way<Arm>(e, times) - half_way<Arm>(e, grid(0.8, 1e-3))).norm(), 0.02 * 50);
  });
}

TYPED_TEST(EveryEstimator, FlagsANaNSampleHoldsAndRecovers) {
  using Arm = TypeParam;
  constexpr int N = Arm::kDof;
  const Samples<N> good = simulate<Arm>(grid(3, 1e-3), constant<N>(20));
  for (const int field : {0, 1, 2}) {
    Samples<N> bad = good;
    (field == 0   ? bad[1000].q
     : field == 1 ? bad[1000].qd
                  : bad[1000].tau)[N / 2] = std::numeric_limits<double>::quiet_NaN();
    for_every_estimator<Arm>([&](auto& e) {
      const auto clean = run(e, good);
      e.reset();
      const auto hit = run(e, bad);
      EXPECT_EQ(hit[1000].status, Status::kBadMeasurement);
      EXPECT_EQ(hit[1000].tau_ext, hit[999].tau_ext);
      EXPECT_EQ(hit[1001].status, Status::kOk);
      EXPECT_LT((hit.back().tau_ext - clean.back().tau_ext).norm(), 0.01) << "N m, 2 s later";
    });
  }
}

TYPED_TEST(EveryEstimator, StartsAnewAfterALongGapAndHoldsItsEstimate) {
  using Arm = TypeParam;
  constexpr int N = Arm::kDof;
  const Samples<N> all = simulate<Arm>(grid(3, 1e-3), constant<N>(20));
  Samples<N> gap(all.begin(), all.begin() + 1000);
  gap.insert(gap.end(), all.begin() + 2000, all.end());
  for_every_sound_estimator<Arm>([&](auto& e) {
    const auto out = run(e, gap);
    EXPECT_EQ(out[1000].status, Status::kStarted);
    EXPECT_EQ(out[1000].tau_ext, out[999].tau_ext);
    EXPECT_EQ(out[1001].status, Status::kOk);
    EXPECT_LT((out.back().tau_ext - Vec<N>::Constant(20)).norm(), 4);
  });
}

TYPED_TEST(EveryEstimator, StaysFiniteWhateverTheSensorsSay) {
  using Arm = TypeParam;
  constexpr int N = Arm::kDof;
  std::mt19937_64 generator(8);
  const auto any = [&] {
    constexpr double kOdd[] = {std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity(),
                               -1e308,
                               2.7e154,
                               9e5,
                               -9e5,
                               1e-308,
                               0,
                               1,
                               -1};
    return kOdd[generator() % std::size(kOdd)];
  };
  Samples<N> samples = simulate<Arm>(grid(2, 1e-3), constant<N>(20));
  for (std::size_t k = 0; k < samples.size(); k += 1 + generator() % 3) {
    auto& y = samples[k];
    (generator() % 4 == 0   ? y.t
     : generator() % 3 == 0 ? y.q[0]
     : generator() % 2      ? y.qd[N / 2]
                            : y.tau[N - 1]) = any();
  }
  for_every_estimator<Arm>([&](auto& e) {
    for (const auto& x : run(e, samples)) ASSERT_TRUE(x.tau_ext.allFinite());
  });
}

TYPED_TEST(EveryEstimator, RepeatsItselfBitForBitAfterAReset) {
  using Arm = TypeParam;
  constexpr int N = Arm::kDof;
  const Samples<N> samples = simulate<Arm>(grid(1, 1e-3), constant<N>(20));
  for_every_estimator<Arm>([&](auto& e) {
    const auto first = run(e, samples);
    e.reset();
    const auto second = run(e, samples);
    for (std::size_t k = 0; k < samples.size(); ++k) ASSERT_EQ(first[k].tau_ext, second[k].tau_ext);
  });
}

// EIGEN_RUNTIME_NO_MALLOC (preset debug) asserts inside Eigen; the counter sees every malloc
template <class Call>
std::uint64_t allocations_of(Call&& call) {
#ifdef EIGEN_RUNTIME_NO_MALLOC
  Eigen::internal::set_is_malloc_allowed(false);
#endif
  const auto before = allocations();
  call();
  const auto after = allocations();
#ifdef EIGEN_RUNTIME_NO_MALLOC
  Eigen::internal::set_is_malloc_allowed(true);
#endif
  return after - before;
}

TYPED_TEST(EveryEstimator, AllocatesNothing) {
  using Arm = TypeParam;
  constexpr int N = Arm::kDof;
  const Samples<N> samples = simulate<Arm>(grid(1, 1e-3), constant<N>(20));
  for_every_estimator<Arm>([&](auto& e) {
    Vec<N> sum = Vec<N>::Zero();
    const auto n = allocations_of([&] {
      e.reset();
      for (const auto& y : samples) sum += e.update(y).tau_ext;
    });
    EXPECT_EQ(n, 0u);
    EXPECT_TRUE(sum.allFinite());
  });
}

template <class Claim>
void for_every_detector(Claim&& claim) {
  int count = 0;
  for_each_detector<3>([&](auto make) {
    using D = decltype(make());
    static_assert(CollisionDetector<D>);
    SCOPED_TRACE(D::kName);
    auto d = make();
    claim(d);
    ++count;
  });
  ASSERT_GE(count, 1);
}

Measurement<3> at(int k) {
  Measurement<3> y;
  y.t = k * 1e-3;
  return y;
}

TEST(EveryDetector, MarksNothingWhileNothingHappens) {
  for_every_detector([](auto& d) {
    for (int k = 0; k < 5000; ++k) ASSERT_FALSE(detect(d, at(k), Vec<3>(1, -2, 3)).mark);
  });
}

TEST(EveryDetector, MarksExactlyWhereItsScoreReachesOne) {
  for_every_detector([](auto& d) {
    int marks = 0;
    for (int k = 0; k < 3000; ++k) {
      const Detection x = detect(d, at(k), Vec<3>(Vec<3>::Constant(k < 1000 ? 0 : 400)));
      if (!x.mark) continue;
      ++marks;
      EXPECT_GE(x.score, 1);
    }
    EXPECT_GE(marks, 1);
    EXPECT_LE(marks, 2) << "a classifier has two kinds";
  });
}

TEST(EveryDetector, AllocatesNothing) {
  for_every_detector([](auto& d) {
    const auto n = allocations_of([&] {
      d.reset();
      for (int k = 0; k < 1000; ++k) detect(d, at(k), Vec<3>(Vec<3>::Constant(k % 10)));
    });
    EXPECT_EQ(n, 0u);
  });
}

}  // namespace
}  // namespace tauext::test

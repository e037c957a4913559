// SPDX-License-Identifier: Apache-2.0
/// @file
/// What every estimator and every detector has to do, whoever wrote it, as GoogleTest checks:
///
///     TEST(Mine, Conforms) {
///       tauext::conformance::check_estimator(tauext::WallMoBot3(), [] { return Mine(); });
///     }
/// Link tauext::conformance, which needs Eigen and GoogleTest and neither MuJoCo nor the rest of tauext.
/// make() builds a fresh one for each claim. An estimator with `static constexpr bool kPrintedForm =
/// true` stands for what somebody printed, and is held to being finite and honest about bad samples only.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <type_traits>
#include <vector>

#include "bench/allocations.h"
#include "estimators/simulated_arm.h"

namespace tauext::conformance {

/// Whether E says of itself that it is a printed form.
template <class E>
constexpr bool is_printed_form = requires {
  E::kPrintedForm;
};

/// Heap allocations of a call; with EIGEN_RUNTIME_NO_MALLOC Eigen's own ones abort.
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

/// The claims on an estimator of `arm`, one by one; check_estimator makes them all.
template <DifferentiableModel M, class Make>
class EstimatorClaims {
 public:
  using E = std::decay_t<std::invoke_result_t<Make>>;
  static_assert(TorqueEstimator<E>,
                "an estimator has kName, kDof, reset() and update(y), noexcept");
  static_assert(E::kDof == M::kDof, "estimator and arm have different numbers of joints");
  static constexpr int N = M::kDof;
  using Samples = std::vector<Measurement<N>>;

  EstimatorClaims(const M& arm, Make make) : arm_(arm), make_(make) {}

  /// +5 N m on every joint is estimated as +5 with the sign of (3), within 0.1 N m after 12 s.
  void has_the_sign_of_equation_3() const {
    SCOPED_TRACE("has the sign of (3)");
    const Vec<N> last = run(steady(12, 5)).back().tau_ext;
    EXPECT_LT((last - Vec<N>::Constant(5)).cwiseAbs().maxCoeff(), 0.1) << last.transpose();
  }

  /// 11 s after a step of 50 N m it is within 0.1 N m of it.
  void ends_up_at_a_step() const {
    SCOPED_TRACE("ends up at a step");
    const auto load = [](double t) -> Vec<N> { return Vec<N>::Constant(t < 1 ? 0 : 50); };
    const auto samples = simulated::simulate<M>(simulated::grid(12, 1e-3), load, {}, arm_);
    const Vec<N> last = run(samples).back().tau_ext;
    EXPECT_LT((last - Vec<N>::Constant(50)).cwiseAbs().maxCoeff(), 0.1) << last.transpose();
  }

  /// Started in motion (0.6 rad/s) without a load: at most 0.1 N m rms and 1 N m at any time.
  void starts_in_motion_without_a_spike() const {
    SCOPED_TRACE("starts in motion without a spike");
    double worst = 0, sum = 0;
    const Samples samples = simulate(simulated::grid(12, 1e-3), 0, {.amplitude = 0.3, .w = 2});
    for (const auto& x : run(samples)) {
      worst = std::max(worst, x.tau_ext.cwiseAbs().maxCoeff());
      sum += x.tau_ext.cwiseAbs2().maxCoeff();
    }
    EXPECT_LE(worst, 1) << "N m";
    EXPECT_LE(std::sqrt(sum / static_cast<double>(samples.size())), 0.1) << "N m rms";
  }

  /// 0.3 s after a step of 50 N m it says the same at 0.25, 0.5, 1 and 2 ms, within 2 % of the step.
  void answers_alike_at_every_sample_time() const {
    SCOPED_TRACE("answers alike at every sample time");
    const Vec<N> reference = half_way(simulated::grid(0.8, 1e-3));
    for (const double Ts : {0.25e-3, 0.5e-3, 2e-3}) {
      EXPECT_LT((half_way(simulated::grid(0.8, Ts)) - reference).norm(), 0.02 * 50)
          << "Ts = " << Ts << " s";
    }
  }

  /// The same with sampling times off the grid by up to 0.3 ms.
  void answers_alike_with_jittered_time_stamps() const {
    SCOPED_TRACE("answers alike with jittered time stamps");
    std::mt19937_64 generator(4);
    std::vector<double> times = simulated::grid(0.8, 1e-3);
    for (double& t : times) t += 0.6e-3 * (uniform(generator) - 0.5);
    const Vec<N> reference = half_way(simulated::grid(0.8, 1e-3));
    EXPECT_LT((half_way(times) - reference).norm(), 0.02 * 50);
  }

  /// Three seconds with a tenth of the samples lost end where those with all of them do, within 2 % of
  /// 20 N m.
  void bears_lost_samples() const {
    SCOPED_TRACE("bears lost samples");
    std::mt19937_64 generator(5);
    const Samples all = steady(3, 20);
    Samples some;
    for (const auto& y : all) {
      if (some.empty() || uniform(generator) > 0.1 || &y == &all.back()) some.push_back(y);
    }
    EXPECT_LT((run(some).back().tau_ext - run(all).back().tau_ext).norm(), 0.02 * 20);
  }

  /// A clock that starts at 1000 s changes nothing, within 1e-6 N m of round-off.
  void does_not_care_when_time_began() const {
    SCOPED_TRACE("does not care when time began");
    Samples late = steady(1, 20);
    const auto early = run(late);
    for (auto& y : late) y.t += 1000;
    EXPECT_LT((run(late).back().tau_ext - early.back().tau_ext).norm(), 1e-6);
  }

  /// A NaN in q, qd or tau: kBadMeasurement, the estimate held to the bit, and as good as new 2 s later.
  void flags_a_bad_sample_holds_and_recovers() const {
    SCOPED_TRACE("flags a bad sample, holds and recovers");
    const Samples good = steady(3, 20);
    const auto clean = run(good);
    for (const int field : {0, 1, 2}) {
      Samples bad = good;
      Measurement<N>& y = bad[1000];
      (field == 0 ? y.q : field == 1 ? y.qd : y.tau)[N / 2] = kNaN;
      const auto hit = run(bad);
      EXPECT_EQ(hit[1000].status, Status::kBadMeasurement);
      EXPECT_EQ(hit[1000].tau_ext, hit[999].tau_ext);
      EXPECT_EQ(hit[1001].status, Status::kOk);
      EXPECT_LT((hit.back().tau_ext - clean.back().tau_ext).norm(), 0.01) << "N m, 2 s later";
    }
  }

  /// A time stamp that stands still or goes back: kBadMeasurement, held, and the rest as without it.
  void ignores_time_that_goes_back() const {
    SCOPED_TRACE("ignores time that goes back");
    const Samples good = steady(1, 20);
    const auto clean = run(good);
    for (const double back : {0., 1e-3, 0.5}) {
      Samples bad = good;
      Measurement<N> y = good[600];
      y.t = good[500].t - back;
      bad.insert(bad.begin() + 501, y);
      const auto hit = run(bad);
      EXPECT_EQ(hit[501].status, Status::kBadMeasurement) << back << " s back";
      EXPECT_EQ(hit[501].tau_ext, hit[500].tau_ext);
      EXPECT_EQ(hit.back().tau_ext, clean.back().tau_ext);
    }
  }

  /// After a second without samples: kStarted, the estimate held, and on from there.
  void starts_anew_after_a_gap() const {
    SCOPED_TRACE("starts anew after a gap");
    const Samples all = steady(3, 20);
    Samples gap(all.begin(), all.begin() + 1000);
    gap.insert(gap.end(), all.begin() + 2000, all.end());
    const auto out = run(gap);
    EXPECT_EQ(out[1000].status, Status::kStarted);
    EXPECT_EQ(out[1000].tau_ext, out[999].tau_ext);
    EXPECT_EQ(out[1001].status, Status::kOk);
    EXPECT_LT((out.back().tau_ext - Vec<N>::Constant(20)).norm(), 4);
  }

  /// Whatever the sensors say, the estimate is finite.
  void stays_finite() const {
    SCOPED_TRACE("stays finite");
    std::mt19937_64 generator(8);
    constexpr double kOdd[] = {
        kNaN, std::numeric_limits<double>::infinity(), -1e308, 2.7e154, 9e5, -9e5, 1e-308, 0, 1,
        -1};
    Samples samples = steady(2, 20);
    for (std::size_t k = 0; k < samples.size(); k += 1 + generator() % 3) {
      auto& y = samples[k];
      (generator() % 4 == 0   ? y.t
       : generator() % 3 == 0 ? y.q[0]
       : generator() % 2      ? y.qd[N / 2]
                              : y.tau[N - 1]) = kOdd[generator() % std::size(kOdd)];
    }
    for (const auto& x : run(samples)) ASSERT_TRUE(x.tau_ext.allFinite());
  }

  /// Bit for bit the same after reset(), and beside another one that sees something else.
  void repeats_itself_alone_and_in_company() const {
    SCOPED_TRACE("repeats itself, alone and in company");
    const Samples samples = steady(1, 20), others = steady(1, -30);
    E e = make_(), other = make_();
    std::vector<Estimate<N>> first;
    for (const auto& y : samples) first.push_back(e.update(y));
    e.reset();
    for (std::size_t k = 0; k < samples.size(); ++k) {
      other.update(others[k]);
      ASSERT_EQ(e.update(samples[k]).tau_ext, first[k].tau_ext) << k;
    }
  }

  /// No heap allocation in reset() and update(); not seen under sanitizers.
  void allocates_nothing() const {
    SCOPED_TRACE("allocates nothing");
    const Samples samples = steady(1, 20);
    E e = make_();
    Vec<N> sum = Vec<N>::Zero();
    EXPECT_EQ(allocations_of([&] {
                e.reset();
                for (const auto& y : samples) sum += e.update(y).tau_ext;
              }),
              0u);
    EXPECT_TRUE(sum.allFinite());
  }

  /// All of them.
  void check() const {
    SCOPED_TRACE(E::kName);
    flags_a_bad_sample_holds_and_recovers();
    stays_finite();
    repeats_itself_alone_and_in_company();
    allocates_nothing();
    if constexpr (!is_printed_form<E>) {
      has_the_sign_of_equation_3();
      ends_up_at_a_step();
      starts_in_motion_without_a_spike();
      answers_alike_at_every_sample_time();
      answers_alike_with_jittered_time_stamps();
      bears_lost_samples();
      does_not_care_when_time_began();
      ignores_time_that_goes_back();
      starts_anew_after_a_gap();
    }
  }

 private:
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

  static double uniform(std::mt19937_64& g) { return static_cast<double>(g() >> 11) * 0x1p-53; }

  Samples simulate(const std::vector<double>& times, double load,
                   const simulated::Motion& motion = {}) const {
    return simulated::simulate<M>(times, simulated::constant<N>(load), motion, arm_);
  }

  Samples steady(double seconds, double load) const {
    return simulate(simulated::grid(seconds, 1e-3), load);
  }

  std::vector<Estimate<N>> run(const Samples& samples) const {
    E e = make_();
    std::vector<Estimate<N>> out;
    for (const auto& y : samples) out.push_back(e.update(y));
    return out;
  }

  // 0.3 s after a step of 50 N m, where an estimator is still under way
  Vec<N> half_way(const std::vector<double>& times) const {
    const auto load = [](double t) -> Vec<N> { return Vec<N>::Constant(t < 0.5 ? 0 : 50); };
    return run(simulated::simulate<M>(times, load, {}, arm_)).back().tau_ext;
  }

  M arm_;
  Make make_;
};

/// Makes every claim on the estimators that make() builds for `arm`.
template <DifferentiableModel M, class Make>
void check_estimator(const M& arm, Make make) {
  EstimatorClaims<M, Make>(arm, make).check();
}

/// The claims on a detector, one by one; check_detector makes them all.
template <class Make>
class DetectorClaims {
 public:
  using D = std::decay_t<std::invoke_result_t<Make>>;
  static_assert(CollisionDetector<D>, "a detector has kName, kDof, reset() and update(), noexcept");
  static constexpr int N = D::kDof;

  explicit DetectorClaims(Make make) : make_(make) {}

  /// A steady load of 1 N m is no reason for a mark.
  void leaves_rest_in_peace() const {
    SCOPED_TRACE("leaves rest in peace");
    D d = make_();
    for (int k = 0; k < 5000; ++k) ASSERT_FALSE(step(d, k, 1).mark);
  }

  /// A blow of 400 N m or a clamping of 400 N m in 0.75 s, which stays, is marked.
  void marks_a_blow_or_a_clamping() const {
    SCOPED_TRACE("marks a blow or a clamping");
    int marks = 0;
    for (const bool clamping : {false, true}) {
      for (const Detection& x : run([&](double t) { return touch(t, clamping); })) marks += x.mark;
    }
    EXPECT_GE(marks, 1);
  }

  /// A mark comes with a score of 1 or more, and a score is a number of at least 0.
  void marks_where_its_score_reaches_one() const {
    SCOPED_TRACE("marks where its score reaches 1");
    for (const bool clamping : {false, true}) {
      for (const Detection& x : run([&](double t) { return touch(t, clamping); })) {
        ASSERT_TRUE(std::isfinite(x.score) && x.score >= 0);
        if (!x.mark) continue;
        EXPECT_GE(x.score, 1);
        EXPECT_NE(x.contact, Contact::kNone) << "a mark says what it is for";
      }
    }
  }

  /// What it says of tau_ext it says of -tau_ext, of a later clock, after reset() and in company.
  void says_the_same_of_the_same() const {
    SCOPED_TRACE("says the same of the same");
    const auto load = [](double t) { return touch(t, t > 2.5); };
    const auto first = run(load);
    EXPECT_EQ(marks_of(run([&](double t) { return -load(t); })), marks_of(first)) << "-tau_ext";
    EXPECT_EQ(marks_of(run(load, 1024)), marks_of(first)) << "1024 s later";
    D d = make_(), other = make_();
    for (int k = 0; k < 100; ++k) step(d, k, 500. * k);
    d.reset();
    for (int k = 0; k < kSamples; ++k) {
      step(other, k, 300. * (k % 2));
      const Detection x = step(d, k, load(k * kTs));
      ASSERT_EQ(x.mark, first[k].mark) << k;
      ASSERT_EQ(x.score, first[k].score) << k;
    }
  }

  /// A time stamp that is no number or does not increase is ignored.
  void ignores_bad_time_stamps() const {
    SCOPED_TRACE("ignores bad time stamps");
    const auto load = [](double t) { return touch(t, t > 2.5); };
    const auto first = run(load);
    D d = make_();
    for (int k = 0; k < kSamples; ++k) {
      const Detection x = step(d, k, load(k * kTs));
      ASSERT_EQ(x.mark, first[k].mark) << k;
      for (const double t : {std::numeric_limits<double>::quiet_NaN(), (k - 1) * kTs, -1e300}) {
        Measurement<N> y;
        y.t = t;
        ASSERT_FALSE(detect(d, y, Vec<N>(Vec<N>::Constant(1000))).mark) << "t = " << t;
      }
    }
  }

  /// A speed that is no number is nobody's collision, and does not hide the one that follows.
  void bears_a_speed_that_is_no_number() const {
    SCOPED_TRACE("bears a speed that is no number");
    for (int j = 0; j < N; ++j) {
      D d = make_();
      int marks = 0;
      for (int k = 0; k < kSamples; ++k) {
        const double t = k * kTs;
        Measurement<N> y;
        y.t = t;
        if (k == 1005 || k == 3100) y.qd[j] = std::numeric_limits<double>::quiet_NaN();
        const double load = touch(t, t > 2.5);
        const Detection x = detect(d, y, Vec<N>(Vec<N>::Constant(load)));
        ASSERT_TRUE(std::isfinite(x.score)) << k;
        marks += x.mark;
      }
      EXPECT_GE(marks, 1);
    }
  }

  /// Twice the tau_ext gives at least 2^kDegree times the statistic.
  void has_the_degree_that_it_says() const requires CalibratableDetector<D> {
    SCOPED_TRACE("has the degree that it says");
    D one = make_(), two = make_();
    // small, so that nothing saturates
    for (int k = 0; k < kSamples; ++k) {
      const double x = 0.01 * touch(k * kTs, k * kTs > 2.5);
      step(one, k, x);
      step(two, k, 2 * x);
      const Vec<N> least = std::pow(2, D::kDegree) * Vec<N>(one.statistic());
      for (int j = 0; j < N; ++j) {
        ASSERT_GE(Vec<N>(two.statistic())[j], least[j] * (1 - 1e-9)) << "sample " << k;
      }
    }
  }

  /// No heap allocation in reset() and update(); not seen under sanitizers.
  void allocates_nothing() const {
    SCOPED_TRACE("allocates nothing");
    D d = make_();
    EXPECT_EQ(allocations_of([&] {
                d.reset();
                for (int k = 0; k < 1000; ++k) step(d, k, k % 10);
              }),
              0u);
  }

  /// All of them.
  void check() const {
    SCOPED_TRACE(D::kName);
    leaves_rest_in_peace();
    marks_a_blow_or_a_clamping();
    marks_where_its_score_reaches_one();
    says_the_same_of_the_same();
    ignores_bad_time_stamps();
    bears_a_speed_that_is_no_number();
    if constexpr (CalibratableDetector<D>) has_the_degree_that_it_says();
    allocates_nothing();
  }

 private:
  static constexpr double kTs = 1e-3;  // [s]
  static constexpr int kSamples = 6000;

  // a half sine of 30 ms at 1 s, or a straight line at 3 s that stays; through 50 rad/s it would be
  // what an estimator makes of it, and detectors must bear it without
  static double touch(double t, bool clamping) {
    if (clamping) return t < 3 ? 0 : 400 * std::min(1., (t - 3) / 0.75);
    return t < 1 || t >= 1.03 ? 0 : 400 * std::sin(3.141592653589793 * (t - 1) / 0.03);
  }

  static Detection step(D& d, int k, double load, double shift = 0) {
    Measurement<N> y;
    y.t = k * kTs + shift;
    y.qd = Vec<N>::Constant(0.1);
    return detect(d, y, Vec<N>(Vec<N>::Constant(load)));
  }

  template <class Load>
  std::vector<Detection> run(Load&& load, double shift = 0) const {
    D d = make_();
    std::vector<Detection> out;
    for (int k = 0; k < kSamples; ++k) out.push_back(step(d, k, load(k * kTs), shift));
    return out;
  }

  static std::vector<int> marks_of(const std::vector<Detection>& all) {
    std::vector<int> at;
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (all[k].mark) at.push_back(static_cast<int>(k));
    }
    return at;
  }

  Make make_;
};

/// Makes every claim on the detectors that make() builds.
template <class Make>
void check_detector(Make make) {
  DetectorClaims<Make>(make).check();
}

}  // namespace tauext::conformance

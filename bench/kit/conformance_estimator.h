// SPDX-License-Identifier: Apache-2.0
/// @file
/// The claims on estimators of bench/kit/conformance.h.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <type_traits>
#include <vector>

#include "bench/kit/allocations.h"
#include "bench/kit/conformance_faults.h"
#include "bench/kit/simulated_arm.h"

namespace tauext::conformance {

/// Whether E says of itself that it is a printed form.
template <class E>
constexpr bool is_printed_form = requires {
  E::kPrintedForm;
};

/// The claims on an estimator of `arm`, one by one; check_estimator makes them all.
template <RobotModel M, class Make>
class EstimatorClaims {
 public:
  using E = std::decay_t<std::invoke_result_t<Make>>;  ///< the estimator
  static_assert(TorqueEstimator<E>,
                "an estimator has kName, kDof, reset() and update(y), noexcept");
  static_assert(E::kDof == M::kDof, "estimator and arm have different numbers of joints");
  static constexpr int N = M::kDof;             ///< joints
  using Samples = std::vector<Measurement<N>>;  ///< of a run

  /// On what make() builds for this arm.
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
    const auto samples = simulated_arm::simulate<M>(simulated_arm::grid(12, 1e-3), load, {}, arm_);
    const Vec<N> last = run(samples).back().tau_ext;
    EXPECT_LT((last - Vec<N>::Constant(50)).cwiseAbs().maxCoeff(), 0.1) << last.transpose();
  }

  /// Started in motion (0.6 rad/s) without a load: at most 0.1 N m rms and 1 N m at any time.
  void starts_in_motion_without_a_spike() const {
    SCOPED_TRACE("starts in motion without a spike");
    double worst = 0, sum = 0;
    const Samples samples = simulate(simulated_arm::grid(12, 1e-3), 0, {.amplitude = 0.3, .w = 2});
    for (const auto& x : run(samples)) {
      worst = std::max(worst, x.tau_ext.cwiseAbs().maxCoeff());
      sum += x.tau_ext.cwiseAbs2().maxCoeff();
    }
    EXPECT_LE(worst, 1) << "N m";
    EXPECT_LE(std::sqrt(sum / static_cast<double>(samples.size())), 0.1) << "N m rms";
  }

  /// 0.3 s after a step of 50 N m it says the same at 0.25, 0.5, 1 and 2 ms, within 2 % of the
  /// step.
  void answers_alike_at_every_sample_time() const {
    SCOPED_TRACE("answers alike at every sample time");
    const Vec<N> reference = half_way(simulated_arm::grid(0.8, 1e-3));
    for (const double Ts : {0.25e-3, 0.5e-3, 2e-3}) {
      EXPECT_LT((half_way(simulated_arm::grid(0.8, Ts)) - reference).norm(), 0.02 * 50)
          << "Ts = " << Ts << " s";
    }
  }

  /// The same with sampling times off the grid by up to 0.3 ms.
  void answers_alike_with_jittered_time_stamps() const {
    SCOPED_TRACE("answers alike with jittered time stamps");
    std::mt19937_64 generator(4);
    std::vector<double> times = simulated_arm::grid(0.8, 1e-3);
    for (double& t : times) t += 0.6e-3 * (uniform(generator) - 0.5);
    const Vec<N> reference = half_way(simulated_arm::grid(0.8, 1e-3));
    EXPECT_LT((half_way(times) - reference).norm(), 0.02 * 50);
  }

  /// Three seconds with a tenth of the samples lost end where those with all of them do, within 2 %
  /// of 20 N m.
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

  /// A NaN in q, qd or tau: kBadMeasurement, the estimate held to the bit, and as good as new 2 s
  /// later.
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

  /// A time stamp that stands still or goes back: kBadTime, held, and the rest as without it.
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
      EXPECT_EQ(hit[501].status, Status::kBadTime) << back << " s back";
      EXPECT_EQ(hit[501].tau_ext, hit[500].tau_ext);
      EXPECT_EQ(hit.back().tau_ext, clean.back().tau_ext);
    }
  }

  /// After a second without samples: the estimate held, kStarted within three samples, and on from
  /// there.
  void starts_anew_after_a_gap() const {
    SCOPED_TRACE("starts anew after a gap");
    const Samples all = steady(3, 20);
    Samples gap(all.begin(), all.begin() + 1000);
    gap.insert(gap.end(), all.begin() + 2000, all.end());
    const auto out = run(gap);
    std::size_t k = 1000;
    for (; out[k].status == Status::kBadTime; ++k) EXPECT_EQ(out[k].tau_ext, out[999].tau_ext);
    EXPECT_LT(k, 1003u);
    EXPECT_EQ(out[k].status, Status::kStarted);
    EXPECT_EQ(out[k].tau_ext, out[999].tau_ext);
    EXPECT_EQ(out[k + 1].status, Status::kOk);
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
    E e = made(), other = made();
    std::vector<Estimate<N>> first;
    for (const auto& y : samples) first.push_back(step(e, y));
    e.reset();
    for (std::size_t k = 0; k < samples.size(); ++k) {
      step(other, others[k]);
      ASSERT_EQ(step(e, samples[k]).tau_ext, first[k].tau_ext) << k;
    }
  }

  /// No heap allocation in reset() and update(); not seen under sanitizers.
  void allocates_nothing() const {
    SCOPED_TRACE("allocates nothing");
    const Samples samples = steady(1, 20);
    E e = made();
    Vec<N> sum = Vec<N>::Zero();
    EXPECT_EQ(allocations_of([&] {
                e.reset();
                for (const auto& y : samples) sum += step(e, y).tau_ext;
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
      FaultClaims<M, Make>(arm_, make_).check();
    }
  }

 private:
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

  static double uniform(std::mt19937_64& g) { return static_cast<double>(g() >> 11) * 0x1p-53; }

  // not inlined: a copy in each claim would take long to compile
  [[gnu::noinline]] static Estimate<N> step(E& e, const Measurement<N>& y) { return e.update(y); }
  [[gnu::noinline]] E made() const { return make_(); }

  Samples simulate(const std::vector<double>& times, double load,
                   const simulated_arm::Motion& motion = {}) const {
    return simulated_arm::simulate<M>(times, simulated_arm::constant<N>(load), motion, arm_);
  }

  Samples steady(double seconds, double load) const {
    return simulate(simulated_arm::grid(seconds, 1e-3), load);
  }

  std::vector<Estimate<N>> run(const Samples& samples) const {
    E e = made();
    std::vector<Estimate<N>> out;
    for (const auto& y : samples) out.push_back(step(e, y));
    return out;
  }

  // 0.3 s after a step of 50 N m, where an estimator is still under way
  Vec<N> half_way(const std::vector<double>& times) const {
    const auto load = [](double t) -> Vec<N> { return Vec<N>::Constant(t < 0.5 ? 0 : 50); };
    return run(simulated_arm::simulate<M>(times, load, {}, arm_)).back().tau_ext;
  }

  M arm_;
  Make make_;
};

/// Makes every claim on the estimators that make() builds for `arm`.
template <RobotModel M, class Make>
void check_estimator(const M& arm, Make make) {
  EstimatorClaims<M, Make>(arm, make).check();
}

}  // namespace tauext::conformance

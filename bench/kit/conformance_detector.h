// SPDX-License-Identifier: Apache-2.0
/// @file
/// The claims on detectors of bench/kit/conformance.h.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <vector>

#include "bench/kit/allocations.h"
#include "estimators/concepts.h"
#include "estimators/detectors/marking.h"
#include "estimators/math/pack.h"

namespace tauext::conformance {

/// The claims on a detector, one by one; check_detector makes them all.
template <class Make>
class DetectorClaims {
 public:
  using D = std::decay_t<std::invoke_result_t<Make>>;  ///< the detector
  static_assert(CollisionDetector<D>, "a detector has kName, reset() and update(), noexcept");

  /// On what make() builds, for so many joints.
  DetectorClaims(Make make, int joints) : make_(make), joints_(joints) {}

  /// A steady load of 1 N m is no reason for a mark.
  void leaves_rest_in_peace() const {
    SCOPED_TRACE("leaves rest in peace");
    D d = made();
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
    D d = made(), other = made();
    for (int k = 0; k < 100; ++k) step(d, k, 500. * k);
    d.reset();
    for (int k = 0; k < kSamples; ++k) {
      step(other, k, 300. * (k % 2));
      const Detection x = step(d, k, load(k * kTs));
      ASSERT_EQ(x.mark, first[k].mark) << k;
      ASSERT_EQ(x.score, first[k].score) << k;
    }
  }

  /// Of each of several runs at once it says what it says of that one alone.
  void bears_company() const requires DetectsRuns<D> {
    SCOPED_TRACE("bears company");
    using Lanes = Pack<kRuns>;
    using OfRuns = typename D::template For<Lanes>;
    OfRuns all(joints_, made().parameters());
    std::vector<D> alone;
    for (int i = 0; i < kRuns; ++i) alone.push_back(made());
    int marks = 0;
    for (int k = 0; k < kSamples; ++k) {
      if (k > 4000 && k < 4080) continue;             // a gap
      const double t = (k == 4500 ? 3000 : k) * kTs;  // a time that is not the next one
      const JointVec<Lanes> none = JointVec<Lanes>::Zero(joints_);
      JointVec<Lanes> speeds = none, loads = none;
      std::array<Detection, kRuns> one_by_one;
      for (int i = 0; i < kRuns; ++i) {
        JointVec<> qd = zero(), load = zero();
        for (int j = 0; j < joints_; ++j) {
          qd[j] = 0.1 * i - 0.2 * j;
          load[j] = (0.3 + 0.4 * i) * touch(t, t > 2.5) / (1 + j) + std::sin(t * (20 + i + j));
          speeds[j].set(i, qd[j]);
          loads[j].set(i, load[j]);
        }
        one_by_one[static_cast<std::size_t>(i)] =
            detect(alone[static_cast<std::size_t>(i)], t, qd, zero(), load);
      }
      const RunsDetection<Lanes> at_once = detect<Lanes>(all, t, speeds, none, loads);
      for (int i = 0; i < kRuns; ++i) {
        const Detection& x = one_by_one[static_cast<std::size_t>(i)];
        ASSERT_EQ(at_once.mark[i], x.mark) << "run " << i << ", sample " << k;
        ASSERT_EQ(static_cast<Contact>(at_once.contact[i]), x.contact) << i << ", " << k;
        ASSERT_NEAR(at_once.score[i], x.score, 1e-12 * (1 + x.score)) << i << ", " << k;
        marks += x.mark;
        if constexpr (CalibratableDetector<D>) {
          for (int j = 0; j < joints_; ++j) {
            const double own = JointVec<>(alone[static_cast<std::size_t>(i)].statistic())[j];
            ASSERT_NEAR(all.statistic()[j][i], own, 1e-12 * (1 + own)) << i << ", " << k;
          }
        }
      }
    }
    EXPECT_GE(marks, 2);
  }

  /// A time stamp that is no number or does not increase is ignored.
  void ignores_bad_time_stamps() const {
    SCOPED_TRACE("ignores bad time stamps");
    const auto load = [](double t) { return touch(t, t > 2.5); };
    const auto first = run(load);
    D d = made();
    for (int k = 0; k < kSamples; ++k) {
      const Detection x = step(d, k, load(k * kTs));
      ASSERT_EQ(x.mark, first[k].mark) << k;
      for (const double t : {std::numeric_limits<double>::quiet_NaN(), (k - 1) * kTs, -1e300}) {
        ASSERT_FALSE(step(d, t, zero(), 1000).mark) << "t = " << t;
      }
    }
  }

  /// A speed that is no number is nobody's collision, and does not hide the one that follows.
  void bears_a_speed_that_is_no_number() const {
    SCOPED_TRACE("bears a speed that is no number");
    for (int j = 0; j < joints_; ++j) {
      D d = made();
      int marks = 0;
      for (int k = 0; k < kSamples; ++k) {
        const double t = k * kTs;
        JointVec<> qd = JointVec<>::Constant(joints_, kSpeed);
        if (k == 1005 || k == 3100) qd[j] = std::numeric_limits<double>::quiet_NaN();
        const double load = touch(t, t > 2.5);
        const Detection x = step(d, t, qd, load);
        ASSERT_TRUE(std::isfinite(x.score)) << k;
        marks += x.mark;
      }
      EXPECT_GE(marks, 1);
    }
  }

  /// Twice the tau_ext gives at least 2^kDegree times the statistic.
  void has_the_degree_that_it_says() const requires CalibratableDetector<D> {
    SCOPED_TRACE("has the degree that it says");
    D one = made(), two = made();
    // small, so that nothing saturates
    for (int k = 0; k < kSamples; ++k) {
      const double x = 0.01 * touch(k * kTs, k * kTs > 2.5);
      step(one, k, x);
      step(two, k, 2 * x);
      const JointVec<> least = std::pow(2, D::kDegree) * JointVec<>(one.statistic());
      for (int j = 0; j < joints_; ++j) {
        ASSERT_GE(JointVec<>(two.statistic())[j], least[j] * (1 - 1e-9)) << "sample " << k;
      }
    }
  }

  /// The statistic is the same for -tau_ext, and 0 after reset().
  void has_a_statistic_without_sign_or_memory() const requires CalibratableDetector<D> {
    SCOPED_TRACE("has a statistic without sign or memory");
    D d = made(), mirrored = made();
    for (int k = 0; k < kSamples; ++k) {
      const double x = 0.01 * touch(k * kTs, k * kTs > 2.5);
      step(d, k, x);
      step(mirrored, k, -x);
      ASSERT_EQ(JointVec<>(mirrored.statistic()), JointVec<>(d.statistic())) << "sample " << k;
    }
    d.reset();
    EXPECT_EQ(JointVec<>(d.statistic()), zero());
  }

  /// No heap allocation in reset() and update(); not seen under sanitizers.
  void allocates_nothing() const {
    SCOPED_TRACE("allocates nothing");
    D d = made();
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
    if constexpr (DetectsRuns<D>) bears_company();
    ignores_bad_time_stamps();
    bears_a_speed_that_is_no_number();
    if constexpr (CalibratableDetector<D>) {
      has_the_degree_that_it_says();
      has_a_statistic_without_sign_or_memory();
    }
    allocates_nothing();
  }

 private:
  static constexpr double kTs = 1e-3;    // [s]
  static constexpr double kSpeed = 0.1;  // [rad/s]
  static constexpr int kSamples = 6000;

  // a half sine of 30 ms at 1 s, or a straight line at 3 s that stays; through 50 rad/s it would be
  // what an estimator makes of it, and detectors must bear it without
  static double touch(double t, bool clamping) {
    if (clamping) return t < 3 ? 0 : 400 * std::min(1., (t - 3) / 0.75);
    return t < 1 || t >= 1.03 ? 0 : 400 * std::sin(3.141592653589793 * (t - 1) / 0.03);
  }

  // not inlined: a copy in each claim would take long to compile
  [[gnu::noinline]] D made() const { return make_(); }
  [[gnu::noinline]] Detection step(D& d, double t, const JointVec<>& qd, double load) const {
    const JointVec<> tau_ext = JointVec<>::Constant(joints_, load);
    return detect(d, t, qd, zero(), tau_ext);
  }

  Detection step(D& d, int k, double load, double shift = 0) const {
    return step(d, k * kTs + shift, JointVec<>::Constant(joints_, kSpeed), load);
  }

  JointVec<> zero() const { return JointVec<>::Zero(joints_); }

  template <class Load>
  std::vector<Detection> run(Load&& load, double shift = 0) const {
    D d = made();
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
  int joints_;
};

/// Makes every claim on the detectors that make() builds for so many joints.
template <class Make>
void check_detector(Make make, int joints) {
  DetectorClaims<Make>(make, joints).check();
}

}  // namespace tauext::conformance

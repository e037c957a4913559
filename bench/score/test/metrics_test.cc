// SPDX-License-Identifier: Apache-2.0
// Metrics on signals whose answer is known by hand.
#include "bench/score/metrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "bench/score/detection_metrics.h"
#include "mjcf/trace/read/recording.h"

namespace tauext::test {
namespace {

using namespace metrics;  // NOLINT(google-build-using-namespace)
using Eigen::RowVectorXd;

Times times(int n, double Ts = 1e-3) {
  Times t(n);
  for (int k = 0; k < n; ++k) t[k] = k * Ts;
  return t;
}

template <class F>
RowVectorXd signal(const Times& t, F&& f) {
  RowVectorXd x(t.size());
  for (std::size_t k = 0; k < t.size(); ++k) x[k] = f(t[k]);
  return x;
}

TEST(ErrorMetrics, OfFourSamples) {
  const Times t = times(4, 1);
  const RowVectorXd truth = (RowVectorXd(4) << 0, 0, 10, 10).finished(),
                    estimate = (RowVectorXd(4) << 100, 3, 6, 10).finished();
  EXPECT_DOUBLE_EQ(rmse(t, truth, estimate, 1), std::sqrt((9. + 16 + 0) / 3));
  EXPECT_DOUBLE_EQ(bias(t, truth, estimate, 1), (3. - 4 + 0) / 3);
  EXPECT_DOUBLE_EQ(max_error(t, truth, estimate, 1), 4);
  EXPECT_DOUBLE_EQ(max_error(t, truth, estimate, 0), 100) << "the start counts if asked";
  EXPECT_DOUBLE_EQ(time_of_max_error(t, truth, estimate, 1), t[2]);
  for (const auto& of_none : {time_of_max_error, rmse, bias, max_error})
    EXPECT_TRUE(std::isnan(of_none(t, truth, estimate, 100)));
}

TEST(Noise, IsTheDeviationOfTheDifferenceWithoutItsMean) {
  const Times t = times(4, 1);
  const RowVectorXd ideal = RowVectorXd::Zero(4), noisy = (RowVectorXd(4) << 7, 3, 7, 3).finished();
  EXPECT_DOUBLE_EQ(noise(t, ideal, noisy, 0), 2);
}

// the answer of a first-order filter of bandwidth K to a step from a to b at 1 s
RowVectorXd first_order(const Times& t, double K, double a, double b) {
  return signal(t, [=](double s) { return s < 1 ? a : b + (a - b) * std::exp(-K * (s - 1)); });
}
RowVectorXd step(const Times& t, double a, double b) {
  return signal(t, [=](double s) { return s < 1 ? a : b; });
}

TEST(StepResponse, OfAFirstOrderFilterIsInClosedForm) {
  const Times t = times(5000);
  for (const auto& [a, b] : {std::pair(0., 98.2), std::pair(20., -30.)}) {
    const StepResponse r = step_response(t, step(t, a, b), first_order(t, 10, a, b));
    EXPECT_NEAR(r.rise, std::log(9) / 10, 1e-5) << "straight lines between samples leave h^2 K / 8";
    EXPECT_NEAR(r.rise_0_90, std::log(10) / 10, 1e-5);
    EXPECT_NEAR(r.settling, std::log(50) / 10, 1e-5);
    EXPECT_EQ(r.overshoot, 0);
  }
}

TEST(StepResponse, OfASecondOrderFilterOvershootsByItsDamping) {
  // zeta = 0.5: overshoot exp(-pi zeta / sqrt(1 - zeta^2)) = 16.3 %
  const Times t = times(5000);
  const double w = 10, zeta = 0.5, wd = w * std::sqrt(1 - zeta * zeta);
  const RowVectorXd x = signal(t, [=](double s) {
    const double u = s - 1;
    return u < 0 ? 0
                 : 1 - std::exp(-zeta * w * u) *
                           (std::cos(wd * u) + zeta * w / wd * std::sin(wd * u));
  });
  EXPECT_NEAR(step_response(t, step(t, 0, 1), x).overshoot,
              100 * std::exp(-M_PI * zeta / std::sqrt(1 - zeta * zeta)), 0.01);
}

TEST(StepResponse, EndsWhereTheTruthJumpsAgain) {
  const Times t = times(5000);
  const RowVectorXd truth = signal(t, [](double s) { return s < 1 || s >= 3 ? 0. : 5.; });
  const RowVectorXd x = signal(t, [](double s) {
    if (s < 1) return 0.;
    return s < 3 ? 5 * (1 - std::exp(-10 * (s - 1))) : 20 * std::exp(-10 * (s - 3));
  });
  const StepResponse r = step_response(t, truth, x);
  EXPECT_NEAR(r.settling, std::log(50) / 10, 1e-5);
  EXPECT_EQ(r.overshoot, 0) << "20 N m come after the end";
}

TEST(StepResponse, OfThePerfectEstimateIsZero) {
  const Times t = times(3000);
  const StepResponse r = step_response(t, step(t, 0, 5), step(t, 0, 5));
  EXPECT_EQ(r.rise, 0);
  EXPECT_EQ(r.rise_0_90, 0);
  EXPECT_EQ(r.settling, 0);
}

TEST(StepResponse, OfAnEstimateThatNeverArrivesIsNaN) {
  const Times t = times(3000);
  const StepResponse r = step_response(t, step(t, 0, 5), step(t, 0, 4));
  EXPECT_TRUE(std::isnan(r.rise));
  EXPECT_TRUE(std::isnan(r.settling));
  EXPECT_TRUE(std::isnan(step_response(t, step(t, 5, 5), step(t, 0, 4)).rise))
      << "no step, no answer";
}

TEST(Lag, OfASineIsTheFirstDelayThatFitsNotOnePeriodMore) {
  const Times t = times(10000);
  for (const double w : {1., 3.5, 5., 20., 60., 250., 300.}) {
    const RowVectorXd truth = signal(t, [=](double s) { return std::sin(w * s); }),
                      late = signal(t, [=](double s) { return std::sin(w * (s - 0.01)); });
    EXPECT_NEAR(lag(t, truth, late, 0), 0.01, 1e-9) << w;
  }
}

TEST(Lag, OfADelayedSignalIsExactlyItsDelay) {
  const Times t = times(20000);
  const auto truth = [](double s) { return 10 * std::sin(s) + 5 * std::cos(2 * s); };
  for (const int delay : {0, 1, 17, 400, 1999}) {
    const RowVectorXd late = signal(t, [&](double s) { return truth(s - delay * 1e-3); });
    EXPECT_NEAR(lag(t, signal(t, truth), late, 3), delay * 1e-3, 1e-12);
  }
}

// size sin(w t), later by delay [s], with white noise
RowVectorXd noisy(const Times& t, double size, double w, double delay, double sigma) {
  static std::mt19937 random(1);
  std::normal_distribution<double> noise(0, sigma);
  return signal(t, [&](double s) { return size * std::sin(w * (s - delay)) + noise(random); });
}

TEST(Lag, UnderNoiseErrsLittleMoreThanTheBestEstimateOfADelayCan) {
  const Times t = times(10000);
  const RowVectorXd truth = signal(t, [](double s) { return 10 * std::sin(s); });
  double e = 0;  // [s] root of the sum of squares
  for (int i = 0; i < 20; ++i) e = std::hypot(e, lag(t, truth, noisy(t, 10, 1, .2, 5), 0) - .2);
  EXPECT_LT(e / std::sqrt(20), 1.5 * 5 / (10 * std::sqrt(8000 / 2.))) << "Cramer and Rao";
}

TEST(Lag, IsNoneWhereNoiseHidesTheTruth) {
  const Times t = times(10000);
  const auto truth = signal(t, [](double s) { return std::sin(20 * s); });
  EXPECT_TRUE(std::isnan(lag(t, truth, noisy(t, 1, 20, 0.05, 100), 0)));
}

TEST(Lag, ABiasDoesNotHideIt) {
  const Times t = times(10000);
  const RowVectorXd truth = signal(t, [](double s) { return std::sin(2.5 * M_PI * s); }),
                    late =
                        signal(t, [](double s) { return 5 + std::sin(2.5 * M_PI * (s - 0.05)); });
  EXPECT_NEAR(lag(t, truth, late, 0), 0.05, 1e-9);
}

TEST(Lag, OfAFirstOrderFilterOnARampIsOneOverItsBandwidth) {
  const Times t = times(20000);
  const RowVectorXd truth = signal(t, [](double s) { return 5 * s; });
  const RowVectorXd late =
      signal(t, [](double s) { return 5 * (s - (1 - std::exp(-20 * s)) / 20); });
  EXPECT_NEAR(lag(t, truth, late, 3), 1. / 20, 1e-9);
}

TEST(Lag, OfAnAnswerThatIsNoneIsNaN) {
  const Times t = times(20000);
  const RowVectorXd moving = signal(t, [](double s) { return std::sin(s); }),
                    still = RowVectorXd::Zero(20000);
  EXPECT_TRUE(std::isnan(lag(t, moving, still, 0)));
  EXPECT_TRUE(std::isnan(lag(t, still, moving, 0)));
  EXPECT_TRUE(std::isnan(lag(times(100), moving.head(100), moving.head(100), 0)))
      << "too short to tell";
}

std::vector<std::uint8_t> flags(int n, std::initializer_list<std::pair<int, int>> ranges) {
  std::vector<std::uint8_t> f(n, 0);
  for (const auto& [first, last] : ranges) std::fill(f.begin() + first, f.begin() + last + 1, 1);
  return f;
}

TEST(DetectionScore, CountsEachCollisionOnceAndTheRestAsFalse) {
  // two collisions; the first marked after 15 ms and again (no matter), the second missed; one mark
  // before everything and one 0.3 s after the first contact are false
  const Times t = times(3600);
  const auto contact = flags(3600, {{1000, 1019}, {2000, 2019}});
  const auto marks = flags(3600, {{100, 100}, {1015, 1015}, {1100, 1100}, {1320, 1320}});
  const DetectionScore s = detection_score(t, contact, marks);
  EXPECT_EQ(s.collisions, 2);
  EXPECT_EQ(s.detected, 1);
  EXPECT_DOUBLE_EQ(s.delay, t[1015] - t[1000]);
  EXPECT_EQ(s.false_alarms, 2);
  EXPECT_NEAR(s.false_alarms_per_hour, 2 * 3600 / 3.599, 1e-9);
}

// an arm that was stopped 15 ms after the first contact touches again twice, 0.18 s apart each time
// one row that strayed hours away in a recording of a minute, and an hour's break in the middle
TEST(DetectionScore, RatesCountTheTimeThatWasWatched) {
  for (const bool at_begin : {false, true}) {
    std::vector<double> t;
    if (at_begin) t.push_back(-3 * 3600);
    for (int k = 0; k <= 60000; ++k) t.push_back(1e-3 * k + (k > 20000 ? 3600 : 0));
    if (!at_begin) t.push_back(9 * 3600);
    std::vector<std::uint8_t> marks(t.size(), 0);
    for (const std::size_t k : {5000, 25000, 45000}) marks[k] = 1;
    const DetectionScore s = detection_score(t, std::vector<std::uint8_t>(t.size(), 0), marks);
    EXPECT_EQ(s.false_alarms, 3);
    EXPECT_NEAR(s.watched, 60, 0.01) << "a few steps, until a clock is trusted, are lost";
    EXPECT_NEAR(s.false_alarms_per_hour, 180, 0.1);
  }
}

// touches on purpose from 1 to 1.5 s, which is marked twice, and from 2 to 2.5 s, which is not;
// marks 0.1 s behind the first and 0.3 s behind the second; a collision at 3 s
TEST(DetectionScore, ATouchOnPurposeIsNeitherCollisionNorFalseAlarm) {
  const Times t = times(3600);
  std::vector<std::uint8_t> contact = flags(3600, {{1000, 1499}, {2000, 2499}});
  std::replace(contact.begin(), contact.end(), std::uint8_t{1}, kIntended);
  std::fill(contact.begin() + 3000, contact.begin() + 3020, 1);
  const auto marks = flags(3600, {{1100, 1101}, {1600, 1600}, {2800, 2800}, {3010, 3010}});
  const DetectionScore s = detection_score(t, contact, marks);
  EXPECT_EQ(s.collisions, 1);
  EXPECT_EQ(s.detected, 1);
  EXPECT_DOUBLE_EQ(s.delay, t[3010] - t[3000]);
  EXPECT_EQ(s.false_alarms, 1);
  EXPECT_EQ(s.intended, 2);
  EXPECT_EQ(s.intended_marked, 1);
  EXPECT_NEAR(s.watched, 3.599 - 2 * 0.7, 3e-3) << "with the grace behind each";
}

TEST(DetectionScore, ReboundsWithinTheGraceAreTheSameCollision) {
  const Times t = times(3000);
  const auto contact = flags(3000, {{1000, 1019}, {1200, 1209}, {1390, 1399}});
  const DetectionScore s = detection_score(t, contact, flags(3000, {{1015, 1015}}));
  EXPECT_EQ(s.collisions, 1);
  EXPECT_EQ(s.detected, 1);
  EXPECT_DOUBLE_EQ(s.delay, t[1015] - t[1000]);
  EXPECT_EQ(s.false_alarms, 0);
}

TEST(DetectionScore, AMarkAtTheReboundIsLateByTheTimeFromTheFirstContact) {
  const Times t = times(3000);
  const auto contact = flags(3000, {{1000, 1019}, {1200, 1209}});
  const DetectionScore s = detection_score(t, contact, flags(3000, {{1205, 1205}, {1500, 1500}}));
  EXPECT_EQ(s.collisions, 1);
  EXPECT_DOUBLE_EQ(s.delay, t[1205] - t[1000]);
  EXPECT_EQ(s.false_alarms, 1) << "0.29 s after the last contact";
}

TEST(DetectionScore, AContactBeyondTheGraceIsAnotherCollision) {
  const Times t = times(3000);
  const auto contact = flags(3000, {{1000, 1019}, {1221, 1230}});
  const DetectionScore s = detection_score(t, contact, flags(3000, {{1015, 1015}}));
  EXPECT_EQ(s.collisions, 2);
  EXPECT_EQ(s.detected, 1);
}

TEST(DetectionScore, AContactThatLastsIsOneHoweverFarApartItsSamplesAre) {
  const Times t = times(10, 1);
  const DetectionScore s = detection_score(t, flags(10, {{2, 6}}), flags(10, {{5, 5}}));
  EXPECT_EQ(s.collisions, 1);
  EXPECT_EQ(s.delay, 3);
}

TEST(DetectionScore, WithoutContactEveryMarkIsFalseAndThereIsNoDelay) {
  const DetectionScore s = detection_score(times(100), flags(100, {}), flags(100, {{5, 5}}));
  EXPECT_EQ(s.collisions, 0);
  EXPECT_EQ(s.false_alarms, 1);
  EXPECT_TRUE(std::isnan(s.delay));
}

TEST(Metrics, FinalErrorIsTheMeanOfTheLastSecond) {
  const Times t = {0, 1, 2, 2.5, 3};
  const Eigen::RowVectorXd truth = Eigen::RowVectorXd::Constant(5, 10);
  Eigen::RowVectorXd estimate(5);
  estimate << 0, 0, 10, 11, 12;
  EXPECT_DOUBLE_EQ(final_error(t, truth, estimate), 1);
}

TEST(Metrics, OvertravelIsTheWayOnInTheDirectionOfTheMotion) {
  Trace trace;
  trace.t = {0, 1, 2, 3, 4};
  trace.q.resize(2, 5);
  trace.q << 0, 1, 1.5, 1.2, 0.5,  // moves up, stopped at 1
      0, -1, -1.1, -1.2, -0.5;
  trace.qd.resize(2, 5);
  trace.qd << 1, 1, 0, 0, 0, -1, -1, 0, 0, 0;
  EXPECT_TRUE(std::isnan(overtravel(trace))) << "nothing stopped it";
  trace.stopped_at = 1;
  EXPECT_DOUBLE_EQ(overtravel(trace), 0.5);
}

TEST(Metrics, PeakIsTheLargestForce) {
  EXPECT_EQ(peak({1, 7, 3}), 7);
  EXPECT_EQ(peak({}), 0);
}

TEST(PoissonUpper, IsThatOfTheTables) {
  // Garwood's limits: half the 95 % quantile of chi squared with 2 (n + 1) degrees of freedom
  EXPECT_NEAR(poisson_upper(0), -std::log(0.05), 1e-6);
  EXPECT_NEAR(poisson_upper(1), 4.744, 1e-3);
  EXPECT_NEAR(poisson_upper(10), 16.962, 1e-3);
  EXPECT_NEAR(poisson_upper(100), 118.08, 0.01);
}

TEST(Intervals, AreThoseOfTheTables) {
  // half the 2.5 and 97.5 % quantiles of chi squared with 2 n and 2 (n + 1) degrees of freedom
  for (const auto& [n, low, high] :
       {std::tuple(0, 0., 3.6889), {1, 0.0253, 5.5716}, {10, 4.7954, 18.3904}}) {
    EXPECT_NEAR(count_interval(n).low, low, 1e-3) << n;
    EXPECT_NEAR(count_interval(n).high, high, 1e-3) << n;
  }
  // Newcombe 1998, table I, method 3: Wilson's without correction
  for (const auto& [found, all, low, high] : {std::tuple(81, 263, 0.2553, 0.3662),
                                              {15, 148, 0.0624, 0.1605},
                                              {0, 20, 0., 0.1611},
                                              {1, 29, 0.0061, 0.1718}}) {
    EXPECT_NEAR(share_interval(found, all).low, low, 1e-4) << found;
    EXPECT_NEAR(share_interval(found, all).high, high, 1e-4) << found;
  }
  EXPECT_EQ(share_interval(0, 0).low, 0);
  EXPECT_EQ(share_interval(0, 0).high, 1);
}

TEST(Quantile, IsTheSmallestThatEnoughDoNotExceed) {
  EXPECT_EQ(quantile({3, 1, 2, 4}, 0.5), 2);
  EXPECT_EQ(quantile({3, 1, 2, 4}, 0.95), 4);
  EXPECT_EQ(quantile({7}, 0), 7);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

}  // namespace
}  // namespace tauext::test

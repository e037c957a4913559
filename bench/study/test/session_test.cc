// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/session/session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/roster/robots.h"
#include "bench/roster/session/listener.h"
#include "bench/study/detection/study_counts.h"
#include "bench/study/study_runs.h"
#include "mjcf/trace/random.h"

namespace tauext::study::test {
namespace {

// blows on a robot, as noisy sensors see them
std::vector<Trace> blows(const std::string& robot, const std::string& name, int runs) {
  const StudyRuns& of = touched_runs(&tauext::robot(robot));
  const Condition& c = condition(of, name);
  std::vector<Job> jobs;
  for (int i = 1; i <= runs; ++i)
    jobs.push_back({plant_of(c), TouchKind::kBlow, static_cast<std::uint64_t>(i)});
  return Views(simulated(of, jobs, of.model(plant_of(c))), jobs).by(c.degradation.sensors);
}
std::vector<Trace> blows(int runs) {
  return blows("wallmobot3", "unknown_150", runs);
}

std::vector<Asked> all_detectors(const Robot& r) {
  std::vector<Asked> all;
  for (const std::string& d : r.detectors()) all.push_back({d, judged_with({})});
  return all;
}

void expect_same(const Answers& a, const Answers& b) {
  ASSERT_EQ(a.marks.size(), b.marks.size());
  for (std::size_t i = 0; i < a.marks.size(); ++i) {
    EXPECT_EQ(a.marks[i].t, b.marks[i].t);
    EXPECT_EQ(a.marks[i].contact, b.marks[i].contact);
  }
  EXPECT_EQ(a.rises, b.rises);
  EXPECT_EQ(a.samples, b.samples);
  EXPECT_EQ(a.alarmed, b.alarmed);
}

// a session of all traces says what sessions of one say
void expect_alike(const std::vector<Trace>& traces, const std::vector<std::string>& estimators,
                  const std::string& of = "wallmobot3") {
  const Robot& r = robot(of);
  const std::vector<Asked> detectors = all_detectors(r);
  const std::unique_ptr<Session> all = make_session(r, traces);
  int marks = 0;
  for (const std::string& e : estimators) {
    const std::vector<std::string> why = all->estimate(e);
    const auto answers = all->answers(detectors, kLevels, kScoreFrom);
    ASSERT_EQ(answers.size(), detectors.size());
    const Asked trained{"clamping", {{}, kStartUp}};
    const auto largest = all->largest_statistic(trained, kScoreFrom);
    const auto covariance = all->covariance(trained, kScoreFrom);
    ASSERT_EQ(largest.size(), traces.size());
    for (std::size_t i = 0; i < traces.size(); ++i) {
      SCOPED_TRACE(e + ", run " + std::to_string(i));
      const std::unique_ptr<Session> one = make_session(r, {&traces[i], 1});
      EXPECT_EQ(why[i], one->estimate(e).front());
      const auto alone = one->answers(detectors, kLevels, kScoreFrom);
      for (std::size_t d = 0; d < detectors.size(); ++d) {
        SCOPED_TRACE(detectors[d].detector);
        ASSERT_EQ(answers[d].size(), traces.size());
        expect_same(answers[d][i], alone[d].front());
        marks += static_cast<int>(answers[d][i].marks.size());
      }
      EXPECT_TRUE(largest[i].isApprox(one->largest_statistic(trained, kScoreFrom).front(), 1e-9));
      EXPECT_TRUE(covariance[i].isApprox(one->covariance(trained, kScoreFrom).front(), 1e-9));
    }
  }
  EXPECT_GT(marks, 10);
}

TEST(Session, OfSeveralRunsSaysWhatSessionsOfOneSay) {
  expect_alike(blows(3), {"ekf", "ekf_honest", "ndob", "mo2:bandwidth=50", "ndob_wb", "smo"});
}

TEST(Session, OfMoreRunsThanGoAtOnceSaysTheSame) {
  expect_alike(blows(robot("wallmobot3").runs_at_once() + 1), {"mo1"});
}

TEST(Session, OfAnArmWhoseEstimatorsComeOneByOneSaysTheSame) {
  // from the second estimator on they share the arm's terms at the samples
  std::vector<Trace> traces = blows("wallmobot6", "noise", 2);
  traces[1].tau(2, 6789) = std::numeric_limits<double>::infinity();
  expect_alike(traces, {"mo1", "inverse_dynamics", "mo2", "dkf", "aob", "eso", "ekf"},
               "wallmobot6");
}

TEST(Session, BearsASampleThatOneRunLost) {
  std::vector<Trace> traces = blows(2);
  traces[0].tau(2, 6789) = std::numeric_limits<double>::infinity();
  expect_alike(traces, {"mo1", "ekf"});  // estimators at once, detectors one by one
  traces[1].qd(0, 12345) = std::numeric_limits<double>::quiet_NaN();
  expect_alike(traces, {"mo1"});  // all one by one
}

TEST(Session, BearsASampleThatEstimatorsLeaveOut) {
  std::vector<Trace> traces = blows("wallmobot6", "noise", 3);
  traces[0].q(1, 6789) += 0.5;  // a jump of one run
  expect_alike(traces, {"mo1", "eso"}, "wallmobot6");
  for (Trace& t : traces) t.q(2, 12345) += 0.5, t.q(1, 12800) -= 0.5;  // of all at once, twice
  traces[0].q(1, 6789) -= 0.5;
  expect_alike(traces, {"mo1", "eso"}, "wallmobot6");
}

TEST(Session, BearsRunsOfOtherClocksAndLengths) {
  std::vector<Trace> traces = blows(2);
  traces[1] = select_samples(traces[1], [] {
    std::vector<int> kept;
    for (int k = 0; k < 20'000; ++k) kept.push_back(k);
    return kept;
  }());
  expect_alike(traces, {"mo1"});
  for (double& t : traces[0].t) t += 100;
  expect_alike(traces, {"mo1"});
}

TEST(Session, CountsWhereAScoreRisesThroughALevel) {
  const std::array levels = {0.5, 1., 2.};
  detail::Listener<double> listener(levels, 1);
  Random random(7);
  std::vector<double> scores;
  for (int k = 0; k < 20'000; ++k) {
    scores.push_back(std::abs(2 * random.normal()));
    listener.take(k * 1e-3, {k % 5000 == 1500, scores.back(), Contact::kClamping});
  }
  const Answers said = std::move(listener).answers().front();
  for (std::size_t i = 0; i < levels.size(); ++i) {
    std::vector<double> rises;
    for (int k = 1000; k < 20'000; ++k) {
      const bool rose = scores[k] >= levels[i] && scores[k - 1] < levels[i];
      if (rose && (rises.empty() || k * 1e-3 - rises.back() >= 0.2)) rises.push_back(k * 1e-3);
    }
    EXPECT_EQ(said.rises[i], rises);
    EXPECT_GT(rises.size(), 50u);
  }
  EXPECT_EQ(said.samples, 19'000);
  EXPECT_EQ(said.alarmed, std::count_if(scores.begin() + 1000, scores.end(),
                                        [](double score) { return score >= 1; }));
  ASSERT_EQ(said.marks.size(), 4u);
  EXPECT_EQ(said.marks[0].t, 1.5);
  EXPECT_EQ(said.marks[0].contact, Contact::kClamping);
}

TEST(Session, RefusesTracesOfAnotherArm) {
  const std::vector<Trace> traces = blows(1);
  const Robot& other = robot("testbed1");
  EXPECT_THROW(make_session(other, traces), std::invalid_argument);
  EXPECT_THROW(other.detect("threshold", traces.front(), {}, {}), std::invalid_argument);
}

TEST(Session, OfRunsThatASensorSpoilsSaysWhy) {
  std::vector<Trace> traces = blows(2);
  traces[1].q.setConstant(std::numeric_limits<double>::quiet_NaN());
  const std::unique_ptr<Session> all = make_session(robot("wallmobot3"), traces);
  const std::vector<std::string> why = all->estimate("mo1");
  EXPECT_EQ(why[0], "");
  EXPECT_EQ(why[1].find("30000 of 30000 samples left out: 30000 bad measurement"), 0u) << why[1];
}

}  // namespace
}  // namespace tauext::study::test

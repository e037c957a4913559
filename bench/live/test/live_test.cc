// SPDX-License-Identifier: Apache-2.0
#include "bench/live/live.h"

#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <memory>
#include <stdexcept>
#include <thread>

#include "bench/kit/allocations.h"
#include "bench/logs/lcm_trace.h"
#include "bench/roster/robots.h"
#include "bench/score/metrics.h"
#include "lcmtypes/listener.h"

namespace tauext::live::test {
namespace {

// half a second around the blow of `collision`, which is at 5 s
Trace blow() {
  Scenario s = scenario("wallmobot3", "collision");
  s.duration = 5.25;
  const Trace whole = record(load_for("wallmobot3", s), s);
  std::vector<int> tail;
  for (int k = 4750; k < whole.size(); ++k) tail.push_back(k);
  return select_samples(whole, tail);
}

TEST(Live, EstimatesAndMarksAreThoseOfTheSuite) {
  const Trace trace = blow();
  const Robot& r = robot("wallmobot3");
  for (const std::string& e : r.estimators()) {
    const Output expected = r.pair(e, "pan_tompkins", trace).run(trace);
    Pair pair = r.pair(e, "pan_tompkins", trace);
    pair.reset();
    int k = 0;
    for (const Reading& y : readings_of(trace)) {
      Vec<3> tau_ext;
      const StepResult s = pair.step(y.t, y.q.data(), y.qd.data(), y.tau.data(), tau_ext.data());
      ASSERT_EQ(tau_ext, Vec<3>(expected.tau_ext.col(k))) << e << " at " << y.t;
      ASSERT_EQ(s.detection.mark, expected.marks[k] != 0) << e << " at " << y.t;
      ASSERT_EQ(s.status, expected.status[k]);
      ++k;
    }
  }
}

#ifndef TAUEXT_SANITIZED  // which brings its own malloc
TEST(Live, ACycleAllocatesNothing) {
  const Trace trace = blow();
  const Robot& r = robot("wallmobot3");
  const std::vector<Reading> readings = readings_of(trace);
  const std::vector<std::string> estimators = {"ekf", "mo2", "ndob"};
  LiveStream stream(nullptr, streams_of(estimators, "contact_classifier", kEndEffector), 200);
  const auto forces = r.forces_at(kEndEffector, false);
  LiveEstimation estimation(r, estimators, "contact_classifier", {}, trace, &stream, forces.get());
  estimation.take(readings[0]);
  EXPECT_EQ(allocations_of([&] {
              for (std::size_t k = 1; k < readings.size(); ++k) estimation.take(readings[k]);
            }),
            0u);
  EXPECT_EQ(estimation.samples(), trace.size());
  EXPECT_EQ(estimation.figures(0).marks, 1);
}
#endif

TEST(Live, FiguresAreTheMetrics) {
  const Trace trace = blow();
  const Robot& r = robot("wallmobot3");
  LiveEstimation estimation(r, {"mo1", "truth"}, "", {}, trace, nullptr);
  for (const Reading& y : readings_of(trace)) estimation.take(y);
  Score score;
  add_error_metrics(trace, r.run("mo1", trace), trace.t[0], score);
  EXPECT_NEAR(estimation.figures(0).rmse(), *score.get(Metric::kRmse), 1e-9);
  EXPECT_EQ(estimation.figures(0).largest_error, *score.get(Metric::kMax));
  EXPECT_EQ(estimation.figures(1).rmse(), 0);
  EXPECT_EQ(estimation.figures(0).step_ns.count(), static_cast<std::uint64_t>(trace.size()));
}

TEST(Live, AReferenceThatIsNoNumberIsNotCompared) {
  const Trace trace = blow();
  LiveEstimation estimation(robot("wallmobot3"), {"zero"}, "", {}, trace, nullptr);
  Reading r = readings_of(trace)[0];
  r.tau_ext = {3, 0, -4};
  estimation.take(r);
  r.t += 1e-3;
  r.tau_ext[1] = std::numeric_limits<double>::quiet_NaN();
  estimation.take(r);
  EXPECT_EQ(estimation.figures(0).compared, 1);
  EXPECT_EQ(estimation.figures(0).rmse(), 4);
  EXPECT_EQ(estimation.samples(), 2);
}

TEST(Live, SamplesThatMadeNoEstimateAreCounted) {
  std::vector<Reading> readings = readings_of(blow());
  LiveEstimation estimation(robot("wallmobot3"), {"mo1"}, "", {}, Trace(), nullptr);
  for (int k = 0; k < 10; ++k) estimation.take(readings[k]);
  estimation.take(readings[5]);    // late
  estimation.take(readings[200]);  // a gap of 0.19 s
  EXPECT_EQ(estimation.figures(0).unusable, 2);
  estimation.reset();
  estimation.take(readings[0]);
  EXPECT_EQ(estimation.figures(0).unusable, 2);
}

TEST(Live, AGapDoesNotOutlastTheStop) {
  std::vector<Reading> readings = readings_of(blow());
  readings.resize(2);
  readings[1].t = readings[0].t + 3600;
  LiveEstimation estimation(robot("wallmobot3"), {"mo1"}, "", {}, Trace(), nullptr);
  Histogram late;
  std::atomic<bool> stop = false;
  std::thread loop([&] { play(readings, {}, estimation, late, stop); });
  while (estimation.samples() == 0) std::this_thread::yield();
  stop = true;
  loop.join();
  EXPECT_EQ(estimation.samples(), 1);
}

TEST(Live, PlaysByTheClockAtItsSpeedAndBeginsAgain) {
  const Trace trace = blow();  // 0.5 s
  const std::vector<Reading> readings = readings_of(trace);
  const auto transport = std::make_shared<Transport>("memq://");
  std::vector<estimate_t> seen;
  Listener listener(transport->handle(), {"TAUEXT_ESTIMATE_mo1"},
                    [&](std::string_view, Sender, Bytes m) {
                      estimate_t e{};
                      ASSERT_EQ(decode(m, e), Reject::kNone);
                      seen.push_back(e);
                    });
  LiveStream stream(transport, streams_of({"mo1"}, ""), 0);
  LiveEstimation estimation(robot("wallmobot3"), {"mo1"}, "", {}, trace, &stream);
  Histogram late;
  const std::atomic<bool> stop = false;
  const auto begin = std::chrono::steady_clock::now();
  play(readings, {.speed = 5, .again = true, .duration = 0.2499}, estimation, late, stop);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_GT(seconds, 0.2497);  // 1.25 s of samples, five times as fast
  EXPECT_EQ(estimation.samples(), 1250);
  ASSERT_TRUE(stream.finish());
  while (listener.wait(0)) {
  }
  ASSERT_EQ(seen.size(), 1250u);
  for (std::size_t k = 1; k < seen.size(); ++k) {
    ASSERT_EQ(seen[k].seq, static_cast<std::int64_t>(k));
    ASSERT_NEAR(seen[k].t - seen[k - 1].t, 1e-3, 1e-9) << k;
    ASSERT_EQ(seen[k].tau_ext_true[0], seen[k % 500].tau_ext_true[0]);
    ASSERT_EQ(seen[k].tau_ext_hat[0], seen[k % 500].tau_ext_hat[0]) << "reset at the begin";
  }
}

TEST(Live, WhatCannotBeRunIsRefused) {
  const Robot& r = robot("wallmobot3");
  EXPECT_THROW(LiveEstimation(r, {"mo1", "mo1"}, "", {}, Trace(), nullptr), std::invalid_argument);
  EXPECT_THROW(LiveEstimation(r, {"mo7"}, "", {}, Trace(), nullptr), std::invalid_argument);
  EXPECT_THROW(LiveEstimation(r, {"mo1"}, "none", {}, Trace(), nullptr), std::invalid_argument);
  EXPECT_THROW(LiveEstimation(r, {"truth"}, "", {}, Trace(), nullptr), std::invalid_argument);
  const Trace one_joint = record(load_robot("testbed1"), quiet());
  EXPECT_THROW(LiveEstimation(r, {"mo1"}, "", {}, one_joint, nullptr), std::invalid_argument);
}

}  // namespace
}  // namespace tauext::live::test

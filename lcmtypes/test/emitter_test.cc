// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/emitter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "bench/kit/allocations.h"
#include "lcmtypes/test/samples.h"

namespace tauext::test {
namespace {

Sink collect(std::vector<Sent>& all) {
  return [&all](const char* channel, std::int64_t utime, Bytes bytes) {
    all.push_back({channel, utime, {bytes.begin(), bytes.end()}});
    return true;
  };
}

TEST(EmitterTest, WithoutARateEverySampleIsAMessage) {
  std::vector<Sent> sent;
  Emitter emitter({{"ekf", ""}}, 0, collect(sent));
  for (int k = 0; k < 100; ++k) emitter.add(live_sample(k));
  ASSERT_EQ(sent.size(), 100u);
  for (int k = 0; k < 100; ++k) {
    const auto e = decoded<estimate_t>(sent[k]);
    EXPECT_EQ(sent[k].channel, "TAUEXT_ESTIMATE_ekf");
    EXPECT_EQ(e.utime, 1000 * k);
    EXPECT_EQ(e.seq, k);
    EXPECT_EQ(e.samples, 1);
    EXPECT_EQ(e.reference, estimate_t::kTruth);
    EXPECT_EQ(e.tau_ext_true[1], 4);
  }
}

TEST(EmitterTest, ARateKeepsItsRateAndLosesNoSample) {
  for (const double rate : {1., 50., 200., 333., 999., 1000., 5000.}) {
    std::vector<Sent> sent;
    Emitter emitter({{"ekf", ""}}, rate, collect(sent));
    for (int k = 0; k < 10000; ++k) emitter.add(live_sample(k));
    emitter.flush();
    const double wanted = std::min(rate, 1000.) * 10;
    EXPECT_NEAR(static_cast<double>(sent.size()), wanted, 2) << rate;
    int samples = 0;
    for (const Sent& s : sent) samples += decoded<estimate_t>(s).samples;
    EXPECT_EQ(samples, 10000) << rate;
  }
}

// 3 ms at 1 kHz in a stream of 200 messages a second, wherever it falls
TEST(EmitterTest, APulseOfThreeMillisecondsIsSeenAt200Hz) {
  for (int begin = 100; begin < 110; ++begin) {
    for (const double sign : {1., -1.}) {
      std::vector<Sent> sent;
      Emitter emitter({{"ekf", ""}}, 200, collect(sent));
      for (int k = 0; k < 300; ++k) {
        LiveSample s = live_sample(k);
        if (k >= begin && k < begin + 3) s.tau_ext_hat[2] = s.reading.tau_ext[2] = sign * 77;
        emitter.add(s);
      }
      int seen = 0, true_seen = 0;
      for (const Sent& m : sent) {
        const auto e = decoded<estimate_t>(m);
        seen += (sign > 0 ? e.tau_ext_hat_max[2] : e.tau_ext_hat_min[2]) == sign * 77;
        true_seen += (sign > 0 ? e.tau_ext_true_max[2] : e.tau_ext_true_min[2]) == sign * 77;
      }
      EXPECT_GE(seen, 1) << begin;
      EXPECT_LE(seen, 2) << begin;
      EXPECT_EQ(seen, true_seen) << begin;
    }
  }
}

TEST(EmitterTest, MarksScoresAndStatusesAreHeldToo) {
  std::vector<Sent> sent;
  Emitter emitter({{"ekf", "pan_tompkins"}}, 100, collect(sent));
  for (int k = 0; k <= 20; ++k) {
    LiveSample s = live_sample(k);
    s.score = k == 13 ? 4 : 0.5;
    s.mark = k == 13;
    s.contact = s.mark ? 2 : 0;
    s.status = k == 12 ? estimate_t::kBadMeasurement : estimate_t::kOk;
    s.step_us = k == 15 ? 9 : 1;
    emitter.add(s);
  }
  ASSERT_EQ(sent.size(), 8u);  // samples 0, 10, at once 13, and 20, two messages each
  const auto e = decoded<estimate_t>(sent[4]);
  const auto d = decoded<detection_t>(sent[5]);
  EXPECT_EQ(sent[5].channel, "TAUEXT_DETECTION");
  EXPECT_EQ(e.status, estimate_t::kBadMeasurement);
  EXPECT_EQ(decoded<estimate_t>(sent[6]).step_us, 9);
  EXPECT_EQ(d.utime, 13000);
  EXPECT_EQ(d.mark, 1);
  EXPECT_EQ(d.mark_utime, 13000);
  EXPECT_EQ(d.contact, detection_t::kCollision);
  EXPECT_EQ(d.score, 4);
  EXPECT_EQ(d.samples, 3);
  EXPECT_EQ(decoded<detection_t>(sent[3]).mark, 0);
  EXPECT_EQ(decoded<detection_t>(sent[7]).mark, 0);
  EXPECT_EQ(decoded<detection_t>(sent[7]).samples, 7);
}

TEST(EmitterTest, ForcesHaveTheNumberOfTheirEstimateAndHoldTheirPeak) {
  std::vector<Sent> sent;
  Emitter emitter({{"ekf", "pan_tompkins", "tool"}, {"mo2", ""}}, 100, collect(sent));
  for (int k = 0; k <= 20; ++k) {
    LiveSample s = live_sample(k);
    s.force.force = {0, k == 13 ? -40. : 3., 4};
    s.force.seen = {1, 1, 0, 0, 0, 0};
    s.force.link = 2;
    emitter.add(s);
    s.stream = 1;
    emitter.add(s);
  }
  std::vector<Sent> forces;
  for (const Sent& m : sent) {
    if (m.channel == "TAUEXT_FORCE") forces.push_back(m);
  }
  ASSERT_EQ(forces.size(), 3u);
  const auto last = decoded<force_t>(forces[2]);
  EXPECT_EQ(last.utime, 20000);
  EXPECT_EQ(last.seq, 2);
  EXPECT_EQ(last.samples, 10);
  EXPECT_EQ(last.force[1], 3);
  EXPECT_NEAR(last.force_max, std::sqrt(40. * 40 + 4 * 4), 1e-12);
  EXPECT_EQ(last.seen[1], 1);
  EXPECT_EQ(last.link, 2);
  EXPECT_EQ(last.estimator, "ekf");
  EXPECT_EQ(last.site, "tool");
  EXPECT_EQ(emitter.counts(0).sent, 6) << "estimates and detections";
  EXPECT_EQ(emitter.counts().sent, 12);
}

TEST(EmitterTest, WhatIsNoNumberDoesNotHideAPeak) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (const int bad : {101, 102, 105}) {  // first, in the middle and last of their message
    std::vector<Sent> sent;
    Emitter emitter({{"ekf", ""}}, 200, collect(sent));
    for (int k = 0; k <= 105; ++k) {
      LiveSample s = live_sample(k);
      if (k == bad) s.reading.tau_ext[0] = kNaN;
      if (k == 103) s.reading.tau_ext[0] = 77;
      if (k > 100) s.reading.tau_ext[1] = kNaN;
      emitter.add(s);
    }
    const auto e = decoded<estimate_t>(sent.back());
    ASSERT_EQ(e.samples, 5);
    EXPECT_EQ(e.tau_ext_true_max[0], 77) << bad;
    EXPECT_EQ(e.tau_ext_true_min[0], 5) << bad;
    EXPECT_TRUE(std::isnan(e.tau_ext_true_max[1]));
    EXPECT_EQ(e.tau_ext_true_max[3], 0);  // behind the joints
  }
}

TEST(EmitterTest, AnotherNumberOfJointsIsAnotherMessage) {
  std::vector<Sent> sent;
  Emitter emitter({{"ekf", ""}}, 200, collect(sent));
  for (int k = 0; k <= 10; ++k) {
    LiveSample s = live_sample(k);
    s.reading.n = k < 8 ? 3 : 2;
    emitter.add(s);
  }
  for (const Sent& m : sent) {
    const auto e = decoded<estimate_t>(m);
    EXPECT_EQ(e.tau_ext_hat[2], e.n == 3 ? 3 : 0);
    EXPECT_EQ(e.tau_ext_hat_max[2], e.n == 3 ? 3 : 0);
  }
  EXPECT_EQ(sent.size(), 4u);
}

TEST(EmitterTest, StreamsHaveTheirOwnNumbers) {
  std::vector<Sent> sent;
  Emitter emitter({{"ekf", ""}, {"mo1", ""}}, 0, collect(sent));
  for (int k = 0; k < 10; ++k) {
    emitter.add(live_sample(k, 0));
    emitter.add(live_sample(k, 1));
  }
  EXPECT_EQ(decoded<estimate_t>(sent[18]).seq, 9);
  EXPECT_EQ(decoded<estimate_t>(sent[19]).seq, 9);
  EXPECT_EQ(sent[19].channel, "TAUEXT_ESTIMATE_mo1");
  EXPECT_EQ(emitter.counts(1).sent, 10);
}

TEST(EmitterTest, WhatCouldNotBeSentIsCountedAndLeavesAGapInTheNumbers) {
  std::vector<Sent> sent;
  bool broken = false;
  const Sink good = collect(sent);
  Emitter emitter({{"ekf", ""}}, 0,
                  [&](const char* c, std::int64_t t, Bytes b) { return !broken && good(c, t, b); });
  for (int k = 0; k < 10; ++k) {
    broken = k == 4 || k == 5;
    emitter.add(live_sample(k));
  }
  EXPECT_EQ(emitter.counts().sent, 8);
  EXPECT_EQ(emitter.counts().failed, 2);
  EXPECT_EQ(decoded<estimate_t>(sent[4]).seq, 6);
}

#ifndef TAUEXT_SANITIZED  // which brings its own malloc
TEST(EmitterTest, NothingIsAllocated) {
  std::size_t bytes = 0;
  Emitter emitter({{"ekf", "pan_tompkins"}, {"mo1", ""}}, 200,
                  [&](const char*, std::int64_t, Bytes b) { return bytes += b.size(), true; });
  emitter.add(live_sample(0));
  const std::uint64_t count = allocations_of([&] {
    for (int k = 1; k < 1000; ++k) {
      LiveSample s = live_sample(k, k % 2);
      s.mark = k == 500;
      emitter.add(s);
    }
    emitter.flush();
  });
  EXPECT_EQ(count, 0u);
  EXPECT_GT(bytes, 100'000u);
}
#endif

TEST(EmitterTest, ImpossibleRatesAndNamesAreRefused) {
  const Sink none = [](const char*, std::int64_t, Bytes) { return true; };
  for (const double rate :
       {-1., std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(Emitter({{"ekf", ""}}, rate, none), std::invalid_argument) << rate;
  }
  EXPECT_THROW(Emitter({{std::string(60, 'x'), ""}}, 0, none), std::invalid_argument);
}

}  // namespace
}  // namespace tauext::test

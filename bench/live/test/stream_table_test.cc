// SPDX-License-Identifier: Apache-2.0
#include "bench/live/stream_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "lcmtypes/test/samples.h"

namespace tauext::live::test {
namespace {

using namespace tauext::test;  // NOLINT(google-build-using-namespace): samples to try with

bool has(const std::string& text, const std::string& what) {
  return text.find(what) != std::string::npos;
}

TEST(StreamTableTest, ShowsEachJointAndCountsLostOnes) {
  StreamTable table;
  estimate_t e = estimate();
  e.reference = estimate_t::kTruth;
  e.tau_ext_true[2] = -99.5;
  for (const int seq : {0, 1, 2, 5, 6}) {
    e.seq = seq;
    table.take("TAUEXT_ESTIMATE_ekf", 0, 1000 * seq, bytes_of(e));
  }
  EXPECT_EQ(table.account().used, 5);
  EXPECT_EQ(table.account().lost, 2);
  const std::string text = table.format(6000);
  EXPECT_TRUE(has(text, "TAUEXT_ESTIMATE_ekf                5       2      1")) << text;
  EXPECT_TRUE(has(text, "-98.200")) << text;
  EXPECT_TRUE(has(text, "-99.500")) << text;
}

TEST(StreamTableTest, TheSmallTableTellsSpecificationsOfOneEstimatorApart) {
  StreamTable table;
  for (const char* w : {"20", "50"})
    table.take(std::string("TAUEXT_ESTIMATE_mo2:bandwidth=") + w, 0, 0, bytes_of(estimate()));
  table.take("TAUEXT_ESTIMATE_momentumkf12", 0, 0, bytes_of(estimate()));
  const std::string text = table.format_small(6000, 0);
  EXPECT_TRUE(has(text, "mo2:b~dth=20 ")) << text;
  EXPECT_TRUE(has(text, "mo2:b~dth=50 ")) << text;
  EXPECT_TRUE(has(text, "momentumkf12 ")) << text;
}

TEST(StreamTableTest, ARestartOfTheSenderIsNoLoss) {
  StreamTable table;
  estimate_t e = estimate();
  for (const int seq : {100, 101, 0, 1}) {
    e.seq = seq;
    table.take("TAUEXT_ESTIMATE_ekf", 0, 0, bytes_of(e));
  }
  EXPECT_EQ(table.account().lost, 0);
}

TEST(StreamTableTest, SwappedMessagesAreNoLossAndASilentSenderHasNoRate) {
  StreamTable table;
  estimate_t e = estimate();
  for (const int seq : {0, 1, 3, 2, 4, 5}) {
    e.seq = seq;
    table.take("TAUEXT_ESTIMATE_ekf", 0, 1000 * seq, bytes_of(e));
  }
  EXPECT_EQ(table.account().lost, 0);
  EXPECT_TRUE(has(table.format(6000), "TAUEXT_ESTIMATE_ekf                6       0      1"));
  EXPECT_TRUE(has(table.format(2'000'000), "TAUEXT_ESTIMATE_ekf                0       0      1"));
}

TEST(StreamTableTest, TwoSendersOnAChannelAreNamedAndTheFirstIsShown) {
  for (const bool known : {true, false}) {  // as the network says, or by their numbers alone
    StreamTable table;
    estimate_t e = estimate();
    for (int k = 0; k < 500; ++k) {
      for (const int second : {0, 1}) {
        e.seq = 50'000 * second + k;
        e.tau_ext_hat[0] = second;
        const Sender sender = known ? 1 + second : 0;
        EXPECT_NE(table.take("TAUEXT_ESTIMATE_ekf", sender, 1000 * k, bytes_of(e)), second) << k;
      }
    }
    const Account a = table.account();
    EXPECT_EQ(a.lost, 0);
    EXPECT_EQ(a.sent(), 1000);
    EXPECT_GE(a.rejected, 499);
    const auto events = table.events();
    ASSERT_EQ(events.size(), 1u) << known;
    EXPECT_TRUE(has(events[0], known ? "both send on the channel" : "there are two senders"))
        << events[0];
    EXPECT_TRUE(has(table.totals({}), "of a second sender")) << table.totals({});
    const std::string text = table.format(500'000);
    EXPECT_FALSE(has(text, "1.000")) << text;
  }
}

TEST(StreamTableTest, ALargeJumpIsUsedOnceTheStreamGoesOnFromThere) {
  StreamTable table;
  estimate_t e = estimate();
  const auto used = [&](std::int64_t seq) {
    e.seq = seq;
    return table.take("TAUEXT_ESTIMATE_ekf", 0, 0, bytes_of(e));
  };
  for (const int seq : {0, 1, 2, 60}) EXPECT_TRUE(used(seq)) << seq;
  EXPECT_FALSE(used(5000));
  EXPECT_TRUE(used(61)) << "it did not";
  EXPECT_FALSE(used(5000));
  EXPECT_TRUE(used(5001));
  EXPECT_FALSE(used(62)) << "late";
  EXPECT_EQ(table.account().used, 7) << "what was not believed at first counts";
}

TEST(StreamTableTest, WhatIsUsedOfDetectionsAndForcesIsTheFirstSenders) {
  StreamTable table;
  for (int k = 0; k < 3; ++k) {
    detection_t d = detection();
    force_t f = force();
    d.seq = f.seq = k;
    for (const int second : {0, 1}) {
      EXPECT_NE(table.take("TAUEXT_DETECTION", 1 + second, 0, bytes_of(d)), second);
      EXPECT_NE(table.take("TAUEXT_FORCE", 1 + second, 0, bytes_of(f)), second);
    }
  }
}

TEST(StreamTableTest, NamesBeyondWhatATableHoldsAreRejected) {
  StreamTable table;
  for (int i = 0; i < 1000; ++i) {
    table.take("TAUEXT_ESTIMATE_" + std::to_string(i), 0, 0, bytes_of(estimate()));
  }
  EXPECT_EQ(table.account().used, 100);
  EXPECT_EQ(table.account().rejected, 900);
  const std::string text = table.format(0);
  EXPECT_LT(std::count(text.begin(), text.end(), '\n'), 320);
}

TEST(StreamTableTest, TheSummaryTellsWhatWasLostAtTheEnd) {
  StreamTable table;
  estimate_t e = estimate();
  detection_t d = detection();
  for (int k = 0; k < 90; ++k) {
    e.seq = d.seq = k;
    table.take("TAUEXT_ESTIMATE_ekf", 0, 0, bytes_of(e));
    table.take("TAUEXT_DETECTION", 0, 0, bytes_of(d));
  }
  summary_t s = summary();
  s.entry = "wallmobot3/step/ekf+pan_tompkins";
  s.published = 198;  // of each pair 100, and two that failed
  s.failed = 2;
  table.take("TAUEXT_SUMMARY", 0, 0, bytes_of(s));
  EXPECT_EQ(table.account().lost, 20);
  EXPECT_EQ(table.account().sent(), 201);
}

TEST(StreamTableTest, ForcesAreARowEachAndNoneIsLostUnseen) {
  StreamTable table;
  estimate_t e = estimate();
  force_t f = force();
  f.seen[0] = f.seen[2] = 1;
  f.force[0] = 12.5;
  f.force_max = 40;
  for (int k = 0; k < 90; ++k) {
    e.seq = f.seq = k;
    table.take("TAUEXT_ESTIMATE_mo2", 0, 0, bytes_of(e));
    if (k != 50) table.take("TAUEXT_FORCE", 0, 0, bytes_of(f));
  }
  EXPECT_EQ(table.account().lost, 1);
  const std::string text = table.format(0);
  EXPECT_TRUE(has(text, "mo2 at end_effector")) << text;
  for (const char* cell : {" 12.500 ", " - ", " -30.000 ", " 40.000 "}) {
    EXPECT_TRUE(has(text, cell)) << cell << " in\n" << text;
  }
  const std::string small = table.format_forces(0, true);
  for (const char* cell : {"mo2 at end_effector", " 12.500 ", " - ", " -30.000 ", " 40.000 "}) {
    EXPECT_TRUE(has(small, cell)) << cell << " in\n" << small;
  }
  EXPECT_LE(small.find('\n', small.find("mo2")) - small.find("mo2"), 80u) << small;
  EXPECT_EQ(table.joints(), 3);
  summary_t s = summary();
  s.entry = "arm/step/mo2";
  s.published = 100;  // estimates, and as many forces
  table.take("TAUEXT_SUMMARY", 0, 0, bytes_of(s));
  EXPECT_EQ(table.account().lost, 1 + 2 * 10);
}

TEST(StreamTableTest, MarksAndSummariesAreEvents) {
  StreamTable table;
  detection_t d = detection();
  d.mark_utime = 5'006'000;
  d.contact = 2;
  table.take("TAUEXT_DETECTION", 0, 0, bytes_of(d));
  table.take("TAUEXT_SUMMARY", 0, 0, bytes_of(summary()));
  const auto events = table.events();
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0], "5.006 s  ekf+pan_tompkins marks: collision");
  EXPECT_TRUE(has(events[1], "wallmobot3/step/ekf")) << events[1];
  EXPECT_TRUE(table.events().empty());
}

TEST(StreamTableTest, ATerminalIsNotObeyedToWhatAMessageSays) {
  StreamTable table;
  summary_t s = summary();
  s.entry = "\033]0;gotcha\007";
  table.take("TAUEXT_SUMMARY", 0, 0, bytes_of(s));
  table.take("TAUEXT_\033[2J", 0, 0, bytes_of(estimate()));
  EXPECT_EQ(table.events()[0].find('\033'), std::string::npos);
  EXPECT_EQ(table.format(0).find('\033'), std::string::npos);
}

TEST(StreamTableTest, EveryOneOfTenThousandMutatedMessagesIsCounted) {
  std::mt19937_64 random(2);
  const std::vector<std::vector<std::byte>> originals = {
      bytes_of(estimate()), bytes_of(detection()), bytes_of(summary()),
      write(reading(1), MessageType::kTauext), write(reading(1), MessageType::kIiwa)};
  StreamTable table;
  for (int i = 0; i < 10000; ++i) {
    auto m = originals[i % originals.size()];
    for (std::uint64_t n = 1 + random() % 4; n > 0; --n) {
      m[random() % m.size()] = static_cast<std::byte>(random());
    }
    if (random() % 4 == 0) m.resize(random() % (m.size() + 1));
    table.take("TAUEXT_X", 0, i, m);
  }
  const Account a = table.account();
  EXPECT_EQ(a.sent() - a.lost, 10000);
  EXPECT_GT(a.rejected, 3000);
  EXPECT_TRUE(has(table.totals({}), "of another type")) << table.totals({});
}

}  // namespace
}  // namespace tauext::live::test

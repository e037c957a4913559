// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/arrivals.h"

#include <gtest/gtest.h>

#include <vector>

namespace tauext::test {
namespace {

Reading at(std::int64_t ms, std::int64_t seq = -1) {
  Reading r;
  r.utime = 1000 * ms;
  r.seq = seq;
  r.n = 1;
  return r;
}

TEST(ArrivalsTest, ACleanStreamIsUsedWhole) {
  Arrivals a;
  for (int k = 0; k < 1000; ++k) EXPECT_EQ(a.take(at(k, k)), Arrival::kNext);
  EXPECT_EQ(a.counts().used, 1000);
  EXPECT_EQ(a.counts().lost + a.counts().late + a.counts().repeated + a.counts().restarts, 0);
}

TEST(ArrivalsTest, RepeatedLateAndLostOnesAreTold) {
  Arrivals a;
  a.take(at(0, 0));
  a.take(at(1, 1));
  EXPECT_EQ(a.take(at(1, 1)), Arrival::kRepeated);
  EXPECT_EQ(a.take(at(5, 5)), Arrival::kNext);  // 2, 3, 4 are missing
  EXPECT_EQ(a.counts().lost, 3);
  EXPECT_EQ(a.take(at(3, 3)), Arrival::kLate);  // overtaken, not lost
  EXPECT_EQ(a.counts().lost, 2);
  EXPECT_EQ(a.counts().late, 1);
  EXPECT_EQ(a.counts().repeated, 1);
  EXPECT_EQ(a.counts().used, 3);
}

TEST(ArrivalsTest, ARestartOrACopyDoesNotUndoALoss) {
  Arrivals a;
  for (int k = 0; k < 100; ++k) a.take(at(k, k));
  a.take(at(115, 115));  // 15 lost
  a.take(at(50, 50));    // a late copy of one that had come
  EXPECT_EQ(a.counts().lost, 15);
  for (int k = 0; k < 50; ++k) a.take(at(k, k));
  EXPECT_EQ(a.counts().restarts, 1);
  EXPECT_EQ(a.counts().lost, 15);
}

TEST(ArrivalsTest, WithoutNumbersWholePeriodsThatAreMissingAreLost) {
  Arrivals a;
  std::int64_t t = 0;
  for (int k = 0; k < 50; ++k) a.take(at(t += 5));
  EXPECT_EQ(a.counts().lost, 0);
  a.take(at(t += 20));  // three of 5 ms are missing
  EXPECT_EQ(a.counts().lost, 3);
  a.take(at(t += 6));  // jitter is no loss
  EXPECT_EQ(a.counts().lost, 3);
}

TEST(ArrivalsTest, ARestartedSenderIsBelievedAfterItsPatience) {
  Arrivals a;
  for (int k = 100000; k < 100100; ++k) a.take(at(k, k));
  std::vector<Arrival> seen;
  for (int k = 0; k < 100; ++k) seen.push_back(a.take(at(k, k)));
  for (int k = 0; k < Sequence::kPatience - 1; ++k) EXPECT_EQ(seen[k], Arrival::kLate);
  EXPECT_EQ(seen[Sequence::kPatience - 1], Arrival::kRestart);
  for (int k = Sequence::kPatience; k < 100; ++k) EXPECT_EQ(seen[k], Arrival::kNext);
  EXPECT_EQ(a.counts().restarts, 1);
  EXPECT_EQ(a.counts().lost, 0);
}

TEST(ArrivalsTest, OneFalseTimeFarAheadDoesNotSilenceTheStream) {
  Arrivals a;
  a.take(at(0, 0));
  a.take(at(1'000'000'000, 1));
  int used = 0;
  for (int k = 2; k < 1000; ++k) {
    const Arrival arrival = a.take(at(k, k));
    used += arrival == Arrival::kNext || arrival == Arrival::kRestart;
  }
  EXPECT_EQ(used, 998 - (Sequence::kPatience - 1));
}

TEST(ArrivalsTest, AnotherSendersNumbersAreNoLoss) {
  Arrivals a;
  a.take(at(0, 0));
  a.take(at(1, std::int64_t{1} << 53));
  EXPECT_EQ(a.counts().lost, 0);
}

TEST(ArrivalsTest, StrayLateOnesAreNoRestart) {
  Arrivals a;
  for (int k = 100; k < 1000; ++k) {
    EXPECT_EQ(a.take(at(k)), Arrival::kNext);
    EXPECT_EQ(a.take(at(k - 50)), Arrival::kLate);  // each overtaken by 50
  }
  EXPECT_EQ(a.counts().restarts, 0);
}

}  // namespace
}  // namespace tauext::test

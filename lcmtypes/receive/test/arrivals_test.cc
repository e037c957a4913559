// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/receive/arrivals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
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

// from a sender that the network does not name
Arrival take(Arrivals& a, const Reading& r) {
  return a.take(r, 0, r.utime);
}

TEST(ArrivalsTest, ACleanStreamIsUsedWhole) {
  Arrivals a;
  for (int k = 0; k < 1000; ++k) EXPECT_EQ(take(a, at(k, k)), Arrival::kNext);
  EXPECT_EQ(a.counts().used, 1000);
  EXPECT_EQ(a.counts().lost + a.counts().late + a.counts().repeated + a.counts().restarts, 0);
}

TEST(ArrivalsTest, RepeatedLateAndLostOnesAreTold) {
  Arrivals a;
  take(a, at(0, 0));
  take(a, at(1, 1));
  EXPECT_EQ(take(a, at(1, 1)), Arrival::kRepeated);
  EXPECT_EQ(take(a, at(5, 5)), Arrival::kNext);  // 2, 3, 4 are missing
  EXPECT_EQ(a.counts().lost, 3);
  EXPECT_EQ(take(a, at(3, 3)), Arrival::kLate);  // overtaken, not lost
  EXPECT_EQ(a.counts().lost, 2);
  EXPECT_EQ(a.counts().late, 1);
  EXPECT_EQ(a.counts().repeated, 1);
  EXPECT_EQ(a.counts().used, 3);
}

TEST(ArrivalsTest, ARestartOrACopyDoesNotUndoALoss) {
  Arrivals a;
  for (int k = 0; k < 100; ++k) take(a, at(k, k));
  take(a, at(115, 115));  // 15 lost
  take(a, at(50, 50));    // a late copy of one that had come
  EXPECT_EQ(a.counts().lost, 15);
  for (int k = 0; k < 50; ++k) take(a, at(k, k));
  EXPECT_EQ(a.counts().restarts, 1);
  EXPECT_EQ(a.counts().lost, 15);
}

TEST(ArrivalsTest, WithoutNumbersWholePeriodsThatAreMissingAreLost) {
  Arrivals a;
  std::int64_t t = 0;
  for (int k = 0; k < 50; ++k) take(a, at(t += 5));
  EXPECT_EQ(a.counts().lost, 0);
  take(a, at(t += 20));  // three of 5 ms are missing
  EXPECT_EQ(a.counts().lost, 3);
  take(a, at(t += 6));  // jitter is no loss
  EXPECT_EQ(a.counts().lost, 3);
}

TEST(ArrivalsTest, ARestartedSenderIsBelievedAfterItsPatience) {
  Arrivals a;
  for (int k = 100000; k < 100100; ++k) take(a, at(k, k));
  std::vector<Arrival> seen;
  for (int k = 0; k < 100; ++k) seen.push_back(take(a, at(k, k)));
  for (int k = 0; k < Sequence::kPatience - 1; ++k) EXPECT_EQ(seen[k], Arrival::kLate);
  EXPECT_EQ(seen[Sequence::kPatience - 1], Arrival::kRestart);
  for (int k = Sequence::kPatience; k < 100; ++k) EXPECT_EQ(seen[k], Arrival::kNext);
  EXPECT_EQ(a.counts().restarts, 1);
  EXPECT_EQ(a.counts().lost, 0);
}

TEST(ArrivalsTest, OneFalseTimeFarAheadDoesNotSilenceTheStream) {
  Arrivals a;
  take(a, at(0, 0));
  take(a, at(1'000'000'000, 1));
  int used = 0;
  for (int k = 2; k < 1000; ++k) {
    const Arrival arrival = take(a, at(k, k));
    used += arrival == Arrival::kNext || arrival == Arrival::kRestart;
  }
  EXPECT_EQ(used, 998 - (Sequence::kPatience - 1));
}

TEST(ArrivalsTest, ANumberThatTheStreamDoesNotFollowIsNoLossButAnyGapIsOne) {
  Arrivals a;
  take(a, at(0, 0));
  take(a, at(1, std::int64_t{1} << 53));
  EXPECT_EQ(a.counts().lost, 0);
  take(a, at(2, 1));
  EXPECT_EQ(a.counts().lost, 0);
  take(a, at(40'000'000, 40'000'000));
  take(a, at(40'000'001, 40'000'001));
  EXPECT_EQ(a.counts().lost, 40'000'000 - 2);
}

TEST(ArrivalsTest, WithoutNumbersAnyGapIsCountedOnceTimeGoesOnFromThere) {
  Arrivals a;
  for (int k = 0; k < 50; ++k) take(a, at(5 * k));
  take(a, at(5 * 50'000));
  EXPECT_EQ(a.counts().lost, 0);  // it may be a false time stamp
  take(a, at(5 * 50'001));
  EXPECT_EQ(a.counts().lost, 50'000 - 50);
  EXPECT_EQ(a.counts().sent(), 50'002);
}

TEST(ArrivalsTest, WhatWasRejectedIsNotLost) {
  for (const bool numbered : {true, false}) {
    Arrivals a;
    for (int k = 0; k < 1000; ++k) {
      const Reading r = at(k, numbered ? k : -1);
      if (k % 100 == 50) {
        a.reject({r.utime, r.seq}, 0);
      } else if (k % 100 != 70) {
        take(a, r);
      }
    }
    EXPECT_EQ(a.counts().rejected, 10) << numbered;
    EXPECT_EQ(a.counts().lost, 10) << numbered;
    EXPECT_EQ(a.counts().sent(), 1000) << numbered;
  }
}

TEST(ArrivalsTest, SwappedOnesAreLateAndNotLostWithANumberOrWithout) {
  for (const bool numbered : {true, false}) {
    Arrivals a;
    for (int k = 0; k < 1000; ++k) {
      const int swapped = k % 10 == 5 ? k + 1 : k % 10 == 6 ? k - 1 : k;
      take(a, at(5 * swapped, numbered ? swapped : -1));
    }
    EXPECT_EQ(a.counts().late, 100) << numbered;
    EXPECT_EQ(a.counts().lost, 0) << numbered;
    EXPECT_EQ(a.counts().sent(), 1000) << numbered;
  }
}

TEST(ArrivalsTest, TwoOfOneTimeAreRepeatedAndNotLost) {
  Arrivals a;
  for (int k = 0; k < 1000; ++k) take(a, at(k / 2, k));
  EXPECT_EQ(a.counts().used, 500);
  EXPECT_EQ(a.counts().repeated, 500);
  EXPECT_EQ(a.counts().sent(), 1000);
}

TEST(ArrivalsTest, ARestartIsNotTwoSenders) {
  Arrivals a;
  for (int k = 0; k < 100; ++k) a.take(at(1000 + k), 0, 1000 * k);
  for (int k = 0; k < 100; ++k) a.take(at(k), 0, 1000 * (100 + k));
  EXPECT_EQ(a.counts().restarts, 1);
  EXPECT_EQ(a.trouble(), "");
}

TEST(ArrivalsTest, OfTwoSendersTheFirstIsUsedAndTheOtherIsNamed) {
  Arrivals a;
  constexpr Sender kFirst = (0x7f000001ULL << 16) + 4000, kSecond = kFirst + 1;
  std::string trouble;
  for (int k = 0; k < 1000 && trouble.empty(); ++k) {
    const Reading r = at(k);
    EXPECT_EQ(a.take(r, kFirst, r.utime), Arrival::kNext);
    if (k > 5) {
      EXPECT_EQ(a.take(r, kSecond, r.utime), Arrival::kOther);
    }
    trouble = a.trouble();
  }
  EXPECT_EQ(trouble,
            "127.0.0.1:4000 and 127.0.0.1:4001 both send on the channel; only the first is used");
  EXPECT_EQ(a.counts().used, 8);  // at once
  EXPECT_EQ(a.counts().rejected, 2);
  EXPECT_EQ(a.trouble(), "");  // once
}

TEST(ArrivalsTest, TwoArmsOfUnknownSendersAreNoticedByTheirPositions) {
  for (const bool two : {true, false}) {
    Arrivals a;
    for (int k = 0; k < 400; ++k) {  // one in motion, one at rest
      Reading r = at(k);
      r.q[0] = two && k % 2 == 0 ? 1 : std::sin(0.005 * k);
      take(a, r);
    }
    EXPECT_EQ(a.counts().two_arms, two);
    EXPECT_EQ(a.trouble().empty(), !two);
  }
}

TEST(ArrivalsTest, ANewSenderTakesOverWhenTheOldOneIsSilent) {
  Arrivals a;
  for (int k = 0; k < 100; ++k) a.take(at(10 * k, k), 1, 10'000 * k);
  const std::int64_t end = 990'000;  // [us] the last was heard
  EXPECT_EQ(a.take(at(0, 0), 2, end + 400'000), Arrival::kOther);
  EXPECT_EQ(a.take(at(10, 1), 2, end + 600'000), Arrival::kRestart);
  EXPECT_EQ(a.take(at(20, 2), 2, end + 610'000), Arrival::kNext);
  EXPECT_EQ(a.counts().restarts, 1);
  EXPECT_EQ(a.counts().lost, 0);
  EXPECT_EQ(a.trouble(), "");
}

TEST(ArrivalsTest, WhatIsLostAtTheEndIsToldByTheSender) {
  Arrivals a;
  for (int k = 0; k < 90; ++k) take(a, at(k, k));
  a.end(100, 0);
  EXPECT_EQ(a.counts().lost, 10);
  EXPECT_EQ(a.counts().sent(), 100);
}

TEST(ArrivalsTest, StrayLateOnesAreNoRestart) {
  Arrivals a;
  for (int k = 100; k < 1000; ++k) {
    EXPECT_EQ(take(a, at(k)), Arrival::kNext);
    EXPECT_EQ(take(a, at(k - 50)), Arrival::kLate);  // each overtaken by 50
  }
  EXPECT_EQ(a.counts().restarts, 0);
}

}  // namespace
}  // namespace tauext::test

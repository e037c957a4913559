// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/receive/sequence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

namespace tauext::test {
namespace {

std::int64_t sum(const Sequence::Counts& c) {
  return c.next + c.late + c.repeated + c.lost + c.foreign;
}

TEST(SequenceTest, EachMessageIsCountedOnceWhateverTheGap) {
  for (const std::int64_t gap : {1, 63, 64, 65, 9'999, 10'001, 5'000'000}) {
    Sequence s;
    for (int k = 0; k < 100; ++k) s.take(k);
    for (int k = 0; k < 100; ++k) s.take(100 + gap + k);
    EXPECT_EQ(s.counts().lost, gap);
    EXPECT_EQ(sum(s.counts()), 200 + gap);
  }
}

// against a plain account of everything that happened
TEST(SequenceTest, LossesDisorderAndCopiesAddUp) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 50; ++round) {
    constexpr int kSent = 2000;
    std::vector<std::pair<double, std::int64_t>> arrivals;
    std::set<std::int64_t> came;
    int copies = 0;
    const auto chance = [&](double p) {
      return std::uniform_real_distribution<>(0, 1)(random) < p;
    };
    for (int k = 0; k < kSent; ++k) {
      if (k > 0 && k < kSent - 1 && chance(0.1)) continue;
      came.insert(k);
      arrivals.emplace_back(k + (k > 0 && chance(0.05) ? 3.5 : 0), k);
      if (chance(0.05)) {
        arrivals.emplace_back(k + 4.5, k);
        ++copies;
      }
    }
    std::sort(arrivals.begin(), arrivals.end());
    Sequence s;
    for (const auto& [when, seq] : arrivals) s.take(seq);
    EXPECT_EQ(s.counts().repeated, copies);
    EXPECT_EQ(s.counts().next + s.counts().late, static_cast<std::int64_t>(came.size()));
    EXPECT_EQ(s.counts().lost, kSent - static_cast<std::int64_t>(came.size()));
    EXPECT_EQ(s.counts().restarts + s.counts().foreign, 0);
  }
}

TEST(SequenceTest, ARestartCostsNoMessageAndUndoesNoLoss) {
  Sequence s;
  for (int k = 0; k < 100; ++k) s.take(k);
  for (int k = 115; k < 200; ++k) s.take(k);  // 15 lost
  std::vector<Order> orders;
  for (int k = 90; k < 190; ++k) orders.push_back(s.take(k));  // 10 known, then 10 that were lost
  EXPECT_EQ(std::count(orders.begin(), orders.end(), Order::kRestart), 1);
  EXPECT_EQ(s.counts().restarts, 1);
  EXPECT_EQ(s.counts().lost, 15);
  EXPECT_EQ(s.counts().next, 185 + 100);
  EXPECT_EQ(s.counts().late + s.counts().repeated, 0);
}

TEST(SequenceTest, AForgedNumberFarAheadIsForeign) {
  Sequence s;
  for (int k = 0; k < 1000; ++k) {
    s.take(k);
    if (k % 10 == 0) s.take((std::int64_t{1} << 53) - k);
  }
  EXPECT_EQ(s.counts().lost, 0);
  EXPECT_EQ(s.counts().foreign, 100);
  EXPECT_EQ(s.counts().next, 1000);
}

TEST(SequenceTest, RandomNumbersMakeNoLoss) {
  std::mt19937_64 random(6);
  Sequence s;
  for (int k = 0; k < 10'000; ++k) {
    s.take(k);
    for (int forged = 0; forged < 3; ++forged) {
      s.take(static_cast<std::int64_t>(random() >> (12 + random() % 32)));
    }
  }
  EXPECT_LT(s.counts().lost, 100);
  EXPECT_GE(s.counts().next, 9'900);
}

TEST(SequenceTest, TheEndIsTheSendersWord) {
  Sequence s;
  for (int k = 5; k < 90; ++k) s.take(k);
  s.end(100);
  EXPECT_EQ(s.counts().lost, 10);
  EXPECT_EQ(s.take(0), Order::kRestart);  // at once: it has said that it ended
  for (int k = 1; k < 50; ++k) EXPECT_EQ(s.take(k), Order::kNext);
  EXPECT_EQ(s.counts().lost, 10);
  EXPECT_EQ(s.counts().restarts, 1);
  s.end(3);  // of another run
  EXPECT_EQ(s.counts().lost, 10);
  EXPECT_EQ(s.take(50), Order::kNext);
}

TEST(SequenceTest, WhatComesLateAfterTheEndIsNoRestart) {
  Sequence s;
  for (int k = 0; k < 98; ++k) s.take(k);
  s.end(100);
  EXPECT_EQ(s.take(98), Order::kLate);
  EXPECT_EQ(s.take(99), Order::kLate);
  EXPECT_EQ(s.take(99), Order::kRepeated);
  EXPECT_EQ(sum(s.counts()), 101);
  EXPECT_EQ(s.counts().restarts + s.counts().lost, 0);
  EXPECT_EQ(s.take(0), Order::kRestart);
}

TEST(SequenceTest, AnExcusedNumberIsNotLostWhetherItComesBeforeOrAfterTheGap) {
  Sequence s;
  s.take(0);
  s.excuse(1);
  s.take(3);
  EXPECT_EQ(s.counts().lost, 1);  // 2
  s.excuse(2);
  EXPECT_EQ(s.counts().lost, 0);
}

}  // namespace
}  // namespace tauext::test

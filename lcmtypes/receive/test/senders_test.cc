// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/receive/senders.h"

#include <gtest/gtest.h>

namespace tauext::test {
namespace {

using Whose = Senders::Whose;

TEST(SendersTest, AChannelIsItsFirstSendersUntilThatOneIsSilent) {
  Senders s;
  EXPECT_EQ(s.take(7, 0), Whose::kOurs);
  EXPECT_EQ(s.take(8, 499'999), Whose::kOther);
  EXPECT_EQ(s.take(8, 500'000), Whose::kNew);
  EXPECT_EQ(s.take(8, 500'001), Whose::kOurs);
  EXPECT_EQ(s.trouble(), "");  // a restart
}

TEST(SendersTest, WhoHasEndedLeavesTheChannelToTheNext) {
  Senders s;
  s.take(7, 0);
  s.end();
  EXPECT_EQ(s.take(8, 1), Whose::kOurs);
  EXPECT_EQ(s.take(7, 2), Whose::kOther);
}

TEST(SendersTest, WhoOnlyRepeatsHimselfDoesNotKeepAChannel) {
  Senders s;
  s.take(7, 0);
  for (int k = 1; k < 1000; ++k) {
    EXPECT_EQ(s.take(7, 1000 * k), k <= 500 ? Whose::kOurs : Whose::kOther) << k;
    s.out_of_turn(1000 * k);
    const Whose real = s.take(8, 1000 * k);
    EXPECT_EQ(real, k < 500 ? Whose::kOther : k == 500 ? Whose::kNew : Whose::kOurs) << k;
    if (real != Whose::kOther) s.in_turn(1000 * k);
  }
}

TEST(SendersTest, TwoThatSpeakInTurnsAreNamedHoweverSlow) {
  for (const std::int64_t period : {1'000, 100'000, 2'000'000}) {
    Senders s;
    s.take(7, 0);
    s.take(8, period);
    EXPECT_EQ(s.trouble(), "");
    s.take(7, 2 * period);
    EXPECT_NE(s.trouble(), "") << period;
  }
}

TEST(SendersTest, UnknownSendersAreBetrayedByMessagesOutOfTurn) {
  Senders few, many;
  for (int k = 0; k < 100; ++k) {
    EXPECT_EQ(many.take(0, 1000 * k), Whose::kOurs);
    many.out_of_turn(10'000 * k);
    few.out_of_turn(100'000 * k);
  }
  EXPECT_EQ(few.trouble(), "");
  EXPECT_NE(many.trouble(), "");
}

TEST(SendersTest, AreNamedAsAddressAndPort) {
  EXPECT_EQ(name_of((Sender{0x0a010203} << 16) + 40123), "10.1.2.3:40123");
  EXPECT_EQ(name_of(0), "an unknown sender");
}

}  // namespace
}  // namespace tauext::test

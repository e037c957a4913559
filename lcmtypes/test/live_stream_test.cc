// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/live_stream.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "bench/kit/allocations.h"
#include "lcmtypes/listener.h"
#include "lcmtypes/test/own_network.h"
#include "lcmtypes/test/samples.h"

namespace tauext::test {
namespace {

TEST(LiveStreamTest, ASubscriberGetsEveryMessageInOrder) {
  const auto transport = std::make_shared<Transport>("memq://");
  ASSERT_TRUE(transport->good());
  std::map<std::string, std::vector<std::int64_t>> seqs;
  Listener listener(transport->handle(), {"TAUEXT_*"},
                    [&](std::string_view channel, Sender, Bytes m) {
                      estimate_t e{};
                      ASSERT_EQ(decode(m, e), Reject::kNone);
                      seqs[std::string(channel)].push_back(e.seq);
                    });
  LiveStream stream(transport, {{"ekf", ""}, {"mo1", ""}}, 0);
  for (int k = 0; k < 1000; ++k) {
    EXPECT_TRUE(stream.push(live_sample(k, 0)));
    EXPECT_TRUE(stream.push(live_sample(k, 1)));
  }
  EXPECT_TRUE(stream.finish());
  while (listener.wait(0)) {
  }
  EXPECT_EQ(stream.counts().published, 2000);
  EXPECT_EQ(stream.counts().dropped, 0);
  for (const char* channel : {"TAUEXT_ESTIMATE_ekf", "TAUEXT_ESTIMATE_mo1"}) {
    ASSERT_EQ(seqs[channel].size(), 1000u);
    for (int k = 0; k < 1000; ++k) ASSERT_EQ(seqs[channel][k], k);
  }
}

TEST(LiveStreamTest, AFullRingDropsAndCounts) {
  const auto transport = std::make_shared<Transport>("memq://");
  LiveStream stream(transport, {{"ekf", ""}}, 0, 16);
  int accepted = 0;
  for (int k = 0; k < 20000; ++k) accepted += stream.push(live_sample(k));
  EXPECT_TRUE(stream.finish());
  EXPECT_EQ(stream.counts().dropped, 20000 - accepted);
  EXPECT_EQ(stream.counts().published, accepted);
  EXPECT_GT(stream.counts().dropped, 0);
}

TEST(LiveStreamTest, WithoutATransportMessagesFailAndTheLoopGoesOn) {
  LiveStream stream(nullptr, {{"ekf", ""}}, 200);
  for (int k = 0; k < 1000; ++k) EXPECT_TRUE(stream.push(live_sample(k)));
  EXPECT_TRUE(stream.finish());
  EXPECT_EQ(stream.counts().published, 0);
  EXPECT_NEAR(static_cast<double>(stream.counts().failed), 200, 2);
}

#ifndef TAUEXT_SANITIZED  // which brings its own malloc
TEST(LiveStreamTest, APushAllocatesNothing) {
  LiveStream stream(nullptr, {{"ekf", "pan_tompkins"}}, 200, 1 << 14);
  const LiveSample s = live_sample(1);
  EXPECT_EQ(allocations_of([&] {
              for (int k = 0; k < 5000; ++k) stream.push(s);
            }),
            0u);
}
#endif

TEST(LiveStreamTest, WhatIsHeldIsSentWhenTheSenderFallsSilent) {
  const auto transport = std::make_shared<Transport>("memq://");
  int marks = 0;
  Listener listener(transport->handle(), {"TAUEXT_DETECTION"},
                    [&](std::string_view, Sender, Bytes m) {
                      detection_t d{};
                      ASSERT_EQ(decode(m, d), Reject::kNone);
                      marks += d.mark;
                    });
  double largest = 0;
  Listener estimates(transport->handle(), {"TAUEXT_ESTIMATE_ekf"},
                     [&](std::string_view, Sender, Bytes m) {
                       estimate_t e{};
                       ASSERT_EQ(decode(m, e), Reject::kNone);
                       largest = std::max(largest, e.tau_ext_hat_max[0]);
                     });
  LiveStream stream(transport, {{"ekf", "pan_tompkins"}}, 1);
  for (int k = 0; k < 100; ++k) {
    LiveSample s = live_sample(k);
    s.mark = k == 50;
    if (k == 70) s.tau_ext_hat[0] = 77;
    stream.push(s);
  }
  for (int i = 0; i < 500 && (marks == 0 || largest < 77); ++i) listener.wait(10);
  EXPECT_EQ(marks, 1);
  EXPECT_EQ(largest, 77);
}

TEST(LiveStreamTest, AfterItsEndNothingIsTakenAndAllIsCounted) {
  LiveStream stream(nullptr, {{"ekf", ""}}, 0);
  EXPECT_TRUE(stream.push(live_sample(0)));
  EXPECT_TRUE(stream.finish());
  EXPECT_FALSE(stream.push(live_sample(1)));
  EXPECT_EQ(stream.counts().dropped, 1);
}

TEST(TransportTest, AServerThatIsNotThereCannotBeListenedTo) {
  EXPECT_THROW(Listener("tcpq://127.0.0.1:1", {"*"}, [](std::string_view, Sender, Bytes) {}),
               std::runtime_error);
}

TEST(TransportTest, AChannelsNameMeansItselfAloneUnlessItEndsInAStar) {
  const auto transport = std::make_shared<Transport>("memq://");
  std::vector<std::string> one, all;
  const auto into = [](std::vector<std::string>& heard) {
    return [&heard](std::string_view channel, Sender, Bytes) { heard.emplace_back(channel); };
  };
  Listener exact(transport->handle(), {"ARM(1)"}, into(one));
  Listener prefix(transport->handle(), {"ARM*"}, into(all));
  const auto m = bytes_of(estimate());
  for (const char* channel : {"ARM1", "ARM(1)", "XARM(1)"}) transport->publish(channel, m);
  while (exact.wait(0)) {
  }
  EXPECT_EQ(one, std::vector<std::string>{"ARM(1)"});
  EXPECT_EQ(all, (std::vector<std::string>{"ARM1", "ARM(1)"}));
}

#ifndef TAUEXT_SANITIZED  // which brings its own malloc
TEST(TransportTest, APublishOverMulticastAllocatesNothing) {
  enum : int { kNothing = 0, kAllocates = 1, kFails = 2 };
  const int code = in_own_network([] {
    Transport transport("udpm://239.255.76.67:7667?ttl=0");
    const auto m = bytes_of(estimate());
    bool sent = transport.publish("TAUEXT_ESTIMATE_ekf", m);  // the first may set something up
    const std::uint64_t count = allocations_of([&] {
      for (int k = 0; k < 1000; ++k) sent = transport.publish("TAUEXT_ESTIMATE_ekf", m) && sent;
    });
    return !sent ? kFails : count > 0 ? kAllocates : kNothing;
  });
  if (code == kForbidden) GTEST_SKIP() << "no network namespace of our own here";
  EXPECT_EQ(code, kNothing);
}
#endif

TEST(TransportTest, TroublesHaveARemedyAndNonsenseIsRefused) {
  for (const char* url :
       {"nonsense", "http://localhost", "udpm://1.2.3.4:7667", "udpm://239.1.1.1:0",
        "udpm://239.1.1.1:99999", "udpm://239.1.1.1:x", "udpm://239.1.1:7667",
        "udpm://239.1.1.1?ttl=foo", "udpm://239.1.1.1?tll=1", "udpm://239.1.1.1?ttl=256",
        "udpm://239.1.1.1?ttl=1x", "file:///tmp/x.lcm"}) {
    EXPECT_THROW(Transport{url}, std::invalid_argument) << url;
  }
  EXPECT_EQ(lcm_url("memq://"), "memq://");
  EXPECT_EQ(trouble_with("memq://"), "");
}

TEST(TransportTest, AFullDiskIsAFailureOfEachMessage) {
  Transport transport("file:///dev/full?mode=w");
  ASSERT_TRUE(transport.good());
  EXPECT_FALSE(transport.publish("A", bytes_of(estimate())));
  EXPECT_THROW(Transport("file:///nowhere/x.lcm?mode=w"), std::runtime_error);
}

TEST(TransportTest, ALogFollowsNoLink) {
  const std::string file = testing::TempDir() + "tauext_kept.txt",
                    link = testing::TempDir() + "tauext_link.lcm";
  std::ofstream(file) << "kept";
  std::filesystem::remove(link);
  std::filesystem::create_symlink(file, link);
  EXPECT_THROW(Transport("file://" + link + "?mode=w"), std::runtime_error);
  EXPECT_EQ(std::filesystem::file_size(file), 4u);
  Transport("file://" + file + "?mode=w").publish("A", bytes_of(estimate()));
  EXPECT_GT(std::filesystem::file_size(file), 28u) << "the file itself is replaced";
  std::filesystem::remove(file);
  std::filesystem::remove(link);
}

TEST(TransportTest, TheTestsOwnDefaultStaysInThisProcess) {
  EXPECT_EQ(lcm_url(""), "memq://");  // LCM_DEFAULT_URL of this test
}

TEST(TransportTest, AServerThatIsNotThereIsToldAndNothingWaits) {
  const auto transport = std::make_shared<Transport>("tcpq://127.0.0.1:1");
  const LiveSample s = live_sample(1);
  LiveStream stream(transport, {{"ekf", ""}}, 0);
  stream.push(s);
  EXPECT_TRUE(stream.finish(20));
  EXPECT_EQ(stream.counts().published, 0);
}

}  // namespace
}  // namespace tauext::test

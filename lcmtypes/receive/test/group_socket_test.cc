// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/receive/group_socket.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <stdexcept>
#include <string>

#include "lcmtypes/test/own_network.h"

namespace tauext::test {
namespace {

using namespace std::
    string_literals;  // NOLINT(google-build-using-namespace): of datagrams with zeros

Bytes bytes(const std::string& s) {
  return {reinterpret_cast<const std::byte*>(s.data()), s.size()};
}

std::string short_form(const std::string& channel, const std::string& message) {
  return "LC02\0\0\0\7"s + channel + '\0' + message;
}

// the two that end a process of LCM 1.3.1: the first part of a message, and one far beyond its end
const std::string kFirstPart = "LC03\0\0\0\1\0\0\3\350\0\0\0\0\0\0\0\2A\0xxxx"s;
const std::string kFarPart =
    "LC03\0\0\0\1\0\0\3\350\377\377\374\30\0\1\0\2"s + std::string(500, 'x');

TEST(DatagramTest, TheShortFormIsTakenApart) {
  Datagram d;
  const std::string whole = short_form("ARM", "\1\0\2"s);
  ASSERT_EQ(parse(bytes(whole), d), Refusal::kNone);
  EXPECT_EQ(d.channel, "ARM");
  EXPECT_EQ(d.message.size(), 3u);
  const std::string longest = short_form(std::string(63, 'c'), "");
  EXPECT_EQ(parse(bytes(longest), d), Refusal::kNone);
  EXPECT_EQ(d.channel.size(), 63u);
  EXPECT_TRUE(d.message.empty());
}

TEST(DatagramTest, NothingElseIs) {
  Datagram d;
  for (const std::string& wrong :
       {""s, "LC02"s, "LC02\0\0\0\7"s, "LC02\0\0\0\7\0x"s, "LC02\0\0\0\7ARM"s,
        "LC04\0\0\0\7ARM\0x"s, short_form(std::string(64, 'c'), "x")}) {
    EXPECT_EQ(parse(bytes(wrong), d), Refusal::kMalformed) << wrong;
  }
  EXPECT_EQ(parse(bytes(kFirstPart), d), Refusal::kFragment);
  EXPECT_EQ(parse(bytes(kFarPart), d), Refusal::kFragment);
  EXPECT_TRUE(d.channel.empty());
}

int sender() {
  return ::socket(AF_INET, SOCK_DGRAM, 0);
}

void send(int socket, const std::string& data, const char* address = "239.255.76.67") {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(7667);
  inet_pton(AF_INET, address, &to.sin_addr);
  ::sendto(socket, data.data(), data.size(), 0, reinterpret_cast<sockaddr*>(&to), sizeof to);
}

// messages that come within 0.2 s
int heard(GroupSocket& group, std::string_view channel) {
  int count = 0;
  pollfd ready{group.descriptor(), POLLIN, 0};
  while (::poll(&ready, 1, 200) > 0) {
    Datagram d;
    Sender from = 0;
    while (group.take(d, from)) count += d.channel == channel;
  }
  return count;
}

TEST(GroupSocketTest, HearsItsGroupAloneAndCountsWhatItRefuses) {
  const int code = in_own_network([] {
    GroupSocket group(group_url("udpm://239.255.76.67:7667"));
    const int one = sender();
    for (int i = 0; i < 50; ++i) {
      send(one, short_form("ARM", "good"));
      send(one, kFirstPart);
      send(one, kFarPart);
      send(one, "nonsense");
      send(one, short_form("ARM", "to an address"), "127.0.0.1");
    }
    const int good = heard(group, "ARM");
    const GroupSocket::Counts c = group.counts();
    return good != 50                   ? 1
           : c.fragments != 100         ? 2
           : c.malformed != 50          ? 3
           : c.outside + c.dropped != 0 ? 4
                                        : 0;
  });
  if (code == kForbidden) GTEST_SKIP() << "no network namespace of our own here";
  EXPECT_EQ(code, 0);
}

TEST(GroupSocketTest, WhatTheKernelDropsIsCounted) {
  const int code = in_own_network([] {
    GroupSocket group(group_url("udpm://239.255.76.67:7667?recv_buf_size=10000"));
    const int one = sender();
    constexpr int kSent = 5000;
    for (int i = 0; i < kSent; ++i) send(one, short_form("ARM", std::string(500, 'x')));
    const int good = heard(group, "ARM");
    return good > 0 && good < kSent && good + group.counts().dropped == kSent ? 0 : 1;
  });
  if (code == kForbidden) GTEST_SKIP() << "no network namespace of our own here";
  EXPECT_EQ(code, 0);
}

TEST(GroupSocketTest, NonsenseIsRefused) {
  for (const char* url : {"udpm://1.2.3.4:7667", "udpm://239.1.1.1:0", "tcpq://localhost",
                          "udpm://239.1.1.1?ttl=256", "udpm://239.1.1.1?recv_buf_size=0"}) {
    EXPECT_THROW(GroupSocket{group_url(url)}, std::invalid_argument) << url;
  }
}

}  // namespace
}  // namespace tauext::test

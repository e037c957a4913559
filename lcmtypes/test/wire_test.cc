// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/wire.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "lcmtypes/test/samples.h"

namespace tauext::test {
namespace {

// A change of a hash breaks every log and every subscriber: these are promises, not measurements.
// The last two are those of Drake's lcmt_iiwa_status and lcmt_panda_status, from lcm-gen on Drake's
// own files.
TEST(Wire, HashesAreThoseThatLogsWereWrittenWith) {
  EXPECT_EQ(static_cast<std::uint64_t>(sample_t::getHash()), 0x4fbf6b47af6662abULL);
  EXPECT_EQ(static_cast<std::uint64_t>(estimate_t::getHash()), 0xfbbbd82d4b247158ULL);
  EXPECT_EQ(static_cast<std::uint64_t>(detection_t::getHash()), 0x09b589357ed20fa0ULL);
  EXPECT_EQ(static_cast<std::uint64_t>(force_t::getHash()), 0xbf3937e8371897e0ULL);
  EXPECT_EQ(static_cast<std::uint64_t>(summary_t::getHash()), 0x2fb8b5fdaf154790ULL);
  EXPECT_EQ(static_cast<std::uint64_t>(iiwa_status_t::getHash()), 0xf16fb804284abca3ULL);
  EXPECT_EQ(static_cast<std::uint64_t>(panda_status_t::getHash()), 0x19571cdf4d82fae6ULL);
}

TEST(Wire, NoTwoTypesHaveTheSameMembers) {
  const std::set<std::int64_t> hashes = {sample_t::getHash(),      estimate_t::getHash(),
                                         detection_t::getHash(),   summary_t::getHash(),
                                         iiwa_status_t::getHash(), panda_status_t::getHash(),
                                         force_t::getHash()};
  EXPECT_EQ(hashes.size(), 7u);
}

TEST(Wire, WhatWasEncodedIsDecoded) {
  estimate_t e{};
  ASSERT_EQ(decode(bytes_of(estimate()), e), Reject::kNone);
  EXPECT_EQ(e.utime, 7000);
  EXPECT_EQ(e.samples, 5);
  EXPECT_EQ(e.tau_ext_hat[2], -98.2);
  summary_t s{};
  ASSERT_EQ(decode(bytes_of(summary()), s), Reject::kNone);
  EXPECT_EQ(s.key[1], "max_Nm");
  EXPECT_EQ(s.value[1], 102);
  detection_t d{};
  ASSERT_EQ(decode(bytes_of(detection()), d), Reject::kNone);
  EXPECT_EQ(d.detector, "pan_tompkins");
  force_t f{};
  ASSERT_EQ(decode(bytes_of(force()), f), Reject::kNone);
  EXPECT_EQ(f.force[2], -30);
  EXPECT_EQ(f.link, 4);
  EXPECT_EQ(f.site, "end_effector");
}

TEST(Wire, NotANumberAndInfinityTravel) {
  estimate_t e = estimate(), back{};
  e.q[0] = std::numeric_limits<double>::quiet_NaN();
  e.qd[0] = -std::numeric_limits<double>::infinity();
  ASSERT_EQ(decode(bytes_of(e), back), Reject::kNone);
  EXPECT_TRUE(std::isnan(back.q[0]));
  EXPECT_EQ(back.qd[0], e.qd[0]);
}

template <class Message>
void expect_reject(Reject reject, std::vector<std::byte> bytes, const char* what) {
  Message m{};
  m.utime = 4711;
  EXPECT_EQ(decode(bytes, m), reject) << what;
  EXPECT_EQ(m.utime, 4711) << what << ": the message was touched";
}

TEST(Wire, AMessageOfAnotherTypeIsForeign) {
  expect_reject<sample_t>(Reject::kForeign, bytes_of(estimate()), "estimate as sample");
  expect_reject<sample_t>(Reject::kForeign, {}, "empty");
  expect_reject<sample_t>(Reject::kForeign, std::vector<std::byte>(7), "half a hash");
}

TEST(Wire, EveryShorterAndEveryLongerMessageIsRejected) {
  const auto check = [](auto message) {
    using Type = decltype(message);
    const std::vector<std::byte> whole = bytes_of(message);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      Type m{};
      const std::vector<std::byte> cut(whole.begin(),
                                       whole.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_NE(decode(cut, m), Reject::kNone) << size;
    }
    std::vector<std::byte> longer = whole;
    longer.push_back(std::byte{0});
    expect_reject<Type>(Reject::kWrongSize, longer, "a byte more");
  };
  check(estimate());
  check(detection());
  check(force());
  check(summary());
}

// forges a big-endian int32
void forge(std::vector<std::byte>& bytes, std::size_t at, std::int32_t value) {
  for (int i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::byte>(value >> (24 - 8 * i));
}

TEST(Wire, AForgedCountIsRejected) {
  for (const std::int32_t n : {0, 9, -1, std::numeric_limits<std::int32_t>::max(),
                               std::numeric_limits<std::int32_t>::min()}) {
    std::vector<std::byte> bytes = bytes_of(estimate());
    forge(bytes, 8 + 3 * 8, n);  // behind hash, utime, seq, t
    expect_reject<estimate_t>(Reject::kWrongCount, bytes, "joints");
    iiwa_status_t iiwa{};
    iiwa.num_joints = 1;
    for (auto* v :
         {&iiwa.joint_position_measured, &iiwa.joint_velocity_estimated,
          &iiwa.joint_position_commanded, &iiwa.joint_position_ipo, &iiwa.joint_torque_measured,
          &iiwa.joint_torque_commanded, &iiwa.joint_torque_external}) {
      v->resize(1);
    }
    bytes = bytes_of(iiwa);
    forge(bytes, 8 + 8, n);
    expect_reject<iiwa_status_t>(Reject::kWrongCount, bytes, "joints of an iiwa");
  }
}

TEST(Wire, AForgedTimeOrNumberIsRejected) {
  for (const std::size_t at : {8u, 16u}) {  // utime, seq
    std::vector<std::byte> bytes = bytes_of(estimate());
    forge(bytes, at, -1);
    expect_reject<estimate_t>(Reject::kWrongTime, bytes, "negative");
    forge(bytes, at, 1 << 22);
    expect_reject<estimate_t>(Reject::kWrongTime, bytes, "2^54");
  }
  for (const double t : {0., 1e9, std::numeric_limits<double>::quiet_NaN()}) {
    estimate_t e = estimate();
    e.t = t;  // and utime says 7 ms
    expect_reject<estimate_t>(Reject::kWrongTime, bytes_of(e), "t and utime differ");
  }
}

TEST(Wire, AForgedLengthOfATextIsRejected) {
  for (const std::int32_t length : {0, -1, 5000, std::numeric_limits<std::int32_t>::max()}) {
    std::vector<std::byte> bytes = bytes_of(summary());
    forge(bytes, 8 + 8, length);  // of `program`
    expect_reject<summary_t>(Reject::kWrongCount, bytes, "program");
  }
}

TEST(Wire, WhatDoesNotFitIsNotEncoded) {
  std::vector<std::byte> small(100);
  EXPECT_EQ(encode(estimate(), small), 0u);
}

}  // namespace
}  // namespace tauext::test

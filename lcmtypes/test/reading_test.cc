// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/reading.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "lcmtypes/test/samples.h"

namespace tauext::test {
namespace {

void expect_same(const Reading& a, const Reading& b) {
  EXPECT_EQ(a.utime, b.utime);
  EXPECT_EQ(a.n, b.n);
  EXPECT_EQ(a.q, b.q);
  EXPECT_EQ(a.qd, b.qd);
  EXPECT_EQ(a.tau, b.tau);
  EXPECT_EQ(a.tau_ext, b.tau_ext);
}

TEST(ReadingTest, EveryTypeBringsBackWhatItWasGiven) {
  for (const int n : {1, 3, 7, 8}) {
    for (const MessageType type : {MessageType::kTauext, MessageType::kIiwa, MessageType::kPanda}) {
      const Reading sent = reading(1234, n);
      const std::vector<std::byte> bytes = write(sent, type);
      MessageType found{};
      ASSERT_EQ(type_of(bytes, found), Reject::kNone);
      EXPECT_EQ(found, type);
      Reading got;
      ASSERT_EQ(read(bytes, type, got), Reject::kNone);
      expect_same(sent, got);
      EXPECT_DOUBLE_EQ(got.t, 1.234);
    }
  }
}

TEST(ReadingTest, TheSampleKeepsTimeToTheLastBitAndTheContact) {
  Reading sent = reading(3), got;
  sent.utime = 300'000;
  sent.t = 0.1 + 0.2;
  sent.contact = true;
  ASSERT_EQ(read(write(sent, MessageType::kTauext), MessageType::kTauext, got), Reject::kNone);
  EXPECT_EQ(got.t, sent.t);
  EXPECT_EQ(got.seq, 3);
  EXPECT_TRUE(got.contact);
  EXPECT_EQ(got.reference, ReferenceKind::kTruth);
}

// Drake's manipulation/README.md: measured torque negated on the iiwa and correct on the Panda,
// external torque correct (positive where it accelerates the joint) on the iiwa and negated on the
// Panda
TEST(ReadingTest, EachDriverHasItsOwnSigns) {
  Reading r;
  r.n = 1;
  r.tau[0] = 10;      // holds the arm up
  r.tau_ext[0] = -2;  // the outside pushes in the joint's direction: +J^T f = 2
  iiwa_status_t iiwa{};
  ASSERT_EQ(decode(write(r, MessageType::kIiwa), iiwa), Reject::kNone);
  EXPECT_EQ(iiwa.joint_torque_measured[0], -10);
  EXPECT_EQ(iiwa.joint_torque_external[0], 2);
  panda_status_t panda{};
  ASSERT_EQ(decode(write(r, MessageType::kPanda), panda), Reject::kNone);
  EXPECT_EQ(panda.joint_torque[0], 10);
  EXPECT_EQ(panda.joint_torque_external[0], -2);
}

// drake_*_status.bin: written by a program with lcm-gen's C++ of Drake's own types, lcmtypes/
// lcmt_*_status.lcm (commit bf8ef803a732). Joint j of the type's f-th field is f + j/8
std::vector<std::byte> written_by_drake(const std::string& name) {
  std::ifstream file("lcmtypes/test/drake_" + name + "_status.bin", std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto* const begin = reinterpret_cast<const std::byte*>(text.data());
  return {begin, begin + text.size()};
}

void expect_field(const Joints& values, double field, double sign = 1) {
  for (int j = 0; j < 7; ++j) EXPECT_EQ(values[j], sign * (field + j / 8.0)) << field;
}

TEST(ReadingTest, WhatDrakesOwnTypesWroteIsRead) {
  Reading iiwa, panda;
  ASSERT_EQ(read(written_by_drake("iiwa"), MessageType::kIiwa, iiwa), Reject::kNone);
  ASSERT_EQ(read(written_by_drake("panda"), MessageType::kPanda, panda), Reject::kNone);
  for (const Reading* r : {&iiwa, &panda}) {
    EXPECT_EQ(r->utime, 1234567);
    EXPECT_EQ(r->n, 7);
    expect_field(r->q, 1);
  }
  expect_field(iiwa.qd, 2);
  expect_field(iiwa.tau, 5, -1);
  expect_field(iiwa.tau_ext, 7, -1);
  expect_field(panda.qd, 3);
  expect_field(panda.tau, 6);
  expect_field(panda.tau_ext, 8);
  panda_status_t whole{};
  ASSERT_EQ(decode(written_by_drake("panda"), whole), Reject::kNone);
  EXPECT_EQ(whole.control_command_success_rate, 0.75);
  EXPECT_EQ(whole.robot_mode, panda_status_t::kMove);
  EXPECT_EQ(whole.robot_utime, 7654321);
  EXPECT_EQ(whole.control_mode, panda_status_t::kTorque);
}

TEST(ReadingTest, AnEstimateIsAMeasurementToo) {
  estimate_t e = estimate();
  e.q[1] = 0.5;
  Reading r;
  ASSERT_EQ(read(bytes_of(e), MessageType::kTauext, r), Reject::kNone);
  EXPECT_EQ(r.q[1], 0.5);
  EXPECT_EQ(r.reference, ReferenceKind::kNone);
}

TEST(ReadingTest, AMessageOfAnotherTypeIsForeign) {
  Reading r;
  EXPECT_EQ(read(write(reading(1), MessageType::kPanda), MessageType::kIiwa, r), Reject::kForeign);
  EXPECT_EQ(read(bytes_of(summary()), MessageType::kTauext, r), Reject::kForeign);
  MessageType type{};
  EXPECT_EQ(type_of(bytes_of(summary()), type), Reject::kForeign);
}

TEST(ReadingTest, NamesAndJointsOutOfRangeAreRefused) {
  EXPECT_EQ(message_type("panda"), MessageType::kPanda);
  EXPECT_THROW(message_type("ur5"), std::invalid_argument);
  Reading r = reading(1);
  for (const int n : {0, 9, -1}) {
    r.n = n;
    EXPECT_THROW(write(r, MessageType::kTauext), std::invalid_argument);
  }
}

}  // namespace
}  // namespace tauext::test

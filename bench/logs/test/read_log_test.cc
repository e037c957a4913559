// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/read_log.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace tauext::test {
namespace {

// two seconds of a sine, with q, qd and t times factors, and what read_any_log() prints of them
struct Read {
  RecordedLog log;
  std::string messages;
};
Read read_sine(double q, double qd, double t, double gap = 0, double late = 0) {
  const std::string path =
      (std::filesystem::temp_directory_path() / fmt::format("tauext_read_log_{}.csv", ::getpid()))
          .string();
  std::ofstream file(path);
  file << "t,q1,qd1,tau1\n";
  for (int k = 0; k < 2000; ++k) {
    const double s = 0.001 * k, later = k > 1000 ? gap : 0;
    file << fmt::format("{},{},{},0\n", t * s + later, q * 0.5 * std::sin(3 * s),
                        qd * 1.5 * std::cos(3 * (s - late)));
  }
  file.close();
  testing::internal::CaptureStderr();
  RecordedLog log = read_any_log(path);
  std::filesystem::remove(path);
  return {std::move(log), testing::internal::GetCapturedStderr()};
}
std::string messages_of(double q, double qd, double t) {
  return read_sine(q, qd, t).messages;
}

TEST(ReadAnyLog, DoubtsUnitsThatCanHardlyBe) {
  constexpr double kDegrees = 180 / M_PI;
  EXPECT_EQ(messages_of(1, 1, 1), "");
  EXPECT_NE(messages_of(kDegrees, 1, 1).find("q1 moves 57.3 times as fast as qd1 says: are t, q"),
            std::string::npos);
  EXPECT_NE(messages_of(1, kDegrees, 1).find("0.0175 times as fast"), std::string::npos);
  EXPECT_NE(messages_of(1, 1, 1000).find("0.001 times as fast"), std::string::npos);
  EXPECT_NE(messages_of(1, 1, 1.2).find("q1 moves 0.833 times as fast as qd1 says"),
            std::string::npos);
  EXPECT_NE(messages_of(1, 1 / 1.1, 1).find("1.1 times as fast"), std::string::npos);
  EXPECT_EQ(messages_of(1, 1.02, 1), "");
  EXPECT_NE(messages_of(1, 1e-3, 1000).find("the samples are 1 apart on average"),
            std::string::npos);
  EXPECT_NE(messages_of(kDegrees, kDegrees, 1).find("q1 reaches 28.6, more than two turns"),
            std::string::npos);
}

TEST(ReadAnyLog, NothingIsLearntFromQAndQdThatContradictEachOther) {
  EXPECT_NO_THROW(read_sine(1, 1, 1).log.require_consistent("a.csv"));
  const RecordedLog degrees = read_sine(180 / M_PI, 1, 1).log;
  EXPECT_FALSE(degrees.usable());
  EXPECT_THROW(degrees.require_consistent("a.csv"), std::invalid_argument);
  EXPECT_TRUE(read_sine(1, -1, 1).log.contradicts);
  EXPECT_TRUE(read_sine(1, 0, 1).log.contradicts);
  EXPECT_NE(messages_of(1, 0, 1).find("q1 moves, and qd1 says that it rests"), std::string::npos);
  EXPECT_FALSE(read_sine(1e-4, 0, 1).log.contradicts) << "a joint at rest trembles";
  EXPECT_FALSE(read_sine(1, 1, 1, 5000).log.contradicts) << "over a gap qd says nothing";
}

TEST(ReadAnyLog, AVelocityOfAnotherTimeThanThePositionIsNamed) {
  for (const double late : {0.02, 0.05, -0.03}) {
    const Read found = read_sine(1, 1, 1, 0, late);
    EXPECT_TRUE(found.log.contradicts) << late;
    EXPECT_NE(
        found.messages.find(fmt::format("qd1 comes {:.0f} ms {} the motion of q1",
                                        1000 * std::abs(late), late > 0 ? "after" : "before")),
        std::string::npos)
        << found.messages;
  }
  EXPECT_FALSE(read_sine(1, 1, 1, 0, 0.01).log.contradicts) << "as a filter's may be";
}

// 1 kHz whose first sample came 0.9 ms early, of an encoder with steps of 1e-4 rad
TEST(ReadAnyLog, AShortFirstStepIsNoContradiction) {
  const std::string path =
      (std::filesystem::temp_directory_path() / fmt::format("tauext_burst_{}.csv", ::getpid()))
          .string();
  for (const double q : {1., 180 / M_PI}) {
    std::ofstream file(path);
    file << "t,q1,qd1,tau1\n";
    for (int k = 0; k < 3000; ++k) {
      const double s = 0.001 * k + (k == 0 ? 0.0009 : 0);
      file << fmt::format("{},{},{},0\n", s, q * 1e-4 * std::round(0.2e4 * std::sin(s)),
                          0.2 * std::cos(s));
    }
    file.close();
    testing::internal::CaptureStderr();
    EXPECT_EQ(read_any_log(path).contradicts, q > 1);
    testing::internal::GetCapturedStderr();
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace tauext::test

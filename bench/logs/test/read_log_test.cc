// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/read_log.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

namespace tauext::test {
namespace {

// what is said of two seconds of a sine, with q, qd and t times factors
std::string said_of(double q, double qd, double t) {
  const std::string path =
      (std::filesystem::temp_directory_path() / fmt::format("tauext_read_log_{}.csv", ::getpid()))
          .string();
  std::ofstream file(path);
  file << "t,q1,qd1,tau1\n";
  for (int k = 0; k < 2000; ++k) {
    const double s = 0.001 * k;
    file << fmt::format("{},{},{},0\n", t * s, q * 0.5 * std::sin(3 * s),
                        qd * 1.5 * std::cos(3 * s));
  }
  file.close();
  testing::internal::CaptureStderr();
  read_any_log(path);
  std::filesystem::remove(path);
  return testing::internal::GetCapturedStderr();
}

TEST(ReadAnyLog, DoubtsUnitsThatCanHardlyBe) {
  constexpr double kDegrees = 180 / M_PI;
  EXPECT_EQ(said_of(1, 1, 1), "");
  EXPECT_NE(said_of(kDegrees, 1, 1).find("q1 moves 57.3 times as fast as qd1 says: are t, q"),
            std::string::npos);
  EXPECT_NE(said_of(1, kDegrees, 1).find("0.0175 times as fast"), std::string::npos);
  EXPECT_NE(said_of(1, 1, 1000).find("0.001 times as fast"), std::string::npos);
  EXPECT_NE(said_of(kDegrees, kDegrees, 1).find("q1 reaches 28.6, more than two turns"),
            std::string::npos);
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/read_log.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
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
  EXPECT_NE(messages_of(1, 1e-3, 1000).find("the samples are 1 apart"), std::string::npos);
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

// whether read_any_log() makes something of a file of this text, and what it prints
std::pair<bool, std::string> read_text(const std::string& text) {
  const std::string path =
      (std::filesystem::temp_directory_path() / fmt::format("tauext_text_{}.csv", ::getpid()))
          .string();
  std::ofstream(path) << text;
  testing::internal::CaptureStderr();
  const bool usable = read_any_log(path).usable();
  std::filesystem::remove(path);
  return {usable, testing::internal::GetCapturedStderr()};
}
// that: something where it is not usable, else nothing
std::string messages_of_text(const std::string& text) {
  const auto [usable, messages] = read_text(text);
  EXPECT_EQ(usable, messages.empty()) << messages;
  return messages;
}

// of motions that end at the same time, as those from pose to pose do
TEST(ReadAnyLog, SpeedsOfEachOthersJointsAreNamed) {
  const auto messages_of_two = [](const std::string& names) {
    std::string text = names + "\n";
    for (int k = 0; k < 2000; ++k) {
      const double s = 0.001 * k, q = 0.5 * std::sin(3 * s), qd = 1.5 * std::cos(3 * s);
      text += fmt::format("{},{},{},{},{},0,0\n", s, q, 0.7 * q + 0.05 * std::sin(9 * s), qd,
                          0.7 * qd + 0.45 * std::cos(9 * s));
    }
    return messages_of_text(text);
  };
  EXPECT_EQ(messages_of_two("t,q1,q2,qd1,qd2,tau1,tau2"), "");
  EXPECT_NE(
      messages_of_two("t,q1,q2,qd2,qd1,tau1,tau2").find("q1 moves as qd2 says, and not as qd1"),
      std::string::npos);
}

// a quantity that a slower clock gives, by the number of its samples
TEST(ReadAnyLog, SamplesThatAreGivenAgainAreNamed) {
  const auto messages_of_held = [](int q, int qd, int tau) {
    const auto sine = [](int k) { return std::sin(0.003 * k); };
    std::string text = "t,q1,qd1,tau1\n";
    for (int k = 0; k < 2000; ++k)
      text += fmt::format("{},{},{},{}\n", 0.001 * k, 0.5 * sine(k / q * q),
                          1.5 * std::cos(0.003 * (k / qd * qd)), sine(k / tau * tau));
    return messages_of_text(text);
  };
  EXPECT_EQ(messages_of_held(1, 1, 1), "");
  EXPECT_EQ(messages_of_held(1, 1, 4), "") << "too short to matter";
  EXPECT_EQ(messages_of_held(10, 10, 10), "") << "no quantity is newer than another";
  const std::string again = " is new in every 10th sample only";
  EXPECT_NE(messages_of_held(1, 1, 10).find("tau" + again), std::string::npos);
  EXPECT_NE(messages_of_held(10, 1, 1).find("q" + again), std::string::npos);
  EXPECT_NE(messages_of_held(1, 10, 1).find("qd" + again), std::string::npos);
  // a joint at a constant speed, whose encoder takes seven samples a step
  std::string text = "t,q1,qd1,tau1\n";
  for (int k = 0; k < 5000; ++k)
    text += fmt::format("{},{},{},{}\n", 0.001 * k, 7e-4 * (k / 7), 0.1 + 1e-4 * std::sin(k),
                        std::cos(k));
  EXPECT_EQ(messages_of_text(text), "");
}

// in the middle of a recording, or from the begin
TEST(ReadAnyLog, AChannelThatStandsStillWhileItsJointMovesIsNamed) {
  const auto messages_of_two = [](auto&& q2, auto&& tau2) {
    std::string text = "t,q1,q2,qd1,qd2,tau1,tau2\n";
    for (int k = 0; k < 3000; ++k) {
      const double s = 0.001 * k, q = 0.5 * std::sin(3 * s), qd = 1.5 * std::cos(3 * s);
      text += fmt::format("{},{},{},{},{},{},{}\n", s, q, q2(k, q), qd, qd, q, tau2(k, q));
    }
    return messages_of_text(text);
  };
  const auto as_it_is = [](int, double q) { return q; };
  const auto still = [](int, double) { return 0.3; };
  EXPECT_EQ(messages_of_two(as_it_is, as_it_is), "");
  EXPECT_NE(messages_of_two(as_it_is, [](int k, double q) { return k < 1500 ? q : 0.3; })
                .find("tau of joint 2 stays the same, bit for bit, from t = 1.5 s on"),
            std::string::npos);
  EXPECT_NE(
      messages_of_two(as_it_is, [](int k, double q) { return std::abs(k - 1500) > 400 ? q : 0.3; })
          .find("tau of joint 2 stays the same, bit for bit, from t = 1.1 s on"),
      std::string::npos);
  EXPECT_EQ(messages_of_two(as_it_is, [](int, double q) { return std::round(q / 0.3) * 0.3; }), "");
  EXPECT_NE(messages_of_two(as_it_is, [](int k, double q) { return k < 1000 ? 0.3 : q; })
                .find("tau of joint 2 stays the same, bit for bit, from t = 0 s on"),
            std::string::npos);
  EXPECT_NE(messages_of_two(still, as_it_is).find("q2 rests, and qd2 says that it moves"),
            std::string::npos);
  EXPECT_NE(messages_of_two(as_it_is, [](int k, double) { return std::sin(k / 10 * 10.); })
                .find("tau of joint 2 is new in every 10th sample only"),
            std::string::npos);
}

// of an encoder with so many steps a turn, by central and by backward differences
TEST(ReadAnyLog, ASpeedThatIsRatherNoiseIsNamed) {
  const auto read = [](int steps, bool central, double noise) {
    const std::string path =
        (std::filesystem::temp_directory_path() / fmt::format("tauext_noise_{}.csv", ::getpid()))
            .string();
    const auto q = [&](int k) {
      const double step = 2 * M_PI / steps;
      return std::round(0.3 * std::sin(2e-3 * k) / step) * step;
    };
    std::mt19937_64 random(3);
    std::normal_distribution<> normal(0, 1);
    std::ofstream file(path);
    file << "t,q1,qd1,tau1\n";
    for (int k = 0; k < 4000; ++k)
      file << fmt::format("{},{},{},0\n", 1e-3 * k, q(k),
                          noise > 0 ? 0.6 * std::cos(2e-3 * k) + noise * normal(random)
                          : central ? (q(k + 1) - q(k - 1)) / 2e-3
                                    : (q(k) - q(k - 1)) / 1e-3);
    file.close();
    testing::internal::CaptureStderr();
    const bool usable = read_any_log(path).usable();
    std::filesystem::remove(path);
    return std::pair(usable, testing::internal::GetCapturedStderr());
  };
  for (const bool central : {false, true}) {
    for (const int steps : {1024, 4096}) {
      const auto [usable, words] = read(steps, central, 0);
      EXPECT_FALSE(usable);
      EXPECT_NE(words.find("qd1 is rather noise than motion, "), std::string::npos) << words;
    }
    EXPECT_TRUE(read(1 << 19, central, 0).first);
  }
  EXPECT_FALSE(read(1 << 19, false, 0.5).first);
  EXPECT_TRUE(read(1 << 19, false, 0.1).first);
}

// q trembles, goes on elsewhere after a gap, or comes round its circle
TEST(ReadAnyLog, RestsAndWrappedAnglesAreNoContradiction) {
  std::mt19937_64 random(3);
  std::normal_distribution<> normal(0, 1);
  std::string rests = "t,q1,qd1,tau1\n", turns = rests;
  for (int k = 0; k < 6000; ++k) {
    const double t = 1e-3 * k + 5 * (k / 2000), place = 0.5 * (k / 2000);
    rests += fmt::format("{},{},{},{}\n", t, place + 1e-5 * normal(random), 1e-3 * normal(random),
                         normal(random));
    const double angle = 3 + 0.5 * std::sin(2e-3 * k);
    turns += fmt::format("{},{},{},{}\n", 1e-3 * k, std::remainder(angle, 2 * M_PI),
                         std::cos(2e-3 * k), normal(random));
  }
  EXPECT_TRUE(read_text(rests).first) << read_text(rests).second;
  EXPECT_EQ(messages_of_text(turns), "");
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

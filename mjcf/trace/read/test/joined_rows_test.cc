// SPDX-License-Identifier: Apache-2.0
// Rows that have a part of a sample each.
#include "mjcf/trace/read/joined_rows.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "mjcf/test/error_of.h"
#include "mjcf/trace/read/recording.h"
#include "mjcf/trace/read/test/recording.h"

namespace tauext::test {
namespace {

struct Part {
  double t;       // [s]
  double q, tau;  // one of them NaN
  long line = 0;
};

// q at `q_step` and tau at `tau_step` [s], both with jitter and stretches that are missing, tau
// `delay` late, in the order in which a line of so much delay [s] brings them
std::vector<Part> parts(std::uint32_t seed, double q_step, double tau_step, double jitter,
                        double delay, double latency) {
  std::mt19937 random(seed);
  const auto any = [&](double most) { return most * (random() / 4294967296. - 0.5); };
  std::vector<std::pair<double, Part>> all;  // by arrival
  for (const bool tau : {false, true}) {
    const double step = tau ? tau_step : q_step;
    double arrival = 0;
    for (int k = 0; k * step < 4; ++k) {
      const double t = 1.7e9 + k * step + any(jitter * step) + (tau ? delay : 0);
      if (random() % 50 == 0 || std::abs(t - 1.7e9 - (tau ? 1 : 3)) < 0.1) continue;
      arrival = std::max(arrival, t + any(2 * latency));  // each topic keeps its order
      all.emplace_back(arrival, Part{t, tau ? NAN : t - 1.7e9, tau ? t - 1.7e9 : NAN});
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Part> parts;
  for (const auto& [arrival, part] : all) parts.push_back(part);
  return parts;
}

std::string csv_of(const std::vector<Part>& parts) {
  std::string csv = "t,q,qd,tau\n";
  for (const Part& p : parts)
    csv += std::isnan(p.tau) ? fmt::format("{:.17g},{:.17g},0,\n", p.t, p.q)
                             : fmt::format("{:.17g},,,{:.17g}\n", p.t, p.tau);
  return csv;
}

class Joined : public Recording {
 protected:
  Trace read(const std::string& csv, double within, const std::string& more = "") {
    skipped_ = {};
    const std::string map =
        put(fmt::format("join = {}\n[t]\ncolumns = 't'\n[q]\ncolumns = ['q']\n[qd]\n"
                        "columns = ['qd']\n[tau_instant]\ncolumns = ['tau']\n{}",
                        within, more),
            "map.toml");
    return read_recording(put(csv, "log.csv"), {map, "", {}}, &skipped_);
  }
  void expect_note(const std::string& part) const {
    const bool there =
        std::any_of(skipped_.notes.begin(), skipped_.notes.end(),
                    [&](const auto& n) { return n.find(part) != std::string::npos; });
    EXPECT_TRUE(there) << fmt::format("{}", fmt::join(skipped_.notes, "\n"));
  }

  SkippedRows skipped_;
};

// the nearest one among all, the earlier of two, by looking at each; a time in 1970's seconds has a
// resolution of 0.24 us
std::vector<std::pair<double, double>> nearest(const std::vector<Part>& parts, double within,
                                               bool of_tau) {
  std::vector<std::pair<double, double>> pairs;  // of t - 1.7e9
  for (const Part& a : parts) {
    if (std::isnan(of_tau ? a.tau : a.q)) continue;
    const Part* best = nullptr;
    for (const Part& b : parts) {
      if (std::isnan(of_tau ? b.q : b.tau)) continue;
      const double away = std::abs(b.t - a.t),
                   least = best ? std::abs(best->t - a.t) : within + 4.8e-7;
      if (best ? away < least || (away == least && b.t < best->t) : away <= least) best = &b;
    }
    if (best != nullptr) pairs.emplace_back(a.t - 1.7e9, best->t - 1.7e9);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

TEST_F(Joined, TakesTheNearestRowWhateverTheRatesAndTheOrder) {
  const struct {
    double q_step, tau_step, jitter, delay, latency, within;
  } cases[] = {{0.002, 0.002, 0, 1e-4, 0, 0.001},       {0.008, 0.008, 0.1, 0.004, 0, 0.005},
               {0.008, 0.008, 0.3, 0.004, 0.03, 0.003}, {0.001, 0.01, 0.5, 0, 0.1, 0.005},
               {0.01, 0.001, 0.5, 0.003, 0.1, 0.005},   {0.002, 0.003, 0.4, 0.02, 0.05, 0.1}};
  std::uint32_t seed = 1;
  for (const auto& c : cases) {
    SCOPED_TRACE(seed);
    const std::vector<Part> all = parts(seed++, c.q_step, c.tau_step, c.jitter, c.delay, c.latency);
    const Trace t = read(csv_of(all), c.within);
    const bool of_tau = c.tau_step * 1.4 > c.q_step;
    const auto want = nearest(all, c.within, of_tau);
    ASSERT_EQ(t.size(), static_cast<int>(want.size()));
    EXPECT_GT(t.size(), 100);
    for (int k = 0; k < t.size(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      EXPECT_NEAR(t.t[at], 1.7e9 + want[at].first, 1e-6);
      ASSERT_EQ(of_tau ? t.tau(0, k) : t.q(0, k), want[at].first);
      ASSERT_EQ(of_tau ? t.q(0, k) : t.tau(0, k), want[at].second);
    }
    const auto rows = std::count_if(
        all.begin(), all.end(), [&](const Part& p) { return !std::isnan(of_tau ? p.tau : p.q); });
    EXPECT_EQ(skipped_.alone, rows - t.size()) << "each of the others is counted";
    EXPECT_EQ(skipped_.total(), skipped_.alone);
  }
}

TEST_F(Joined, SaysFromHowFarAway) {
  std::string csv = "t,q,qd,tau,grip\n";
  for (int k = 0; k < 100; ++k)
    csv += fmt::format("{0:.4f},{1},0,,\n{2:.4f},,,{1},\n{2:.4f},,,,7\n", 0.01 * k, k,
                       0.01 * k + (k == 50 ? 0.003 : 0.001));
  const Trace t = read(csv, 0.005);
  ASSERT_EQ(t.size(), 100);
  EXPECT_EQ(t.q, t.tau);
  EXPECT_NEAR(t.t[7], 0.071, 1e-9) << "the time of the torque";
  expect_note(
      "joined by time (join = 0.005 s): 100 samples at the times of [tau_instant]; [q] taken from "
      "1.02 ms earlier on average, at most 3 ms away; [qd] taken from 1.02 ms earlier on average, "
      "at most 3 ms away; 100 rows have nothing of a sample");
}

TEST_F(Joined, TheToleranceIncludesItsEnd) {
  const std::string csv =
      "t,q,qd,tau\n1700000000.000,1,0,\n1700000000.005,,,2\n"
      "1700000000.020,3,0,\n1700000000.025002,,,4\n1700000000.040,5,0,\n"
      "1700000000.045,,,6\n";
  const Trace t = read(csv, 0.005);
  ASSERT_EQ(t.size(), 2);
  EXPECT_EQ(t.q(0, 1), 5);
  EXPECT_EQ(skipped_.alone, 1);
  EXPECT_EQ(skipped_.first.at(0), "line 5: no [q] within 0.005 s");
}

TEST_F(Joined, OfTwoAsNearTheEarlierOneIsTaken) {
  std::string csv = "t,q,qd,tau\n";
  for (int k = 0; k < 40; ++k)
    csv += k % 2 == 0 ? fmt::format("{},{},0,\n", 0.25 + k / 256., k)
                      : fmt::format("{},,,{}\n", 0.25 + k / 256., k);
  const Trace t = read(csv, 0.005);
  ASSERT_EQ(t.size(), 20);
  for (int k = 0; k < t.size(); ++k) EXPECT_EQ(t.q(0, k), t.tau(0, k) - 1);
}

// a step of a position that comes ten times as rarely would else be ten steps of nothing, and one
TEST_F(Joined, WhatComesRarelyGivesTheTimes) {
  std::string csv = "t,q,qd,tau\n";
  for (int k = 0; k < 1000; ++k)
    csv += fmt::format("{:.4f},,,{}\n", 0.001 * k, k) +
           (k % 10 == 0 ? fmt::format("{:.4f},{},0,\n", 0.001 * k + 0.0002, k) : "");
  const Trace t = read(csv, 0.005);
  ASSERT_EQ(t.size(), 100);
  EXPECT_EQ(t.q, t.tau);
  EXPECT_EQ(skipped_.total(), 0);
  expect_note("100 samples at the times of [q]");
  expect_note("900 rows serve none, 4 of them");
}

TEST_F(Joined, ARowThatServesTwiceIsCounted) {
  std::string csv = "t,q,qd,tau\n";
  for (int k = 0; k < 50; ++k)
    csv += (k == 20 ? "" : fmt::format("{:.3f},{},0,\n", 0.004 * k, k)) +
           fmt::format("{:.3f},,,{}\n", 0.004 * k + 0.001, k);
  const Trace t = read(csv, 0.005);
  ASSERT_EQ(t.size(), 50);
  EXPECT_EQ(t.q(0, 20), 21) << "3 ms later, and not 5 ms earlier";
  expect_note("1 rows serve more than one sample");
}

TEST_F(Joined, AStrayTimeIsLeftOutAndANewClockIsNotJoinedToTheOld) {
  std::string csv = "t,q,qd,tau\n";
  const auto add = [&](double t, int k) {
    csv += fmt::format("{:.4f},{},0,\n{:.4f},,,{}\n", t, k, t + 0.001, k);
  };
  for (int k = 0; k < 50; ++k) add(8 + 0.01 * k, k);
  csv += "1e9,7,0,\n";
  for (int k = 50; k < 100; ++k) add(8 + 0.01 * k, k);
  for (int k = 0; k < 50; ++k) add(7.8 + 0.01 * k, 100 + k);  // set back by 1.2 s
  const Trace t = read(csv, 0.004);
  EXPECT_EQ(t.size(), 150);
  EXPECT_EQ(t.q, t.tau);
  EXPECT_EQ(skipped_.time_order, 1);
  EXPECT_EQ(skipped_.first.at(0), "line 102: its time is not the next one");
  expect_note("its clock was set back by");
}

TEST_F(Joined, AMapThatIsWrongIsToldSo) {
  const std::string csv = "t,q,qd,tau\n0,1,0,\n0.001,,,\n0.01,1,0,\n0.011,,,\n";
  const std::string file = path("log.csv");
  EXPECT_EQ(error_of([&] { read(csv, 0.005); }),
            file + ": no row has [tau_instant]: column 'tau' is empty throughout");
  const std::string sorted =
      "t,q,qd,tau\n0,1,0,\n0.01,1,0,\n0.02,1,0,\n5,,,2\n5.01,,,2\n5.02,,,2\n";
  EXPECT_EQ(error_of([&] { read(sorted, 0.005); }),
            file +
                ": no usable row (3 skipped; line 5: no [q] within 0.005 s); with `join`, rows "
                "are in the order of their times, which are those of one clock");
  for (const char* wrong : {"0", "-0.001", "0.2", "'5 ms'"})
    EXPECT_NE(error_of([&] {
                read_recording(file, {put(fmt::format("join = {}\n", wrong), "m.toml"), "", {}},
                               &skipped_);
              }).find("m.toml: line 1: join must be"),
              std::string::npos)
        << wrong;
  EXPECT_NE(error_of([&] {
              read_recording(
                  file, {put("preset = 'tauext'\nrate = 100\njoin = 0.01\n", "m.toml"), "", {}},
                  &skipped_);
            }).find("it has a `rate`, and `join` is for rows with a time"),
            std::string::npos);
}

// as somebody sees it who does not know of the key
TEST_F(Joined, WithoutTheKeyTheErrorNamesTheHolesAndTheKey) {
  std::string csv = "t,q1,q2,qd1,qd2,tau1,tau2\n";
  for (int k = 0; k < 5; ++k) csv += fmt::format("{0},1,2,3,4,,\n{0}5,,,,,5,6\n", 0.01 * (k + 1));
  SkippedRows skipped;
  const std::string file = put(csv, "log.csv");
  EXPECT_EQ(
      error_of([&] { read_recording(file, {}, &skipped); }),
      file +
          ": no usable row (10 skipped; line 2: column 'tau1' is empty or not finite); 5 rows "
          "(line "
          "3, 5, 7 ..) have no [q] (column 'q1'), [qd] (column 'qd1'), 5 rows (line 2, 4, 6 ..) "
          "have no [tau] (column 'tau1'): where these come from several topics, join = 0.005 in a "
          "map of columns takes each from the row nearest in time, within so many seconds");
  const std::string never =
      put("t,q1,q2,qd1,qd2,tau1,tau2\n0,1,2,3,4,5,\n1,1,2,3,4,5,NA\n", "n.csv");
  EXPECT_EQ(error_of([&] { read_recording(never, {}, &skipped); }),
            never +
                ": no usable row (2 skipped; line 2: column 'tau2' is empty or not finite); 2 rows "
                "(line 2, 3) have no [tau] of joint 2 (column 'tau2'); [tau] of joint 2 (column "
                "'tau2') in none of them");
}

#ifndef TAUEXT_SANITIZED
TEST_F(Joined, HoldsNoMoreThanRowsOfHalfASecond) {
  JoinedRows joined("x.csv", 0.005, {"[t]", "[q]", "[tau]"}, 2, skipped_);
  const auto stand_still = [&] {
    for (int k = 0; k < 1'000'000; ++k)
      joined.take({1e-9 * k, k % 2 ? NAN : 1, k % 2 ? 1 : NAN}, k);
  };
  EXPECT_NE(error_of(stand_still).find("is the time in another unit?"), std::string::npos);
}
#endif

}  // namespace
}  // namespace tauext::test

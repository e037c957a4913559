// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "bench/outside/outside_score.h"
#include "bench/roster/robots.h"
#include "mjcf/record.h"
#include "mjcf/test/error_of.h"
#include "mjcf/trace/input_file.h"
#include "mjcf/trace/read/npy_writer.h"

namespace tauext::test {
namespace {

namespace fs = std::filesystem;

class Outside : public testing::Test {
 protected:
  Outside() : folder_(fs::temp_directory_path() / fmt::format("tauext_outside_{}", ::getpid())) {
    fs::create_directories(folder_);
    for (int k = 0; k < 1000; ++k) trace_.t.push_back(5 + 0.001 * k);
    trace_.q = trace_.qd = trace_.tau = Eigen::MatrixXd::Zero(2, 1000);
    trace_.tau_ext = Eigen::MatrixXd::Constant(2, 1000, 3);
    trace_.contact.assign(1000, 0);
    trace_.contact[500] = 1;
  }
  ~Outside() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  // rows of every sample that `row` has text for
  template <class Line>
  std::string put(const std::string& head, Line&& line) const {
    std::ofstream file(path("e.csv"));
    file << head << "\n";
    for (int k = 0; k < 1000; ++k) file << line(k);
    return path("e.csv");
  }
  std::vector<OutsideEstimates> read(const std::string& file) const {
    return read_estimates(file, "theirs", trace_);
  }
  std::string error(const std::string& file) const {
    return error_of([&] { read(file); });
  }

  fs::path folder_;
  Trace trace_;
};

// 1 N m off on joint 2, a mark 20 ms after the touch and one before it
TEST_F(Outside, EstimatesAndMarksAreScoredAsOursAre) {
  const std::string file = put("mark,tau_ext2,tau_ext1,t", [](int k) {
    return fmt::format("{},4,3,{}\n", k == 520 || k == 100 ? 1 : 0, 5 + 0.001 * k + 0.0003);
  });
  const std::vector<OutsideEstimates> all = read(file);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].estimator, "theirs");
  EXPECT_EQ(all[0].detector, "marks");
  const Row row = score_outside({.trace = &trace_, .group = "log"}, all[0]);
  EXPECT_EQ(row.entry.name(), "log/theirs+marks");
  EXPECT_EQ(row.score.error, "");
  EXPECT_NEAR(row.score.joint(Metric::kRmse, 0), 0, 1e-12);
  EXPECT_NEAR(row.score.joint(Metric::kRmse, 1), 1, 1e-12);
  EXPECT_NEAR(*row.score.get(Metric::kDelay), 0.02, 1e-9);
  EXPECT_EQ(row.score.get(Metric::kRecall), 1);
  EXPECT_EQ(row.score.get(Metric::kFalseAlarms), 1);
  EXPECT_FALSE(row.score.get(Metric::kNoise)) << "it cannot be known";
  EXPECT_FALSE(row.score.get(Metric::kCpu));
  const auto json =
      nlohmann::json::parse(results_json({row}, {{"tauext", "here"}, {"cpu", "ours"}}));
  EXPECT_EQ(json.at("benchmarks")[0].at("name"), "log/theirs+marks");
  EXPECT_NEAR(json.at("benchmarks")[0].at("rmse_Nm").get<double>(), 1, 1e-12);
  EXPECT_EQ(json.at("context"), (nlohmann::json{{"tauext", "here"}, {"cpu", "ours"}}));
}

TEST_F(Outside, SamplesWithoutAnEstimateKeepTheOneBefore) {
  const std::string file = put("t,tau_ext1,tau_ext2", [](int k) {
    return k % 10 == 3 ? std::string() : fmt::format("{},{},0\n", 5 + 0.001 * k, k);
  });
  const Output out = read(file)[0].output;
  EXPECT_EQ(out.counts.of(Status::kBadTime), 100);
  EXPECT_EQ(out.tau_ext(0, 13), 12);
  EXPECT_EQ(out.tau_ext(0, 14), 14);
}

TEST_F(Outside, SeveralEstimatorsStandInAFileOfReplay) {
  const std::string file =
      put("t,ekf_tau_ext1,ekf_tau_ext2,ekf_status,ekf_high_pass_mark,mo2:bandwidth=9_tau_ext1,"
          "mo2:bandwidth=9_tau_ext2,mo2:bandwidth=9_status",
          [](int k) { return fmt::format("{},1,2,{},0,3,4,0\n", 5 + 0.001 * k, k == 0 ? 1 : 0); });
  const std::vector<OutsideEstimates> all = read(file);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].estimator, "ekf");
  EXPECT_EQ(all[0].detector, "high_pass");
  EXPECT_EQ(all[0].output.counts.of(Status::kStarted), 1);
  EXPECT_EQ(all[1].estimator, "mo2:bandwidth=9");
  EXPECT_EQ(all[1].detector, "");
  EXPECT_TRUE(all[1].output.marks.empty());
  EXPECT_EQ(all[1].output.tau_ext(1, 700), 4);
}

TEST_F(Outside, NumPysArraysAreRowsOfTheSamples) {
  const Eigen::MatrixXd estimate = Eigen::MatrixXd::Constant(2, 1000, 7);
  const auto write_both = [&](const std::string& name, std::size_t rows) {
    write_npz(path(name + ".npz"), {{"tau_ext", estimate.data(), rows, 2}});
    const std::string bytes = read_whole(path(name + ".npz"));
    const std::size_t begin = bytes.find("\x93NUMPY");  // of its member, which is not compressed
    std::ofstream(path(name + ".npy"), std::ios::binary)
        << bytes.substr(begin, bytes.find("PK\1\2") - begin);
  };
  write_both("e", 1000);
  EXPECT_EQ(read(path("e.npy"))[0].output.tau_ext, estimate);
  EXPECT_EQ(read(path("e.npz"))[0].output.tau_ext, estimate);
  write_both("short", 999);
  EXPECT_EQ(error(path("short.npy")), path("short.npy") +
                                          ": 999 rows without times, and 1000 samples: a column t "
                                          "says which belong together");
}

TEST_F(Outside, WhatDoesNotBelongToTheLogIsRefused) {
  const auto both = [&](auto&& line) { return error(put("t,tau_ext1,tau_ext2", line)); };
  EXPECT_NE(
      both([](int k) {
        return fmt::format("{},0,0\n", k);
      }).find("999 of its 1000 rows are at times of no sample; the log goes from 5 to 5.999 s"),
      std::string::npos);
  EXPECT_NE(both([](int k) {
              return k < 400 ? fmt::format("{},0,0\n", 5 + 0.001 * k) : "";
            }).find("600 of the 1000 samples have no estimate of theirs"),
            std::string::npos);
  EXPECT_NE(both([](int) { return ""; }).find("no row of numbers"), std::string::npos);
  EXPECT_NE(error(put("t,tau_ext1", [](int k) { return fmt::format("{},0\n", k); }))
                .find("theirs has 1 columns of tau_ext, and the log 2 joints"),
            std::string::npos);
  EXPECT_NE(error(put("t,torque", [](int k) { return fmt::format("{},0\n", k); }))
                .find("no columns tau_ext1"),
            std::string::npos);
}

// mo2 beside a sensor that knows the force itself
TEST(OutsideSensor, IsComparedAsTorques) {
  const Robot& r = robot("wallmobot3");
  const Scenario& s = scenario_of(r, "push");
  Trace trace = record(r.load_for(s), s);
  ASSERT_GT(trace.force.cols(), 0);
  const Eigen::MatrixXd truth = trace.tau_ext;
  trace.tau_ext.resize(0, 0);
  take_sensor(r, trace);
  EXPECT_LT((trace.tau_ext_of_driver - truth).cwiseAbs().maxCoeff(), 1e-6);
  const Output out = r.run("mo2", trace);
  const Row row = score_outside({&trace, "log", &r, nullptr, 1}, {"mo2", "", out});
  EXPECT_GT(row.score.get(Metric::kMakerCorrelation).value(), 0.99);
  EXPECT_NEAR(row.score.get(Metric::kMakerGain).value(), 1, 0.01);
  EXPECT_NEAR(row.score.get(Metric::kMakerLag).value(), 0.048, 0.02);
}

// one that is not finite fails, as ours would
TEST_F(Outside, AnEstimateThatIsNoneFails) {
  const std::string file = put("t,tau_ext1,tau_ext2", [](int k) {
    return fmt::format("{},0,{}\n", 5 + 0.001 * k, k == 700 ? "nan" : "0");
  });
  const Row row = score_outside({.trace = &trace_, .group = "log"}, read(file)[0]);
  EXPECT_NE(row.score.error.find("not finite at t = 5.7"), std::string::npos) << row.score.error;
}

// of a log of 60 s at 100 Hz, touched from 20 to 21 s and from 40 to 41 s
struct Log {
  Log() {
    constexpr int n = 6000;
    trace.q = trace.qd = trace.tau = Eigen::MatrixXd::Zero(1, n);
    trace.contact.assign(n, 0);
    for (int k = 0; k < n; ++k) trace.t.push_back(100 + 0.01 * k);
    std::fill_n(trace.contact.begin() + 2000, 100, 1);
    std::fill_n(trace.contact.begin() + 4000, 100, 1);
    output.tau_ext = Eigen::MatrixXd::Zero(1, n);
    output.status.assign(n, Status::kOk);
    output.marks.assign(n, 0);
  }
  Score score(double from = -std::numeric_limits<double>::infinity()) const {
    const std::vector<LogRun> runs = {{&trace, &output, from}};
    Score s;
    add_floor_metrics(runs, s);
    add_vendor_metrics(runs, s);
    add_label_metrics(runs, s);
    return s;
  }

  Trace trace;
  Output output;
};

TEST(LogMetrics, FloorAndDriftAreOfWhatNobodyTouches) {
  Log log;
  for (int k = 0; k < 6000; ++k) log.output.tau_ext(0, k) = k % 2 == 0 ? 3 : -3;
  log.output.tau_ext.block(0, 2000, 1, 100).setConstant(50);
  log.output.tau_ext.block(0, 4000, 1, 100).setConstant(50);
  EXPECT_NEAR(*log.score().get(Metric::kFloor), 3, 1e-12);
  EXPECT_NEAR(*log.score().get(Metric::kDrift), 0, 0.01);
  log.output.tau_ext.array() += Eigen::ArrayXXd::Map(log.trace.t.data(), 1, 6000) / 60;  // 1 N m
  // the thirds of 5760 untouched samples begin 4080 samples apart
  EXPECT_NEAR(*log.score().get(Metric::kDrift), 0.68, 0.001);
  log.trace.contact.clear();
  EXPECT_TRUE(log.score().get(Metric::kFloor)) << "all of it";
  log.trace.force = Eigen::Matrix3Xd::Zero(3, 6000);
  EXPECT_FALSE(log.score().get(Metric::kFloor)) << "nobody says when a force acts";
}

TEST(LogMetrics, MarksAreCountedAgainstLabelsWithIntervals) {
  Log log;
  log.output.marks[1000] = log.output.marks[2005] = 1;  // one too many, one 50 ms late
  const Score s = log.score();
  EXPECT_EQ(*s.get(Metric::kRecall), 0.5);
  EXPECT_NEAR(*s.get(Metric::kRecallLow), 0.0945, 1e-3);  // Wilson, 1 of 2
  EXPECT_NEAR(*s.get(Metric::kRecallHigh), 0.9055, 1e-3);
  EXPECT_NEAR(*s.get(Metric::kDelayMedian), 0.05, 1e-9);
  EXPECT_EQ(*s.get(Metric::kFalseAlarms), 1);
  EXPECT_NEAR(*s.get(Metric::kFalseAlarmsPerHour), 60, 0.02);
  EXPECT_NEAR(*s.get(Metric::kFalseAlarmsHigh), 60 * 5.5716, 0.1);
  EXPECT_EQ(*log.score(115).get(Metric::kFalseAlarms), 0);  // it was earlier
}

TEST(LogMetrics, TheMakersEstimateIsComparedWithOurs) {
  Log log;
  log.trace.tau_ext_of_driver.resize(1, 6000);
  const auto load = [](double t) { return 5 * std::sin(t) + 2 * std::sin(3.3 * t); };
  for (const double late : {0.15, -0.15}) {
    for (int k = 0; k < 6000; ++k) {
      log.output.tau_ext(0, k) = load(0.01 * k - late);
      log.trace.tau_ext_of_driver(0, k) = 2 * load(0.01 * k);
    }
    for (const double from : {-std::numeric_limits<double>::infinity(), 110.}) {
      const Score s = log.score(from);
      EXPECT_GT(*s.get(Metric::kMakerCorrelation), 0.9);
      EXPECT_NEAR(*s.get(Metric::kMakerGain), 2, 0.15);
    }
  }
  // the same size, as a lag is that with the least difference
  log.trace.tau_ext_of_driver /= 2;
  for (const double late : {0.15, 0., -0.15}) {
    for (int k = 0; k < 6000; ++k) log.output.tau_ext(0, k) = load(0.01 * k - late);
    for (const double from : {-std::numeric_limits<double>::infinity(), 110.})
      EXPECT_NEAR(*log.score(from).get(Metric::kMakerLag), late, 1e-9) << from;
  }
}

}  // namespace
}  // namespace tauext::test

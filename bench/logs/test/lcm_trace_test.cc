// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/lcm_trace.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "bench/live/entry_tap.h"
#include "bench/logs/lcm_reader.h"
#include "bench/score/suite.h"
#include "mjcf/record.h"
#include "mjcf/trace/test/same_trace.h"

namespace tauext {
namespace {

namespace fs = std::filesystem;

class LcmTrace : public testing::Test {
 protected:
  LcmTrace()
      : path_(fs::temp_directory_path() / ("tauext_trace_" + std::to_string(::getpid()) + ".lcm")) {
  }
  ~LcmTrace() override { fs::remove(path_); }

  static Trace truth() {
    Scenario s = scenario("wallmobot3", "collision");
    s.duration = 0.5;
    s.contact = [](double t, const Point&) { return t > 0.2 && t < 0.3; };
    return record(load_for("wallmobot3", s), s);
  }
  void put(LogBuffer& log) const {
    std::ofstream(path_, std::ios::binary) << std::string(log.bytes());
  }
  // the first `count` readings, each as change(k, reading) leaves it
  template <class Change>
  void put_changed(const std::vector<Reading>& all, int count, const Change& change) const {
    LogBuffer log;
    for (int k = 0; k < count; ++k) {
      Reading r = all[k];
      change(k, r);
      log.append("TAUEXT_SAMPLE", r.utime, write(r, MessageType::kTauext));
    }
    put(log);
  }
  // far ahead, by as many microseconds more
  static void put_ahead(int more, Reading& r) {
    r.utime = (std::int64_t{1} << 52) + more;
    r.t = static_cast<double>(r.utime) * 1e-6;
  }
  Trace get(const std::string& channel = "") {
    LcmReader reader(path_.string(), channel);
    Trace trace = trace_of(reader);
    report_ = reader.report();
    return trace;
  }
  std::string error(const std::string& channel = "") {
    try {
      get(channel);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "no error";
  }

  fs::path path_;
  LogReport report_;
};

TEST_F(LcmTrace, AnOwnLogComesBackToTheLastBit) {
  const Trace t = truth();
  LogBuffer log;
  append_samples(readings_of(t), MessageType::kTauext, log);
  put(log);
  const Trace back = get();
  test::expect_same(back, t);
  EXPECT_EQ(report_.in_words(), "");
  EXPECT_EQ(report_.channel, "TAUEXT_SAMPLE");
}

TEST_F(LcmTrace, ADriversLogHasNoTruthAndMicroseconds) {
  const Trace t = truth();
  for (const MessageType type : {MessageType::kIiwa, MessageType::kPanda}) {
    LogBuffer log;
    append_samples(readings_of(t), type, log);
    put(log);
    const Trace back = get();
    EXPECT_FALSE(back.has_truth());  // what the driver estimates is none
    EXPECT_EQ(back.tau_ext_of_driver, t.tau_ext);
    EXPECT_EQ(readings_of(back)[1].reference, ReferenceKind::kSender);
    EXPECT_EQ(readings_of(back)[1].tau_ext, readings_of(t)[1].tau_ext);
    EXPECT_EQ(back.tau, t.tau);
    EXPECT_EQ(back.size(), t.size());
    EXPECT_NEAR(back.t.back(), t.t.back(), 1e-6);
  }
}

TEST_F(LcmTrace, AWallClockCountsFromTheFirstSample) {
  const Trace t = truth();
  std::vector<Reading> late = readings_of(t);
  for (Reading& r : late) {
    r.utime += 1'800'000'000'000'000;
    r.t += 1.8e9;
  }
  LogBuffer log;
  append_samples(late, MessageType::kIiwa, log);
  put(log);
  EXPECT_EQ(get().t[0], 0);
  EXPECT_NEAR(get().t[1], 1e-3, 1e-6);
}

TEST_F(LcmTrace, WhatIsWrongInALogIsCounted) {
  const std::vector<Reading> all = readings_of(truth());
  LogBuffer log;
  const auto add = [&](const Reading& r) {
    log.append("TAUEXT_SAMPLE", r.utime, write(r, MessageType::kTauext));
  };
  for (int k = 0; k < 100; ++k) {
    if (k == 30 || k == 31) continue;  // lost
    add(all[k]);
    if (k == 50) add(all[50]);  // repeated
    if (k == 60) add(all[40]);  // late: lost messages are not found again by it
  }
  Reading other = all[100];
  other.n = 2;
  add(other);
  log.append("TAUEXT_SAMPLE", 0, Bytes());
  put(log);
  EXPECT_EQ(get().size(), 98);
  EXPECT_EQ(report_.out_of_order, 2);
  EXPECT_EQ(report_.lost, 2);
  EXPECT_EQ(report_.rejected, 2);  // the other arm, and the empty one
}

TEST_F(LcmTrace, OneBadMessageDoesNotSpoilALog) {
  const std::vector<Reading> all = readings_of(truth());
  put_changed(all, 200, [](int k, Reading& r) {
    if (k == 0) r.n = 2;  // the first is another arm's
    if (k == 100) put_ahead(0, r);
  });
  const Trace back = get();
  EXPECT_EQ(back.size(), 198);
  EXPECT_EQ(back.t[100], all[102].t);
  EXPECT_EQ(report_.rejected, 2);
  EXPECT_EQ(report_.out_of_order, 0);
}

TEST_F(LcmTrace, FalseTimesAreBorneAtTheBeginAndInARow) {
  const std::vector<Reading> all = readings_of(truth());
  put_changed(all, 300, [](int k, Reading& r) {
    if (k == 0 || k == 100 || k == 150) put_ahead(k, r);  // each farther
  });
  const Trace back = get();
  EXPECT_EQ(back.size(), 297);
  EXPECT_EQ(back.t[0], all[1].t);
  EXPECT_EQ(back.t[99], all[101].t);
  EXPECT_EQ(back.t[148], all[151].t);
  EXPECT_EQ(report_.rejected, 3);
  EXPECT_EQ(report_.out_of_order, 0);
}

TEST_F(LcmTrace, ASenderThatWasRestartedIsAnError) {
  const std::vector<Reading> all = readings_of(truth());
  LogBuffer log;
  for (int k = 0; k < 400; ++k) {
    const Reading& r = all[k < 300 ? k : k - 200];
    log.append("TAUEXT_SAMPLE", r.utime, write(r, MessageType::kTauext));
  }
  put(log);
  EXPECT_NE(error().find("time goes back on channel TAUEXT_SAMPLE"), std::string::npos) << error();
}

TEST_F(LcmTrace, TimesBelowZeroAreShifted) {
  Trace t = truth();
  for (double& time : t.t) time -= 0.25;
  const std::vector<Reading> all = readings_of(t);
  EXPECT_EQ(all[0].t, 0);
  EXPECT_NEAR(all.back().t, 0.499, 1e-12);
}

TEST_F(LcmTrace, ChannelsAreChosenByNameOrBecauseThereIsNoChoice) {
  const std::vector<Reading> all = readings_of(truth());
  LogBuffer log;
  for (int k = 0; k < 10; ++k) {
    log.append("LEFT", all[k].utime, write(all[k], MessageType::kIiwa));
    log.append("RIGHT", all[k].utime, write(all[k], MessageType::kIiwa));
  }
  put(log);
  EXPECT_NE(error().find("choose one of its channels by --channel: LEFT, RIGHT"), std::string::npos)
      << error();
  EXPECT_NE(error("UP").find("no measurements on channel UP; it has LEFT, RIGHT"),
            std::string::npos);
  EXPECT_EQ(get("RIGHT").size(), 10);
}

TEST_F(LcmTrace, AnEntrysLogIsTheSameFromRunToRunAndHoldsItAll) {
  std::string logs[2];
  for (std::string& bytes : logs) {
    Suite suite{SuiteOptions()};
    const Entry entry{"testbed1", "hold", "mo1", "contact_classifier"};
    LogBuffer log;
    const Suite::Run run = suite.run(entry);
    append_entry(entry, run.trace, run.output, run.detections, suite.score(entry), log);
    bytes = log.bytes();
    put(log);
  }
  EXPECT_TRUE(logs[0] == logs[1]);
  std::map<std::string, int> count;
  read_log(path_.string(), [&](const LogEvent& e) { ++count[std::string(e.channel)]; });
  const int samples = get().size();
  EXPECT_EQ(count, (std::map<std::string, int>{{"TAUEXT_SAMPLE", samples},
                                               {"TAUEXT_ESTIMATE_mo1", samples},
                                               {"TAUEXT_DETECTION", samples},
                                               {"TAUEXT_SUMMARY", 1}}));
}

TEST_F(LcmTrace, NamesOfLogs) {
  EXPECT_TRUE(is_lcm_log("a/b.lcm"));
  EXPECT_TRUE(is_lcm_log("/x/lcmlog-2026-11-21.00"));
  EXPECT_FALSE(is_lcm_log("b.csv"));
  EXPECT_FALSE(is_lcm_log("-"));
  EXPECT_FALSE(is_lcm_log("lcmlog.csv"));
}

}  // namespace
}  // namespace tauext

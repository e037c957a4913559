// SPDX-License-Identifier: Apache-2.0
// The programs that write and read logs: tauext-record, -replay and -identify, and the suite's logs
// of LCM.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <sstream>
#include <string>

#include "bench/test/programs.h"
#include "lcmtypes/emitter.h"
#include "lcmtypes/log.h"
#include "lcmtypes/reading.h"

namespace tauext::test {
namespace {

TEST_F(Programs, RecordWritesTheSameBitsForTheSameSeed) {
  const std::string base =
      "tauext-record --robot wallmobot3 --scenario free --velocity_noise 1e-3 --seed ";
  EXPECT_EQ(run(base + "7 --out a.csv").code, 0);
  EXPECT_EQ(run(base + "7 --out b.csv").code, 0);
  EXPECT_EQ(run(base + "8 --out c.csv").code, 0);
  EXPECT_EQ(content("a.csv"), content("b.csv"));
  EXPECT_NE(content("a.csv"), content("c.csv"));
}

TEST_F(Programs, NoneReplacesAFileThatItReads) {
  run("tauext-record --robot wallmobot3 --scenario free --out log.csv");
  run("tauext-record --robot wallmobot3 --scenario free --out log.lcm");
  run_system("ln log.csv hard.csv; ln -s log.csv soft.csv; cp " + kMjcf +
             "/wallmobot3.xml arm.xml");
  run("tauext-detect --calibrate t.json --estimator mo1 --detector threshold --runs 1");
  write("d.json", R"({"velocity_noise": 1e-4})");
  const std::string replay = "tauext-replay log.csv --estimator mo1 --robot ";
  const std::string live = "tauext-live --robot wallmobot3 --estimator mo1 --from log.lcm --lcm ";
  for (const auto& [file, command] : std::vector<std::pair<std::string, std::string>>{
           {"log.csv", replay + "wallmobot3 --out ./log.csv"},
           {"log.csv", replay + "wallmobot3 --out hard.csv"},
           {"log.csv", replay + "wallmobot3 --out soft.csv"},
           {"arm.xml", replay + "arm.xml --out arm.xml"},
           {"log.lcm", live + "'file://log.lcm?mode=w'"},
           {"t.json", live + "'file://t.json?mode=w' --detector threshold --thresholds t.json"},
           {"t.json",
            "tauext-detect --thresholds t.json --out t.json --estimator mo1 --detector "
            "threshold --collisions 1 --hours 0"},
           {"d.json", "tauext-bench --degrade d.json --benchmark_out=d.json"},
           {"d.json",
            "tauext-record --robot wallmobot3 --scenario free --degrade d.json --out "
            "d.json"}}) {
    const std::string before = content(file);
    ASSERT_FALSE(before.empty()) << file;
    const Outcome o = run(command);
    EXPECT_EQ(o.code, 2) << command << o.text;
    EXPECT_TRUE(o.says("is read by this program; write to another file")) << command << o.text;
    EXPECT_TRUE(content(file) == before) << command;
  }
  const Outcome o = run_system("LCM_DEFAULT_URL='file://log.lcm?mode=w' " + kBin + "/" + live);
  EXPECT_TRUE(o.says("log.lcm: is read by this program")) << o.text;
}

TEST_F(Programs, RecordStopsTheMotorAtAMark) {
  const Outcome o = run(
      "tauext-record --robot testbed1 --scenario collision --stop ndob+pan_tompkins --out c.csv");
  EXPECT_EQ(o.code, 0);
  EXPECT_TRUE(o.says("stopped at 5.0")) << o.text;
  const Outcome wrong =
      run("tauext-record --robot testbed1 --scenario collision --stop ndob --out d.csv");
  EXPECT_EQ(wrong.code, 2);
  EXPECT_TRUE(wrong.says("like ekf+pan_tompkins")) << wrong.text;
  const Outcome cell =
      run("tauext-record --robot testbed1 --scenario hold --loadcell nois=1 --out d.csv");
  EXPECT_EQ(cell.code, 2);
  EXPECT_TRUE(cell.says("loadcell: there is no key 'nois'; known: scale [1] 0 to 1000"))
      << cell.text;
  EXPECT_FALSE(exists("d.csv"));
}

TEST_F(Programs, WritingToALinkWritesItsTarget) {
  fs::create_symlink(folder_ / "target.csv", folder_ / "link.csv");
  EXPECT_EQ(run("tauext-record --robot testbed1 --scenario hold --out link.csv").code, 0);
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.csv"));
  EXPECT_EQ(content("target.csv").substr(0, 5), "t,q1,");
}

TEST_F(Programs, LogsRepeatByteByByteAndADiskThatIsFullIsAnError) {
  const std::string log =
      "tauext-bench --benchmark_filter='testbed1/collision/mo1.contact_classifier' "
      "--benchmark_min_time=0.01 --lcm-log ";
  EXPECT_EQ(run(log + "a").code, 0);
  EXPECT_EQ(run(log + "b").code, 0);
  const std::string name = "/testbed1_collision_mo1+contact_classifier.lcm";
  EXPECT_GT(content("a" + name).size(), 1'000'000u);
  EXPECT_TRUE(content("a" + name) == content("b" + name));
  fs::create_symlink("/dev/full", folder_ / "a" / "testbed1_collision_ndob+contact_classifier.lcm");
  const Outcome suite =
      run("tauext-bench --benchmark_filter='testbed1/collision/(mo1|ndob).contact_classifier' "
          "--benchmark_min_time=0.01 --lcm-log a");
  EXPECT_EQ(suite.code, 1) << suite.text;  // one entry failed, the others are there
  EXPECT_TRUE(suite.says("testbed1/collision/mo1+contact_classifier")) << suite.text;
  fs::create_symlink("/dev/full", folder_ / "full.lcm");
  const Outcome o = run("tauext-record --robot testbed1 --scenario hold --out full.lcm");
  EXPECT_EQ(o.code, 2) << o.text;
  EXPECT_TRUE(o.says("No space left on device")) << o.text;
}

// the sum of all doubles of a message, which is what DecodeLog.java prints
template <std::size_t N>
double sum(const double (&values)[N]) {
  return std::accumulate(values, values + N, 0.0);
}
double sum(const sample_t& m) {
  return m.t + sum(m.q) + sum(m.qd) + sum(m.tau) + sum(m.tau_ext_true);
}
double sum(const estimate_t& m) {
  return m.t + sum(m.q) + sum(m.qd) + sum(m.tau) + sum(m.tau_ext_true) + sum(m.tau_ext_hat) +
         sum(m.tau_ext_true_min) + sum(m.tau_ext_true_max) + sum(m.tau_ext_hat_min) +
         sum(m.tau_ext_hat_max) + m.step_us;
}
double sum(const detection_t& m) {
  return m.score;
}
double sum(const summary_t& m) {
  return m.rmse_Nm + m.step_ns + std::accumulate(m.value.begin(), m.value.end(), 0.0);
}

struct Decoded {
  std::string type;
  std::int64_t count = 0, first = 0, last = 0;
  double doubles = 0;

  template <class Message>
  void add(Bytes bytes, const char* name) {
    Message m{};
    ASSERT_EQ(decode(bytes, m), Reject::kNone);
    type = name;
    if (count++ == 0) first = m.utime;
    last = m.utime;
    doubles += sum(m);
  }
};

TEST_F(Programs, LcmSpyDecodesAnEntrysLogAsWeDo) {
#ifndef TAUEXT_JAVA
  GTEST_SKIP() << "no Java at build time: default-jdk-headless, liblcm-java";
#else
  ASSERT_EQ(run("tauext-bench --benchmark_filter='testbed1/collision/mo1.contact_classifier' "
                "--benchmark_min_time=0.01 --lcm-log .")
                .code,
            0);
  const std::string log = "testbed1_collision_mo1+contact_classifier.lcm";
  std::map<std::string, Decoded> expected;
  read_log((folder_ / log).string(), [&](const LogEvent& e) {
    Decoded& d = expected[std::string(e.channel)];
    if (e.channel == kSampleChannel) d.add<sample_t>(e.message, "tauext.sample_t");
    if (e.channel == kDetectionChannel) d.add<detection_t>(e.message, "tauext.detection_t");
    if (e.channel == kSummaryChannel) d.add<summary_t>(e.message, "tauext.summary_t");
    if (e.channel.starts_with(kEstimateChannel)) d.add<estimate_t>(e.message, "tauext.estimate_t");
  });
  const std::string classes = kBin + "/../lcmtypes/plugin";
  const Outcome java = run_system(TAUEXT_JAVA ":" + classes + "/tauext_spy.jar:" + classes +
                                  "/test_classes DecodeLog " + log);
  ASSERT_EQ(java.code, 0) << java.text;
  std::istringstream lines(java.text);
  std::size_t channels = 0;
  Decoded got;
  for (std::string name;
       lines >> name >> got.type >> got.count >> got.first >> got.last >> got.doubles;) {
    ASSERT_TRUE(expected.contains(name)) << java.text;
    const Decoded& e = expected[name];
    EXPECT_EQ(got.type, e.type);
    EXPECT_EQ(got.count, e.count);
    EXPECT_EQ(got.first, e.first);
    EXPECT_EQ(got.last, e.last);
    EXPECT_NEAR(got.doubles, e.doubles, 1e-9 * (1 + std::abs(e.doubles))) << name;
    ++channels;
  }
  EXPECT_EQ(channels, 4u) << java.text;
#endif
}

// the same log in other words gives the same errors
TEST_F(Programs, ReplayReadsALogByAMapOfItsColumns) {
  ASSERT_EQ(run("tauext-record --robot wallmobot3 --scenario sine --out log.csv").code, 0);
  ASSERT_EQ(run("tauext-record --robot wallmobot3 --scenario sine --out log.npz").code, 0);
  write("map.toml", R"(
separator = ";"
[t]
columns = "ms"
unit = "ms"
[q]
columns = 'angle (\d)'
unit = "deg"
[qd]
columns = 'speed (\d)'
sign = -1
[current]
columns = 'drive (\d)'
gain = 25
[tau_ext]
columns = 'load (\d)'
)");
  const char* const other =
      R"(awk -F, 'NR == 1 { print "ms;angle 1;angle 2;angle 3;speed 1;speed 2;speed 3;drive 1;drive 2;drive 3;load 1;load 2;load 3;note"; next }
        { printf "%.9g;%.17g;%.17g;%.17g;%.17g;%.17g;%.17g;%.17g;%.17g;%.17g;%s;%s;%s;at rest\n", 1000 * $1,
          $2 * 57.295779513082323, $3 * 57.295779513082323, $4 * 57.295779513082323, -$5, -$6, -$7, $8 / 25, $9 / 25, $10 / 25,
          $11, $12, $13 }' log.csv >other.csv)";
  ASSERT_EQ(run_system(other).code, 0);
  const std::string how = " --robot wallmobot3 --estimator mo2 --torque held --out est.csv";
  const Outcome ours = run("tauext-replay log.csv" + how), npz = run("tauext-replay log.npz" + how),
                theirs = run("tauext-replay other.csv --columns map.toml" + how);
  EXPECT_EQ(ours.code, 0) << ours.text;
  EXPECT_EQ(npz.text, ours.text);
  EXPECT_EQ(theirs.code, 0) << theirs.text;
  EXPECT_TRUE(theirs.says("30000 samples in 29.999 s, one every 1 ms")) << theirs.text;
  const auto table = [](const Outcome& o) { return o.text.substr(o.text.find("estimator ")); };
  EXPECT_EQ(table(theirs), table(ours));
  const Outcome none = run("tauext-replay other.csv --columns ur" + how);
  EXPECT_EQ(none.code, 2);
  EXPECT_TRUE(none.says("unknown preset of columns 'ur'; known: tauext, libfranka, ur_rtde"))
      << none.text;
}

// mo2 by its file, by the suite and by the scorer itself
TEST_F(Programs, ScoreOfAFileIsThatOfTheSuite) {
  run("tauext-record --robot wallmobot3 --scenario collision --out log.csv");
  run("tauext-replay log.csv --robot wallmobot3 --estimator mo2 --detector pan_tompkins --out "
      "theirs.csv");
  const std::string run_of = " --robot wallmobot3 --scenario collision";
  const Outcome o = run("tauext-score theirs.csv --estimator mo1,mo2 --out s.json" + run_of);
  ASSERT_EQ(o.code, 0) << o.text;
  EXPECT_TRUE(o.says("wallmobot3/collision/mo2+pan_tompkins") || o.says("+pan_tompkins")) << o.text;
  ASSERT_EQ(run("tauext-bench --benchmark_filter='wallmobot3/collision/mo2([+]pan_tompkins)?$' "
                "--benchmark_min_time=0.001 --benchmark_out=b.json")
                .code,
            0);
  const auto scores = nlohmann::json::parse(content("s.json")).at("benchmarks");
  const auto suite = nlohmann::json::parse(content("b.json")).at("benchmarks");
  ASSERT_EQ(scores.size(), 3U);
  ASSERT_EQ(suite.size(), 2U);
  for (const char* key : {"rmse_Nm", "rmse_Nm_joint2", "bias_Nm", "max_Nm", "max_at_s"}) {
    const double theirs = scores[0].at(key);
    EXPECT_NEAR(theirs, scores[2].at(key).get<double>(), 1e-9) << key;
    EXPECT_NEAR(theirs, suite[0].at(key).get<double>(), 1e-9) << key;
  }
  for (const char* key : {"delay_s", "recall", "false_alarms"})
    EXPECT_EQ(scores[0].at(key), suite[1].at(key)) << key;
  // and by a file of NumPy
  run("tauext-replay log.csv --robot wallmobot3 --estimator mo2 --detector pan_tompkins --out "
      "theirs.npz");
  run("tauext-score theirs.npz --out n.json" + run_of);
  EXPECT_EQ(nlohmann::json::parse(content("n.json")).at("benchmarks")[0], scores[0]);
  const Outcome by_log = run("tauext-score theirs.csv --log log.csv --format csv");
  EXPECT_EQ(by_log.code, 0) << by_log.text;
  EXPECT_TRUE(by_log.says("log/mo2+pan_tompkins,")) << by_log.text;
  EXPECT_EQ(run("tauext-score theirs.csv").code, 2);
  EXPECT_EQ(run("tauext-score theirs.csv --log nothing.csv").code, 2);
}

}  // namespace
}  // namespace tauext::test

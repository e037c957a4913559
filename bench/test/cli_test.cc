// SPDX-License-Identifier: Apache-2.0
// The programs as a user meets them: exit codes, messages, files.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "bench/test/optimised.h"

namespace tauext::test {
namespace {

namespace fs = std::filesystem;

struct Outcome {
  int code;
  std::string text;  // standard output and standard error
  bool says(const std::string& what) const { return text.find(what) != std::string::npos; }
};

class Programs : public testing::Test {
 protected:
  Programs() : folder_(fs::temp_directory_path() / ("tauext_cli_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~Programs() override { fs::remove_all(folder_); }

  Outcome run(const std::string& command) const {
    const std::string line = "cd " + folder_.string() + " && (" TAUEXT_BIN "/" + command + ") 2>&1";
    std::FILE* const pipe = ::popen(line.c_str(), "r");
    Outcome o{-1, ""};
    std::array<char, 4096> buffer;
    for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
      o.text.append(buffer.data(), n);
    const int status = ::pclose(pipe);
    o.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    return o;
  }
  std::string content(const std::string& name) const {
    std::ostringstream out;
    out << std::ifstream(folder_ / name).rdbuf();
    return out.str();
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  bool exists(const std::string& name) const { return fs::exists(folder_ / name); }

  fs::path folder_;
};

constexpr const char* kQuick = " --benchmark_min_time=0.001";

TEST_F(Programs, HelpFitsAScreenAndShowsAnExampleAndExitsWith0) {
  for (const std::string name :
       {"tauext-bench", "tauext-detect", "tauext-identify", "tauext-record", "tauext-replay"}) {
    const Outcome o = run(name + " --help");
    EXPECT_EQ(o.code, 0);
    EXPECT_TRUE(o.says("  " + name + " ")) << o.text;
    EXPECT_LE(std::count(o.text.begin(), o.text.end(), '\n'), 30) << o.text;
    std::istringstream in(o.text);
    for (std::string l; std::getline(in, l);) EXPECT_LE(l.size(), 100u) << l;
    EXPECT_TRUE(run(name + " --version").says(name + " 0."));
  }
}

TEST_F(Programs, UnknownNamesListTheKnownOnesAndExitWith2) {
  const Outcome robot = run("tauext-record --robot r2d2 --scenario step --out x.csv");
  EXPECT_EQ(robot.code, 2);
  EXPECT_TRUE(robot.says("unknown robot 'r2d2'; known: wallmobot3, testbed1")) << robot.text;
  const Outcome scenario = run("tauext-record --robot wallmobot3 --scenario dance --out x.csv");
  EXPECT_EQ(scenario.code, 2);
  EXPECT_TRUE(scenario.says("unknown scenario 'dance' of wallmobot3; known: free, step"))
      << scenario.text;
  EXPECT_FALSE(exists("x.csv"));
  run("tauext-record --robot wallmobot3 --scenario step --out log.csv");
  const Outcome estimator =
      run("tauext-replay log.csv --robot wallmobot3 --estimator ekf,guess --out est.csv");
  EXPECT_EQ(estimator.code, 2);
  EXPECT_TRUE(estimator.says("unknown estimator 'guess'; known: zero, truth")) << estimator.text;
  const Outcome detector =
      run("tauext-replay log.csv --robot wallmobot3 --estimator ekf --detector ear --out est.csv");
  EXPECT_EQ(detector.code, 2);
  EXPECT_TRUE(detector.says("unknown detector 'ear'; known: pan_tompkins")) << detector.text;
  EXPECT_FALSE(exists("est.csv"));
}

TEST_F(Programs, WrongFlagsExitWith2) {
  for (const std::string command :
       {"tauext-bench --nonsense", "tauext-record --seed 99999999999999999999", "tauext-identify",
        "tauext-bench --reliability --benchmark_out=r.json", "tauext-bench --benchmark_nonsense=1",
        "tauext-record --seed x", "tauext-record", "tauext-replay",
        "tauext-bench --benchmark_format=csv", "tauext-bench --benchmark_out_format=csv",
        "tauext-bench --benchmark_repetitions=0 --benchmark_filter=free/zero",
        "tauext-bench --list > /dev/full",
        "tauext-record --robot wallmobot3 --scenario free --velocity_noise -1 --out x.csv"}) {
    const Outcome o = run(command);
    EXPECT_EQ(o.code, 2) << command << '\n' << o.text;
    EXPECT_FALSE(o.text.empty()) << command;
  }
}

TEST_F(Programs, UnwritableOutputExitsWith2AndNamesThePath) {
  for (const std::string command :
       {"tauext-record --robot wallmobot3 --scenario free --out /nowhere/x",
        "tauext-bench --benchmark_filter=free/zero --benchmark_out=/nowhere/x",
        "tauext-record --robot wallmobot3 --scenario free --out /dev/full"}) {
    const Outcome o = run(command);
    EXPECT_EQ(o.code, 2) << o.text;
    EXPECT_TRUE(o.says("/nowhere/x: cannot open") || o.says("/dev/full: cannot write")) << o.text;
  }
}

TEST_F(Programs, AFilterThatMatchesNothingExitsWith2) {
  const Outcome o = run("tauext-bench --benchmark_filter=nosuchthing --benchmark_out=r.json");
  EXPECT_EQ(o.code, 2);
  EXPECT_TRUE(o.says("matches nothing")) << o.text;
  EXPECT_FALSE(exists("r.json"));
}

TEST_F(Programs, RecordWritesTheSameBitsForTheSameSeed) {
  const std::string base =
      "tauext-record --robot wallmobot3 --scenario free --velocity_noise 1e-3 --seed ";
  EXPECT_EQ(run(base + "7 --out a.csv").code, 0);
  EXPECT_EQ(run(base + "7 --out b.csv").code, 0);
  EXPECT_EQ(run(base + "8 --out c.csv").code, 0);
  EXPECT_EQ(content("a.csv"), content("b.csv"));
  EXPECT_NE(content("a.csv"), content("c.csv"));
}

TEST_F(Programs, BenchPrintsATableAndWritesValidJson) {
  const Outcome o =
      run("tauext-bench --benchmark_filter=step/ --benchmark_out=r.json --benchmark_repetitions=2" +
          std::string(kQuick));
  EXPECT_EQ(o.code, 0) << o.text;
  EXPECT_TRUE(o.says("wallmobot3/step/ekf ")) << o.text;
  EXPECT_TRUE(o.says("rmse"));
  EXPECT_TRUE(o.says("never")) << "zero never settles";
  const auto json = nlohmann::json::parse(content("r.json"));
  ASSERT_TRUE(json.contains("benchmarks"));
  bool found = false;
  for (const auto& b : json["benchmarks"]) {
    if (b["name"] != "wallmobot3/step/ekf") continue;
    found = true;
    for (const char* key : {"rmse_Nm", "rmse1_Nm", "settling_s", "rise_s", "cpu_ns"}) {
      EXPECT_TRUE(b.contains(key)) << key;
    }
  }
  EXPECT_TRUE(found);
  // zero is asked whether it settles, and never does
  for (const auto& b : json["benchmarks"]) {
    if (b["name"] != "wallmobot3/step/zero") continue;
    EXPECT_FALSE(b.contains("settling_s"));
    EXPECT_NE(b["label"].get<std::string>().find("settling_s"), std::string::npos) << b;
  }
#ifndef __SANITIZE_ADDRESS__  // whose malloc is not counted
  EXPECT_TRUE(o.says("allocs")) << o.text;
#endif
}

TEST_F(Programs, GoogleBenchmarksOwnFormatsStillWork) {
  const Outcome console = run(
      "tauext-bench --benchmark_filter=free/ndob --benchmark_format=console" + std::string(kQuick));
  EXPECT_EQ(console.code, 0);
  EXPECT_TRUE(console.says("Iterations")) << console.text;
  run("tauext-bench --benchmark_filter=free/ndob --benchmark_format=json" + std::string(kQuick) +
      " 2>/dev/null > j.json");
  EXPECT_TRUE(nlohmann::json::accept(content("j.json"))) << content("j.json");
}

TEST_F(Programs, ListNamesEveryEntry) {
  const Outcome o = run("tauext-bench --list");
  EXPECT_EQ(o.code, 0);
  EXPECT_TRUE(o.says("wallmobot3/collision/ekf+pan_tompkins\n"));
}

TEST_F(Programs, ReplayWritesOneRowPerSampleAndPrintsTheErrors) {
  run("tauext-record --robot wallmobot3 --scenario collision --out log.csv");
  const Outcome o =
      run("tauext-replay log.csv --robot wallmobot3 --estimator ekf,truth --detector pan_tompkins "
          "--out est.csv");
  EXPECT_EQ(o.code, 0) << o.text;
  EXPECT_TRUE(o.says("recall 1")) << o.text;
  const std::string est = content("est.csv");
  EXPECT_EQ(est.substr(0, est.find('\n')),
            "t,ekf_tau_ext1,ekf_tau_ext2,ekf_tau_ext3,ekf_status,ekf_pan_tompkins_mark,"
            "truth_tau_ext1,truth_tau_ext2,truth_tau_ext3,truth_status,truth_pan_tompkins_mark");
  EXPECT_EQ(std::count(est.begin(), est.end(), '\n'), 30001);
  const Outcome one = run(
      "tauext-replay log.csv --robot wallmobot3 --estimator ndob --detector pan_tompkins --out -");
  EXPECT_EQ(one.text.substr(0, one.text.find('\n')),
            "t,ndob_tau_ext1,ndob_tau_ext2,ndob_tau_ext3,ndob_status,pan_tompkins_mark");
}

TEST_F(Programs, ReplayWorksWithoutTruthAndReportsBadRows) {
  write("log.csv",
        "t,q1,q2,q3,qd1,qd2,qd3,tau1,tau2,tau3\n"
        "0,0,0,0,0,0,0,1,2,3\n"
        "0.001,0,0,0,0,0,inf,1,2,3\n"
        "0.002,0,0\n"
        "0.003,0,0,0,0,0,0,1,2,3\n");
  const Outcome o = run("tauext-replay log.csv --robot wallmobot3 --estimator ndob --out est.csv");
  EXPECT_EQ(o.code, 0) << o.text;
  EXPECT_TRUE(o.says("skipped 2 rows")) << o.text;
  EXPECT_TRUE(o.says("line 3: a field is not finite")) << o.text;
  const std::string est = content("est.csv");
  EXPECT_EQ(std::count(est.begin(), est.end(), '\n'), 3);
  const Outcome truth =
      run("tauext-replay log.csv --robot wallmobot3 --estimator truth --out e2.csv");
  EXPECT_EQ(truth.code, 2);
  EXPECT_TRUE(truth.says("needs columns tau_ext1..")) << truth.text;
  const Outcome twice =
      run("tauext-replay log.csv --robot wallmobot3 --estimator ndob,ndob --out e2.csv");
  EXPECT_EQ(twice.code, 2);
  EXPECT_TRUE(twice.says("'ndob' is named twice")) << twice.text;
}

TEST_F(Programs, ReplayRefusesLogsItCannotUse) {
  run("tauext-record --robot wallmobot3 --scenario free --out log.csv");
  const std::string before = content("log.csv");
  const Outcome itself =
      run("tauext-replay log.csv --robot wallmobot3 --estimator ndob --out ./log.csv");
  EXPECT_EQ(itself.code, 2);
  EXPECT_TRUE(itself.says("is the log itself")) << itself.text;
  EXPECT_EQ(content("log.csv"), before);
  write("empty.csv", "t,q1,q2,q3,qd1,qd2,qd3,tau1,tau2,tau3\nx\n");
  write("two.csv", "t,q1,q2,qd1,qd2,tau1,tau2\n0,1,2,3,4,5,6\n");
  const Outcome empty =
      run("tauext-replay empty.csv --robot wallmobot3 --estimator ndob --out est.csv");
  EXPECT_EQ(empty.code, 2);
  EXPECT_TRUE(empty.says("empty.csv: no usable row (1 skipped")) << empty.text;
  const Outcome two =
      run("tauext-replay two.csv --robot wallmobot3 --estimator ndob --out est.csv");
  EXPECT_EQ(two.code, 2);
  EXPECT_TRUE(two.says("wallmobot3 has 3 joints, the samples have 2")) << two.text;
  EXPECT_FALSE(exists("est.csv"));
}

TEST_F(Programs, IdentifyPrintsTheParametersAndWritesThem) {
  run("tauext-record --robot testbed1 --scenario identify --loadcell noise=1 --out log.csv");
  const Outcome o = run(
      "tauext-identify --terms inertia,gravity_cos,gravity_sin,coulomb log.csv --out theta.csv");
  EXPECT_EQ(o.code, 0) << o.text;
  EXPECT_TRUE(o.says("condition number")) << o.text;
  EXPECT_TRUE(o.says("gravity_cos    kg m                  11.66")) << o.text;
  const std::string csv = content("theta.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "term,unit,estimate,std_error");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
  const Outcome term = run("tauext-identify log.csv --terms magic --out t2.csv");
  EXPECT_EQ(term.code, 2);
  EXPECT_TRUE(term.says("unknown term 'magic'; known: inertia, gravity_cos")) << term.text;
  run("tauext-record --robot wallmobot3 --scenario free --out three.csv");
  const Outcome three = run("tauext-identify three.csv --out t2.csv");
  EXPECT_EQ(three.code, 2);
  EXPECT_TRUE(three.says("the log has 3 joints")) << three.text;
  EXPECT_FALSE(exists("t2.csv"));
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
  EXPECT_TRUE(cell.says("'nois=1' is not KEY=NUMBER")) << cell.text;
  EXPECT_FALSE(exists("d.csv"));
}

TEST_F(Programs, ReplayOfALogInWrongUnitsIsAnErrorAndNotAnEstimate) {
  // milliseconds in place of seconds: every sample lies beyond the longest gap
  std::string log = "\xEF\xBB\xBFt,q1,qd1,tau1\n";  // with a byte order mark
  for (int k = 0; k < 100; ++k) log += std::to_string(k) + ",0.1,0,115\n";
  write("ms.csv", log);
  const Outcome o = run("tauext-replay --robot testbed1 --estimator ekf,ndob ms.csv --out est.csv");
  EXPECT_EQ(o.code, 1) << o.text;
  EXPECT_TRUE(o.says("Samples are 1 s apart")) << o.text;
}

TEST_F(Programs, WritingToALinkWritesItsTarget) {
  fs::create_symlink(folder_ / "target.csv", folder_ / "link.csv");
  EXPECT_EQ(run("tauext-record --robot testbed1 --scenario hold --out link.csv").code, 0);
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.csv"));
  EXPECT_EQ(content("target.csv").substr(0, 5), "t,q1,");
}

TEST_F(Programs, DetectCalibratesThenStudiesWithThatFile) {
  if (!kOptimised) GTEST_SKIP() << "takes minutes here; Release runs it";
  const Outcome trained = run("tauext-detect --calibrate th.json --train known_0 --runs 1");
  ASSERT_EQ(trained.code, 0) << trained.text;
  const std::string small =
      " --conditions known_0 --estimators mo1 --detectors contact_classifier --collisions 1 "
      "--hours 0 "
      "--pushes 0 --clampings 1";
  const Outcome study = run("tauext-detect --thresholds th.json --out study.json" + small);
  ASSERT_EQ(study.code, 0) << study.text;
  EXPECT_TRUE(study.says("mo1+contact_classifier")) << study.text;
  const auto json = nlohmann::json::parse(content("study.json"));
  EXPECT_EQ(json["cells"][0]["detector"], "contact_classifier");
  // the suite reads the file, too
  const Outcome suite =
      run("tauext-bench --thresholds th.json '--benchmark_filter=wallmobot3/clamp/mo1[+]'" +
          std::string(kQuick));
  EXPECT_EQ(suite.code, 0) << suite.text;
}

TEST_F(Programs, DetectRefusesWhatItCannotDoBeforeItWorks) {
  write("bad.json", "{");
  const Outcome bad = run("tauext-detect --thresholds bad.json");
  EXPECT_EQ(bad.code, 2);
  EXPECT_TRUE(bad.says("tauext-detect: bad.json: ")) << bad.text;
  EXPECT_EQ(run("tauext-detect --calibrate /nowhere/th.json").code, 2);
  EXPECT_EQ(run("tauext-detect --out /nowhere/s.json").code, 2);
  EXPECT_TRUE(run("tauext-detect --conditions moon").says("unknown condition 'moon'; known: "));
  EXPECT_EQ(run("tauext-detect --margin 0.5 --calibrate x.json").code, 2);
  EXPECT_FALSE(exists("x.json"));
  EXPECT_TRUE(run("tauext-detect --list").says("unknown_150"));
  EXPECT_EQ(run("tauext-bench --equal-bandwidth 1000").code, 2);
  EXPECT_EQ(run("tauext-bench --pareto --list").code, 2);
  EXPECT_EQ(run("tauext-bench --degrade /nowhere.json").code, 2);
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
// The programs as a user meets them: exit codes, messages, files.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "bench/test/programs.h"

namespace tauext::test {
namespace {

TEST_F(Programs, HelpFitsAScreenAndShowsAnExampleAndExitsWith0) {
  for (const std::string name : {"tauext-bench", "tauext-detect", "tauext-calibrate",
                                 "tauext-import", "tauext-live", "tauext-record", "tauext-render",
                                 "tauext-replay", "tauext-report", "tauext-score", "tauext-tune"}) {
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
  const Outcome tuned = run("tauext-tune --robot testbed1 --estimator mo1 --tune bandwidth=5:50");
  EXPECT_EQ(tuned.code, 2);
  EXPECT_TRUE(
      tuned.says("--scenario is required: testbed1 has none of step, sine, in_motion; it "
                 "has: model_check"))
      << tuned.text;
}

TEST_F(Programs, WrongFlagsExitWith2) {
  for (const std::string command :
       {"tauext-bench --nonsense", "tauext-calibrate", "tauext-bench --help > /dev/full",
        "tauext-bench --pareto --benchmark_out=r.json", "tauext-bench --benchmark_nonsense=1",
        "tauext-record", "tauext-replay", "tauext-bench --benchmark_format=csv",
        "tauext-bench --benchmark_out_format=csv",
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

TEST_F(Programs, WhatAStudyOrALogCannotTakeIsRefused) {
  write("log.csv", "t,q1,q2,q3,qd1,qd2,qd3,tau1,tau2,tau3\n0,0,0,0,0,0,0,0,0,0\n");
  for (const char* command :
       {"tauext-bench --pareto --drives stiffness=200",
        "tauext-score --log log.csv --robot wallmobot3 --estimator mo1 --degrade hard",
        "tauext-tune --log log.csv --test_log log2.csv --robot wallmobot3 --estimator mo1 --tune "
        "bandwidth --kp 9"}) {
    const Outcome o = run(command);
    EXPECT_EQ(o.code, 2) << command;
    EXPECT_TRUE(o.says("a study takes no --thresholds, --drives") || o.says("not with --log"))
        << command << o.text;
  }
}

TEST_F(Programs, AFilterThatMatchesNothingExitsWith2) {
  write("x.lcm", "a log");
  const Outcome o =
      run("tauext-bench --benchmark_filter=nosuchthing --benchmark_out=r.json --lcm "
          "'file://x.lcm?mode=w'");
  EXPECT_EQ(o.code, 2);
  EXPECT_TRUE(o.says("--benchmark_filter=nosuchthing matches nothing")) << o.text;
  EXPECT_FALSE(exists("r.json"));
  EXPECT_EQ(content("x.lcm"), "a log");
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
    for (const char* key : {"rmse_Nm", "rmse_Nm_joint1", "settling_s", "rise_s", "cpu_ns"}) {
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
#ifndef TAUEXT_SANITIZED  // whose malloc is not counted
  EXPECT_TRUE(o.says("allocs")) << o.text;
#endif
}

TEST_F(Programs, BenchPrintsItsTableThoughItsJsonCannotBeWritten) {
  const Outcome o = run("tauext-bench --benchmark_filter=free/ndob --benchmark_out=/dev/full" +
                        std::string(kQuick));
  EXPECT_EQ(o.code, 2);
  EXPECT_TRUE(o.says("wallmobot3/free/ndob ")) << o.text;
  EXPECT_TRUE(o.says("/dev/full: cannot write")) << o.text;
}

// to rounding: the two may link different copies of an inline function
TEST_F(Programs, TheFirstTableHasTheNumbersOfBench) {
  const auto results = [&](const std::string& program) {
    const Outcome o = run(program + " --benchmark_filter='step|hold' --benchmark_out=r" + kQuick);
    EXPECT_EQ(o.code, 0) << o.text;
    return nlohmann::json::parse(content("r")).at("benchmarks");
  };
  const auto first = results(kFirstTable), bench = results("tauext-bench");
  ASSERT_EQ(first.size(), bench.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].size(), bench[i].size());
    for (const auto& [key, value] : first[i].items()) {
      EXPECT_TRUE(!value.is_string() || value == bench[i].at(key)) << key;
      if (!value.is_number_float() || key.ends_with("_time") || key == "cpu_ns") continue;
      EXPECT_NEAR(value, bench[i].at(key), 1e-9 + 1e-6 * std::abs(value.get<double>())) << key;
    }
  }
}

TEST_F(Programs, BenchNamesTheEstimatorThatRanNowhere) {
  const Outcome o =
      run("tauext-bench --benchmark_filter=wallmobot3/free/ --estimator mo2,ekf_zero_start" +
          std::string(kQuick));
  EXPECT_EQ(o.code, 2);
  EXPECT_TRUE(o.says("wallmobot3/free/mo2 ")) << o.text;
  EXPECT_TRUE(o.says("ekf_zero_start: nothing ran it")) << o.text;
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

TEST_F(Programs, ASeedIsAWholeNumberOf64Bits) {
  const std::string record = "tauext-record --robot testbed1 --scenario hold --out x.csv --seed ";
  EXPECT_EQ(run(record + "18446744073709551615").code, 0);
  for (const std::string seed : {"18446744073709551616", "-1", "1.5", "x"}) {
    const Outcome o = run(record + seed);
    EXPECT_EQ(o.code, 2) << seed;
    EXPECT_TRUE(o.says("is not a whole number")) << o.text;
  }
}

TEST_F(Programs, ListNamesEntriesAndTheKeysOfSpecifications) {
  const Outcome o = run("tauext-bench --list");
  EXPECT_EQ(o.code, 0);
  EXPECT_TRUE(o.says("wallmobot3/collision/ekf+pan_tompkins\n"));
  for (const char* program : {"bench", "detect", "live", "record", "replay"}) {
    const Outcome list = run(std::string("tauext-") + program + " --list");
    EXPECT_EQ(list.code, 0) << program;
    EXPECT_TRUE(list.says("\nmo2\n")) << program;
    EXPECT_TRUE(list.says("  :bandwidth ")) << program;
  }
}

TEST_F(Programs, AreCompletedInBash) {
  // the words of a line, of which the last one is not ready
  const auto completed = [&](const std::string& line) {
    write("complete.sh", "PATH=" + kBin + ":$PATH\nsource " + kExamples +
                             "/../program/completion.bash\nCOMP_WORDS=(" + line +
                             ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_tauext\n" +
                             "echo \"${COMPREPLY[*]}\"\n");
    return run_system("bash complete.sh").text;
  };
  EXPECT_EQ(completed("tauext-record --scenario st"), "step\n");
  EXPECT_EQ(completed("tauext-record --robot wall"), "wallmobot3 wallmobot6\n");
  EXPECT_EQ(completed("tauext-record --robot testbed1 --scenario s"), "swing\n");
  EXPECT_EQ(completed("tauext-live --estimator mo1,dkf_"), "mo1,dkf_adaptive\n");
  EXPECT_EQ(completed("tauext-bench --equal"), "--equal-bandwidth\n");
}

TEST_F(Programs, AFlagOfAnotherModeIsRefused) {
  write("log.csv", "t,q1,qd1,tau1\n0,0,0,0\n0.001,0,0,0\n");
  for (const char* file : {"s.json", "copy.json"})
    write(file, R"({"context": {}, "benchmarks": [{"name": "a/b/c", "rmse_Nm": 1}]})");
  const std::vector<std::pair<std::string, std::string>> refused = {
      {"tauext-bench --golden g.tsv --benchmark_out=r.json", "--benchmark_out and"},
      {"tauext-bench --golden g.tsv --paper", "--paper goes with the suite"},
      {"tauext-bench --golden g.tsv --seed 3", "--seed goes with one seed"},
      {"tauext-bench --list --benchmark_filter=step/", "--benchmark_filter goes with"},
      {"tauext-bench --list --list-metrics", "one at a time"},
      {"tauext-record --list --robot kuka", "unknown robot 'kuka'; known: wallmobot3"},
      {"tauext-bench --seeds 1,2 --seed 3", "--seed goes with one seed"},
      {"tauext-bench --seeds 1-2-3", "'1-2-3' is no seed, nor a range"},
      {"tauext-bench --seeds 1-3,2", "one is there twice"},
      {"tauext-bench --seeds 5-1", "'5-1' ends before it begins; 1-5 has these seeds"},
      {"tauext-bench --against mo1", "--against goes with --seeds"},
      {"tauext-bench --pareto --seed 3", "bring their own sensors"},
      {"tauext-detect --calibrate x.json --conditions known_0", "--conditions goes with a study"},
      {"tauext-detect --thresholds x.json --margin 2", "--margin goes with training"},
      {"tauext-detect --conditions known_0,known_0", "condition 'known_0' is named twice"},
      {"tauext-report --schema r.json", "--schema prints the schema, and takes nothing else"},
      {"tauext-report s.json --out r.txt", "--out r.txt: a page is FILE.html"},
      {"tauext-bench --report r.txt", "--report r.txt: a page is FILE.html"},
      {"tauext-report s.json s.json --out r.html", "s.json: is there twice"},
      {"tauext-report s.json copy.json --out r.html", "copy.json: s.json has the same results"},
      {"tauext-detect --hours -1", "a study has 0 to 1000 hours, not -1"},
      {"tauext-live --listen --scenario step", "exactly one of"},
      {"tauext-live --listen --detector cusum", "--listen shows streams"},
      {"tauext-live --robot testbed1 --scenario hold --estimator mo1 --thresholds t.json",
       "--thresholds goes with --detector"},
      {"tauext-replay log.csv --robot testbed1 --estimator mo1 --channel A --out e.csv",
       "log.csv: has no channel 'A'"}};
  for (const auto& [command, why] : refused) {
    const Outcome o = run(command);
    EXPECT_EQ(o.code, 2) << command;
    EXPECT_TRUE(o.says(why)) << command << '\n' << o.text;
  }
  for (const char* file : {"g.tsv", "r.json", "x.json", "e.csv", "r.txt", "r.html"})
    EXPECT_FALSE(exists(file)) << file;
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
  EXPECT_TRUE(
      run("tauext-detect --detector high_pass:v=1").says("there is no key 'v'; known: threshold"));
  EXPECT_TRUE(run("tauext-detect --format xml").says("unknown format 'xml'; known: text, csv"));
  EXPECT_EQ(run("tauext-bench --degrade /nowhere.json").code, 2);
}

TEST_F(Programs, StudiesRefuseFlagsOfTheSuiteAndSayWhatARobotLacks) {
  const Outcome json = run("tauext-bench --pareto --benchmark_format=json");
  EXPECT_EQ(json.code, 2);
  EXPECT_TRUE(json.says("a study has --out and --format")) << json.text;
  for (const std::string flags :
       {"--format xml", "--out x.txt", "--pareto --format xml",
        "--pareto --equal-bandwidth 30 --format json", "--pareto --out /nowhere/p.txt",
        "--pareto --model_error mass=1.1"}) {
    EXPECT_EQ(run("tauext-bench " + flags).code, 2) << flags;
  }
  EXPECT_TRUE(run("tauext-bench --equal-bandwidth 30 --robot testbed1")
                  .says("testbed1 lacks chirp, step, sine, free"));
  EXPECT_TRUE(run("tauext-detect --robot testbed1").says("has no runs for testbed1"));
}

}  // namespace
}  // namespace tauext::test

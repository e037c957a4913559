// SPDX-License-Identifier: Apache-2.0
// What is less accurate makes the gate fail; what is wrong with flags and files is said.
#include <algorithm>

#include "mjcf/trace/input_file.h"
#include "regression/test/gate_fixture.h"

namespace tauext::gate::test {
namespace {

using AccuracyGate = Gate;

TEST_F(AccuracyGate, NothingChangedPassesAndEveryFaultIsSeen) {
  make_golden();
  EXPECT_EQ(accuracy(""), kGood) << text_;
  EXPECT_EQ(accuracy("gain=1.01"), kLessAccurate) << text_;  // noise grows by 0.52 %
  EXPECT_TRUE(says("testbed1/hold/subject rmse_Nm") && says("changed: update needed")) << text_;
  EXPECT_EQ(accuracy("gain=1.001"), kUpdateNeeded) << "by T1: " << text_;
  EXPECT_TRUE(says("testbed1/hold/subject noise_Nm")) << text_;
  EXPECT_EQ(accuracy("gain=0.9"), kLessAccurate) << text_;
  EXPECT_EQ(accuracy("delay"), kLessAccurate) << text_;
  EXPECT_EQ(accuracy("sign"), kLessAccurate) << text_;
  EXPECT_TRUE(says("failed  0 -> 1")) << text_;
  EXPECT_TRUE(says("worst: seed ") && says("whose largest error is at t = ")) << text_;
  EXPECT_TRUE(says("--golden - --seeds ")) << text_;
}

TEST_F(AccuracyGate, SwappedSeedsAreSeen) {
  make_golden();
  std::string text = read_whole(golden());
  const auto seed1 = text.find("seed 1"), seed2 = text.find("seed 2");
  text[seed1 + 5] = '2', text[seed2 + 5] = '1';
  write(golden(), text);
  EXPECT_EQ(accuracy(""), kUpdateNeeded) << text_;
}

TEST_F(AccuracyGate, AFileThatIsNotWholeIsAnErrorWithItsName) {
  EXPECT_EQ(accuracy(""), kUpdateNeeded) << "none at all: " << text_;
  make_golden();
  const std::string whole = read_whole(golden());
  for (const std::string& bad :
       {std::string(), whole.substr(0, whole.size() / 2), std::string("t,q1,qd1,tau1\n0,0,0,0\n"),
        read_whole(make_counts())}) {
    write(golden(), bad);
    EXPECT_EQ(accuracy(""), kCouldNotRun) << text_;
    EXPECT_TRUE(says(golden())) << text_;
  }
}

TEST_F(AccuracyGate, AFilterThatMatchesNothingIsAnError) {
  make_golden();
  const auto entries = [&](const std::string& filter) -> std::vector<std::string> {
    return {"accuracy",  "--bench", kBin + "/subject_bench", "--baselines", baselines(),
            "--entries", filter};
  };
  refuses(entries("nosuchthing"), "--entries 'nosuchthing' matches nothing of " + golden());
  refuses(entries("("), "--entries: no regular expression: ");
  refuses(
      {"time", "--base", plugin("base"), "--head", plugin("slower"), "--kernels", "nosuchthing"},
      "--kernels 'nosuchthing' matches no kernel");
}

TEST_F(AccuracyGate, ABenchThatFailsOrSaysNothingIsAHarnessError) {
  make_golden();
  const auto with = [&](const std::string& bench) -> std::vector<std::string> {
    return {"accuracy", "--bench", bench, "--baselines", baselines()};
  };
  refuses(with("/bin/false"), "/bin/false: failed with exit code 1");
  refuses(with("/bin/true"), "golden.tsv: No such file or directory");
  refuses(with("/nowhere/bench"), "/nowhere/bench: cannot be run: No such file");
}

using Usage = Gate;

TEST_F(Usage, WrongFlagsAndFilesSayWhatIsWrong) {
  refuses({}, "A subcommand is required");
  refuses({"judge"}, "unknown subcommand 'judge'; known: check, time, count, accuracy");
  refuses({"time"}, "--base is required");
  refuses({"explain", "ekf"}, "'ekf' is neither <robot>/<kernel> nor ");
  refuses({"accuracy", "--bench", "", "--baselines", baselines()}, "wants a --bench PROGRAM");
  refuses({"count", "--head", plugin("base"), "--kernels", "(", "--baselines", baselines()},
          "--kernels: no regular expression: ");
  refuses({"time", "--base", plugin("base"), "--period", "nan"}, "--period: more than 0 s");
  refuses({"calibrate", "--trials", "0"}, "--trials: at least 1");
  refuses(
      {"calibrate", "--base", plugin("base"), "--head", plugin("slower"), "--slowdowns", "0.01"},
      "--slowdowns: nothing is injected where --head says what is slower");
  refuses({"time", "--base", "/nowhere.so"}, "/nowhere.so: ");
  const std::string text = baselines() + "/text.so";
  write(text, "no plug-in");
  refuses({"time", "--base", text, "--head", plugin("base")}, "no plug-in");
  write(text, read_whole(plugin("base")).substr(0, 20000));
  refuses({"time", "--base", text, "--head", plugin("base")}, "cut off; build the plug-in anew");
  refuses({"time", "--base", plugin("base"), "--head", plugin("base"), "--junit", "/nowhere/x"},
          "/nowhere/x");
  EXPECT_EQ(run({"count", "--head", plugin("base"), "--baselines", "/nowhere"}), kUpdateNeeded);
}

TEST_F(Usage, EachSubcommandHasAHelpThatFitsAScreen) {
  for (const char* sub : {"check", "time", "count", "accuracy", "update", "calibrate", "explain"}) {
    EXPECT_EQ(run({sub, "--help"}), kGood);
    EXPECT_TRUE(says("5 less accurate")) << "the exit codes: " << text_;
    EXPECT_LE(std::count(text_.begin(), text_.end(), '\n'), 24) << text_;
  }
}

}  // namespace
}  // namespace tauext::gate::test

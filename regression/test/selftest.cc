// SPDX-License-Identifier: Apache-2.0
// The gate as a CI service meets it: what it is for makes it fail, and nothing else does.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "regression/child.h"
#include "regression/layers.h"
#include "regression/plugin_host.h"

namespace tauext::gate::test {
namespace {

namespace fs = std::filesystem;

const std::string kBin = TAUEXT_BIN;
constexpr const char* kEntries = "testbed1/hold/subject$";

std::string plugin(const std::string& name) {
  return kBin + "/subject_" + name + ".so";
}

std::string content(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class Gate : public testing::Test {
 protected:
  // what it says goes to text_
  int run(const std::vector<std::string>& args, const std::string& fault = "") {
    // env runs it, so that the fault reaches the bench program
    std::vector<std::string> argv = {"sh", "-c", "exec env SUBJECT=\"$0\" \"$@\" 2>&1", fault,
                                     kBin + "/tauext-gate"};
    argv.insert(argv.end(), args.begin(), args.end());
    const Finished f = finish_child(argv);
    text_ = f.output;
    return f.code;
  }
  bool says(const std::string& what) const { return text_.find(what) != std::string::npos; }

  int time(const std::string& head) {
    return run({"time", "--base", plugin("base"), "--head", plugin(head)});
  }
  int count(const std::string& head) {
    return run(
        {"count", "--base", plugin("base"), "--head", plugin(head), "--baselines", baselines()});
  }
  int accuracy(const std::string& fault, const std::string& entries = kEntries) {
    return run({"accuracy", "--bench", kBin + "/subject_bench", "--baselines", baselines(),
                "--entries", entries},
               fault);
  }
  std::string baselines() const { return folder_.path(); }
  std::string golden() const { return golden_path(baselines()); }

  void make_golden() const {
    run_child({"env", "SUBJECT=", kBin + "/subject_bench", "--golden", golden(),
               std::string("--benchmark_filter=") + kEntries});
  }
  // the path of the file that update writes
  std::string make_counts() {
    run({"update", "--bench", "", "--head", plugin("base"), "--baselines", baselines(),
         "--changelog", baselines() + "/log.md", "--reason", "the first"});
    for (const auto& entry : fs::directory_iterator(baselines())) {
      if (entry.path().filename().string().starts_with("instructions-")) return entry.path();
    }
    ADD_FAILURE() << text_;
    return "";
  }
  void write(const std::string& path, const std::string& text) const {
    std::ofstream(path) << text;
  }

  TemporaryFolder folder_;
  std::string text_;
};

using Time = Gate;

TEST_F(Time, TheSameCodeIsIdenticalAndNotTimed) {
  EXPECT_EQ(time("base"), kPassed) << text_;
  EXPECT_TRUE(says("identical: 1 kernels")) << text_;
}

TEST_F(Time, ACopyBesideItselfPasses) {
  EXPECT_EQ(
      run({"time", "--base", plugin("base"), "--head", plugin("base"), "--even-if-identical"}),
      kPassed)
      << text_;
  EXPECT_TRUE(says("1 kernels, 1 ok")) << text_;
}

TEST_F(Time, TheSameCodeElsewhereInMemoryPasses) {
  EXPECT_EQ(time("shifted"), kPassed) << text_;
  EXPECT_TRUE(says("1 kernels, 1 ok")) << text_;
}

TEST_F(Time, FivePercentMoreWorkFails) {
  EXPECT_EQ(time("slower"), kSlower) << text_;
  EXPECT_TRUE(says("testbed1/subject") && says("FAIL")) << text_;
  EXPECT_EQ(run({"time", "--base", plugin("slower"), "--head", plugin("base")}), kPassed)
      << "the other way round it is faster: " << text_;
}

TEST_F(Time, ADivideInTheChainFailsThoughInstructionsAreTheSame) {
  EXPECT_EQ(run({"check", "--base", plugin("base"), "--head", plugin("divides"), "--bench", "",
                 "--baselines", baselines()}),
            kSlower)
      << text_;
  EXPECT_TRUE(says("the same work, but slower")) << text_;
}

TEST_F(Time, ReportsAreWrittenAndCanBeRead) {
  const std::string j = baselines() + "/j.xml", m = baselines() + "/m.md",
                    h = baselines() + "/h.json";
  EXPECT_EQ(run({"time", "--base", plugin("base"), "--head", plugin("more_divides"), "--junit", j,
                 "--markdown", m, "--head-json", h}),
            kSlower);
  EXPECT_NE(content(j).find("failures=\"1\""), std::string::npos) << content(j);
  EXPECT_EQ(content(m).find("## tauext-gate: SLOWER"), 0u) << content(m);
  EXPECT_GE(nlohmann::json::parse(content(h))["benchmarks"].size(), 20u);
}

using Instructions = Gate;

TEST_F(Instructions, OnePercentMoreFailsWhereverTheyComeFrom) {
  EXPECT_EQ(count("instructions"), kSlower) << text_;
  make_counts();
  EXPECT_EQ(run({"count", "--head", plugin("instructions"), "--baselines", baselines()}), kSlower)
      << "without a base, too: " << text_;
  EXPECT_EQ(run({"count", "--head", plugin("base"), "--baselines", baselines()}), kPassed) << text_;
  EXPECT_EQ(run({"count", "--head", plugin("shifted"), "--baselines", baselines()}), kPassed)
      << text_;
}

TEST_F(Instructions, WithoutABaselineOfThisKeyTheyAreNotCompared) {
  EXPECT_EQ(count("base"), kUpdateNeeded) << text_;
  const std::string path = make_counts();
  std::string other = content(path);
  other.replace(other.find("# glibc: "), 9, "# glibc: 1");
  fs::remove(path);
  write(baselines() + "/instructions-00000000.tsv", other);
  EXPECT_EQ(count("base"), kUpdateNeeded) << text_;
  EXPECT_TRUE(says("no baseline for this key") && says("glibc: '1")) << text_;
  write(path, other);
  EXPECT_EQ(count("base"), kHarnessError) << "its name is not its key's: " << text_;
}

TEST_F(Instructions, AFileThatIsNotWholeIsAnErrorWithItsName) {
  const std::string path = make_counts(), whole = content(path);
  for (const std::string& bad :
       {std::string(), whole.substr(0, whole.size() / 2), std::string("{}")}) {
    write(path, bad);
    EXPECT_EQ(count("base"), kHarnessError) << text_;
    EXPECT_TRUE(says(path)) << text_;
  }
}

using AccuracyGate = Gate;

TEST_F(AccuracyGate, NothingChangedPassesAndEveryFaultIsSeen) {
  make_golden();
  EXPECT_EQ(accuracy(""), kPassed) << text_;
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
  std::string text = content(golden());
  const auto seed1 = text.find("seed 1"), seed2 = text.find("seed 2");
  text[seed1 + 5] = '2', text[seed2 + 5] = '1';
  write(golden(), text);
  EXPECT_EQ(accuracy(""), kUpdateNeeded) << text_;
}

TEST_F(AccuracyGate, AFileThatIsNotWholeIsAnErrorWithItsName) {
  EXPECT_EQ(accuracy(""), kUpdateNeeded) << "none at all: " << text_;
  make_golden();
  const std::string whole = content(golden());
  for (const std::string& bad : {std::string(), whole.substr(0, whole.size() / 2),
                                 std::string("t,q1,qd1,tau1\n0,0,0,0\n"), content(make_counts())}) {
    write(golden(), bad);
    EXPECT_EQ(accuracy(""), kHarnessError) << text_;
    EXPECT_TRUE(says(golden())) << text_;
  }
}

TEST_F(AccuracyGate, AFilterThatMatchesNothingIsAUsageError) {
  make_golden();
  EXPECT_EQ(accuracy("", "nosuchthing"), kUsage) << text_;
  EXPECT_EQ(accuracy("", "("), kUsage) << text_;
  EXPECT_EQ(run({"time", "--base", plugin("base"), "--head", plugin("slower"), "--kernels",
                 "nosuchthing"}),
            kUsage)
      << text_;
}

TEST_F(AccuracyGate, ABenchThatFailsOrSaysNothingIsAHarnessError) {
  make_golden();
  for (const char* program : {"/bin/false", "/bin/true", "/nowhere/bench"}) {
    EXPECT_EQ(run({"accuracy", "--bench", program, "--baselines", baselines()}), kHarnessError)
        << text_;
  }
}

using Usage = Gate;

TEST_F(Usage, WrongFlagsAndFilesSayWhatIsWrong) {
  EXPECT_EQ(run({}), kUsage);
  EXPECT_EQ(run({"judge"}), kUsage);
  EXPECT_EQ(run({"time"}), kUsage) << "no base";
  EXPECT_EQ(run({"count", "--head", plugin("base"), "--baselines", "/nowhere"}), kUpdateNeeded);
  EXPECT_EQ(run({"explain", "ekf"}), kUsage);
  EXPECT_EQ(run({"accuracy", "--bench", "", "--baselines", baselines()}), kUsage) << text_;
  EXPECT_EQ(run({"count", "--head", plugin("base"), "--kernels", "(", "--baselines", baselines()}),
            kUsage);
  EXPECT_EQ(run({"time", "--base", plugin("base"), "--period", "nan"}), kUsage) << text_;
  EXPECT_EQ(run({"calibrate", "--trials", "0"}), kUsage);
  EXPECT_EQ(run({"time", "--base", "/nowhere.so"}), kHarnessError);
  EXPECT_TRUE(says("/nowhere.so")) << text_;
  const std::string text = baselines() + "/text.so";
  write(text, "no plug-in");
  EXPECT_EQ(run({"time", "--base", text, "--head", plugin("base")}), kHarnessError);
  EXPECT_TRUE(says("no plug-in")) << text_;
  EXPECT_EQ(
      run({"time", "--base", plugin("base"), "--head", plugin("base"), "--junit", "/nowhere/x"}),
      kHarnessError);
  for (const char* sub : {"check", "time", "count", "accuracy", "update", "calibrate", "explain"}) {
    EXPECT_EQ(run({sub, "--help"}), kPassed);
    EXPECT_LE(std::count(text_.begin(), text_.end(), '\n'), 24) << text_;
  }
}

// a bench program that copies what is asked for
class Update : public Gate {
 protected:
  Update() {
    make_golden();
    once_ = content(golden());
    write(baselines() + "/next.tsv", once_);
    write(bench_, "#!/bin/sh\ncp " + baselines() + "/next.tsv \"$2\"\n");
    fs::permissions(bench_, fs::perms::owner_all);
  }
  void next(const std::string& fault) {
    run_child({"env", "SUBJECT=" + fault, kBin + "/subject_bench", "--golden",
               baselines() + "/next.tsv", std::string("--benchmark_filter=") + kEntries});
  }
  std::vector<std::string> command(const std::string& reason) const {
    return {"update", "--baselines", baselines(), "--changelog", log_,  "--head",
            "",       "--bench",     bench_,      "--reason",    reason};
  }
  std::string bench_ = baselines() + "/bench.sh", log_ = baselines() + "/CHANGELOG.md", once_;
};

TEST_F(Update, WritesTheBaselineAndTheReason) {
  next("gain=1.001");
  EXPECT_EQ(run(command("a better gain")), kPassed) << text_;
  EXPECT_EQ(content(golden()), content(baselines() + "/next.tsv"));
  EXPECT_NE(content(log_).find(": a better gain\n"), std::string::npos) << content(log_);
  EXPECT_EQ(run(command("again")), kPassed);
  EXPECT_TRUE(says("nothing was written")) << text_;
  EXPECT_EQ(content(log_).find("again"), std::string::npos);
}

TEST_F(Update, RefusesAWorseningUnlessItIsAccepted) {
  next("gain=0.9");
  EXPECT_EQ(run(command("faster")), kLessAccurate) << text_;
  EXPECT_TRUE(says("refused") && says("testbed1/hold/subject rmse_Nm")) << text_;
  EXPECT_EQ(content(golden()), once_);
  EXPECT_FALSE(fs::exists(log_));
  auto accepting = command("less noise");
  accepting.insert(accepting.end(), {"--accept-worse", "the noise matters more"});
  EXPECT_EQ(run(accepting), kPassed) << text_;
  EXPECT_NE(content(log_).find("less noise (worse, accepted: the noise matters more)"),
            std::string::npos);
}

TEST_F(Update, OfSomeEntriesLeavesTheOthers) {
  run_child({"env", "SUBJECT=", kBin + "/subject_bench", "--golden", golden(),
             "--benchmark_filter=testbed1/(hold|swing)/subject$"});
  once_ = content(golden());
  run_child({"env", "SUBJECT=gain=1.001", kBin + "/subject_bench", "--golden",
             baselines() + "/next.tsv", "--benchmark_filter=testbed1/hold/subject$"});
  auto some = command("hold alone");
  some.insert(some.end(), {"--entries", "hold"});
  EXPECT_EQ(run(some), kPassed) << text_;
  const Golden before = parse_golden(once_, "once"), now = read_golden(golden());
  ASSERT_EQ(now.lines.size(), before.lines.size());
  const auto noise = [](const Golden& g, const char* entry) {
    return g.lines.at({entry, "noise_Nm"}).values;
  };
  EXPECT_EQ(noise(now, "testbed1/swing/subject"), noise(before, "testbed1/swing/subject"));
  EXPECT_NE(noise(now, "testbed1/hold/subject"), noise(before, "testbed1/hold/subject"));
}

TEST_F(Update, WantsAReason) {
  next("gain=1.001");
  EXPECT_EQ(run(command("")), kUsage) << text_;
  EXPECT_EQ(run(command("two\nlines")), kUsage) << text_;
  EXPECT_EQ(content(golden()), once_);
}

TEST_F(Update, KilledAtAnyMomentLeavesAWholeBaseline) {
  next("gain=1.001");
  const std::string then = content(baselines() + "/next.tsv");
  int old = 0;
  for (int ms = 0; ms < 30; ++ms) {
    write(golden(), once_);
    std::vector<std::string> argv = command("x");
    argv.insert(argv.begin(), kBin + "/tauext-gate");
    const pid_t pid = ::fork();
    if (pid == 0) {
      std::vector<char*> args;
      for (std::string& a : argv) args.push_back(a.data());
      args.push_back(nullptr);
      if (!std::freopen("/dev/null", "w", stdout)) ::_exit(1);
      ::execv(args[0], args.data());
      ::_exit(127);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(ms));
    ::kill(pid, SIGKILL);
    ::waitpid(pid, nullptr, 0);
    const std::string now = content(golden());
    ASSERT_TRUE(now == once_ || now == then) << "after " << ms << " ms: " << now.size() << " bytes";
    old += now == once_;
  }
  EXPECT_GT(old, 0) << "no kill came before the end";
}

}  // namespace
}  // namespace tauext::gate::test

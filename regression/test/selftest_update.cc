// SPDX-License-Identifier: Apache-2.0
// Baselines move whole or not at all, and with a reason.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "mjcf/trace/input_file.h"
#include "regression/test/gate_fixture.h"

namespace tauext::gate::test {
namespace {

// a bench program that copies what is asked for
class Update : public Gate {
 protected:
  Update() {
    make_golden();
    once_ = read_whole(golden());
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
  EXPECT_EQ(run(command("a better gain")), kGood) << text_;
  EXPECT_EQ(read_whole(golden()), read_whole(baselines() + "/next.tsv"));
  EXPECT_NE(read_whole(log_).find(": a better gain\n"), std::string::npos) << read_whole(log_);
  EXPECT_EQ(run(command("again")), kGood);
  EXPECT_TRUE(says("nothing was written")) << text_;
  EXPECT_EQ(read_whole(log_).find("again"), std::string::npos);
}

TEST_F(Update, RefusesAWorseningUnlessItIsAccepted) {
  next("gain=0.9");
  EXPECT_EQ(run(command("faster")), kLessAccurate) << text_;
  EXPECT_TRUE(says("refused") && says("testbed1/hold/subject rmse_Nm")) << text_;
  EXPECT_EQ(read_whole(golden()), once_);
  EXPECT_FALSE(fs::exists(log_));
  auto accepting = command("less noise");
  accepting.insert(accepting.end(), {"--accept-worse", "the noise matters more"});
  EXPECT_EQ(run(accepting), kGood) << text_;
  EXPECT_NE(read_whole(log_).find("less noise (3 worse, accepted: the noise matters more)"),
            std::string::npos);
}

TEST_F(Update, SaysWhetherAKernelIsSlowerOrMetricsAreLessAccurate) {
  const std::string counts = make_counts(), before = read_whole(counts);
  std::vector<std::string> slower = {
      "update", "--baselines",          baselines(), "--changelog", log_,
      "--head", plugin("instructions"), "--reason",  "why not",     "--bench",
      ""};
  EXPECT_EQ(run(slower), kSlower) << text_;
  EXPECT_TRUE(says("refused: these would be worse") && says("% instructions")) << text_;
  next("gain=0.9");
  slower.back() = bench_;
  EXPECT_EQ(run(slower), kSlower) << "1 counts before 5: " << text_;
  EXPECT_TRUE(says("% instructions") && says("testbed1/hold/subject rmse_Nm")) << text_;
  EXPECT_EQ(read_whole(counts), before);
  EXPECT_EQ(read_whole(golden()), once_);
}

TEST_F(Update, OfSomeEntriesLeavesTheOthers) {
  run_child({"env", "SUBJECT=", kBin + "/subject_bench", "--golden", golden(),
             "--benchmark_filter=testbed1/(hold|collision)/subject$"});
  once_ = read_whole(golden());
  run_child({"env", "SUBJECT=gain=1.001", kBin + "/subject_bench", "--golden",
             baselines() + "/next.tsv", "--benchmark_filter=testbed1/hold/subject$"});
  auto some = command("hold alone");
  some.insert(some.end(), {"--entries", "hold"});
  EXPECT_EQ(run(some), kGood) << text_;
  const Golden before = parse_golden(once_, "once"), now = read_golden(golden());
  ASSERT_EQ(now.lines.size(), before.lines.size());
  const auto noise = [](const Golden& g, const char* entry) {
    return g.lines.at({entry, "noise_Nm"}).values;
  };
  EXPECT_EQ(noise(now, "testbed1/collision/subject"), noise(before, "testbed1/collision/subject"));
  EXPECT_EQ(now.header.at("contacts"), "testbed1/collision");
  EXPECT_NE(noise(now, "testbed1/hold/subject"), noise(before, "testbed1/hold/subject"));
}

TEST_F(Update, WantsAReason) {
  next("gain=1.001");
  refuses(command(""), "--reason: say why; it goes into the changelog");
  refuses(command("two\nlines"), "--reason: one line");
  EXPECT_EQ(read_whole(golden()), once_);
}

TEST_F(Update, KilledAtAnyMomentLeavesAWholeBaseline) {
  next("gain=1.001");
  const std::string then = read_whole(baselines() + "/next.tsv");
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
    const std::string now = read_whole(golden());
    ASSERT_TRUE(now == once_ || now == then) << "after " << ms << " ms: " << now.size() << " bytes";
    old += now == once_;
  }
  EXPECT_GT(old, 0) << "no kill came before the end";
}

}  // namespace
}  // namespace tauext::gate::test

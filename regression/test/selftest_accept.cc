// SPDX-License-Identifier: Apache-2.0
// What is meant can be said, for one finding, one size and one base; and baselines of a faulty
// build are no way around the gate.
#include "mjcf/trace/input_file.h"
#include "regression/test/gate_fixture.h"

namespace tauext::gate::test {
namespace {

class Accept : public Gate {
 protected:
  int check(const std::string& head, const std::string& commit,
            const std::vector<std::string>& more = {}) {
    std::vector<std::string> args = {"check",
                                     "--base",
                                     plugin("base"),
                                     "--head",
                                     plugin(head),
                                     "--bench",
                                     "",
                                     "--baselines",
                                     baselines(),
                                     "--changelog",
                                     baselines() + "/log.md",
                                     "--base-commit",
                                     commit};
    args.insert(args.end(), more.begin(), more.end());
    return run(args);
  }
};

TEST_F(Accept, MakesAFindingGreenAndALargerOneNot) {
  make_counts();
  EXPECT_EQ(check("slower", "abc"), kSlower) << text_;
  EXPECT_EQ(check("slower", "abc", {"--accept", "three more stages"}), kGood) << text_;
  EXPECT_TRUE(says("accepted up to +") && says(": three more stages")) << text_;
  EXPECT_EQ(run({"count", "--head", plugin("slower"), "--baselines", baselines()}), kGood)
      << "the next commit is judged by the new counts: " << text_;
  EXPECT_EQ(check("slower", "abc"), kGood) << "it stands in a file: " << text_;
  EXPECT_TRUE(says("accepted up to +") && says("three more stages")) << text_;
  EXPECT_EQ(check("table", "abc"), kSlower) << "three times as slow: " << text_;
  EXPECT_TRUE(says("are accepted (three more stages), and this is more")) << text_;
  EXPECT_EQ(check("slower", "def"), kSlower) << "another base: " << text_;
  EXPECT_TRUE(says("stale")) << text_;
}

TEST_F(Accept, OfAMetricMovesItAndTheNextWorseningFails) {
  make_golden();
  const auto judged = [&](const std::string& fault, const std::vector<std::string>& more = {}) {
    std::vector<std::string> args = {"accuracy",      "--bench",     kBin + "/subject_bench",
                                     "--baselines",   baselines(),   "--entries",
                                     kEntries,        "--changelog", baselines() + "/log.md",
                                     "--base-commit", "abc"};
    args.insert(args.end(), more.begin(), more.end());
    return run(args, fault);
  };
  EXPECT_EQ(judged("gain=0.9"), kLessAccurate) << text_;
  EXPECT_EQ(judged("gain=0.9", {"--accept", "less noise"}), kGood) << text_;
  EXPECT_NE(read_whole(baselines() + "/log.md").find(" worse, accepted: less noise)"),
            std::string::npos);
  EXPECT_EQ(judged("gain=0.9"), kGood) << text_;
  EXPECT_EQ(judged("gain=0.81"), kLessAccurate) << "once more by as much: " << text_;
  // an entry that fails cannot be accepted, and takes nothing with it
  const std::string before = read_whole(baselines() + "/accuracy.tsv");
  EXPECT_EQ(judged("sign", {"--accept", "meant"}), kLessAccurate) << text_;
  EXPECT_NE(text_.find("nothing was accepted"), std::string::npos) << text_;
  EXPECT_EQ(read_whole(baselines() + "/accuracy.tsv"), before);
  EXPECT_EQ(judged("sign"), kLessAccurate) << text_;
}

TEST_F(Accept, WantsAReasonInOneLineAndABase) {
  make_counts();
  EXPECT_EQ(check("base", "", {"--accept", "why"}), kCouldNotRun);
  EXPECT_TRUE(says("--accept: beside which --base-commit?")) << text_;
  EXPECT_EQ(check("base", "abc", {"--accept", "two\nlines"}), kCouldNotRun);
  write(accepted_path(baselines()), "nonsense\n");
  EXPECT_EQ(check("base", "abc"), kCouldNotRun);
  EXPECT_TRUE(says(accepted_path(baselines()) + ": line 1: it must be")) << text_;
}

// a build with a fault whose author committed what it scores
TEST_F(Accept, BaselinesOfAFaultyBuildFail) {
  make_counts();
  make_golden();
  const std::string before = baselines() + "/of_base", log = baselines() + "/log.md",
                    log_before = baselines() + "/log_before.md";
  fs::create_directory(before);
  for (const auto& entry : fs::directory_iterator(baselines())) {
    if (entry.path().extension() == ".tsv") fs::copy(entry.path(), before);
  }
  write(log_before, "- 2026-01-01: the first\n");
  const std::string bench = baselines() + "/bench.sh";  // says what was committed
  write(bench, "#!/bin/sh\ncp " + golden() + " \"$2\"\n");
  fs::permissions(bench, fs::perms::owner_all);
  const auto judged = [&](const std::string& fault, const std::string& reasons) {
    write(log, "- 2026-01-01: the first\n" + reasons);
    make_golden(fault);
    return run({"accuracy", "--bench", bench, "--baselines", baselines(), "--base-baselines",
                before, "--base-changelog", log_before, "--changelog", log});
  };
  EXPECT_EQ(judged("", ""), kGood) << text_;
  EXPECT_TRUE(says("0 moved")) << text_;
  EXPECT_EQ(judged("sign", ""), kLessAccurate) << text_;
  EXPECT_TRUE(says("0 changed") && says("WORSE, and nobody accepted it")) << text_;
  EXPECT_EQ(judged("sign", "- 2026-01-02: tidied\n"), kLessAccurate) << text_;
  EXPECT_EQ(judged("gain=1.001", ""), kUpdateNeeded) << text_;
  EXPECT_TRUE(says("moved without a reason")) << text_;
  EXPECT_EQ(judged("gain=1.001", "- 2026-01-02: a better gain\n"), kGood) << text_;
  EXPECT_TRUE(says("because: 2026-01-02: a better gain")) << text_;
  EXPECT_EQ(judged("gain=0.9", "- 2026-01-02: less noise (3 worse, accepted: noise matters)\n"),
            kGood)
      << text_;
}

}  // namespace
}  // namespace tauext::gate::test

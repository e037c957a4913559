// SPDX-License-Identifier: Apache-2.0
// What is slower makes the gate fail, and nothing else does.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "mjcf/trace/input_file.h"
#include "regression/test/gate_fixture.h"

namespace tauext::gate::test {
namespace {

using Time = Gate;

TEST_F(Time, TheSameCodeIsIdenticalAndNotTimed) {
  EXPECT_EQ(time("base"), kGood) << text_;
  EXPECT_TRUE(says("1 kernels identical")) << text_;
}

TEST_F(Time, EveryKernelOfTheRosterIsIdenticalToItself) {
  const std::string roster = kBin + "/tauext_plugin.so";
  EXPECT_EQ(run({"time", "--base", roster, "--head", roster}), kGood) << text_;
  EXPECT_TRUE(says("kernels identical")) << text_;
  EXPECT_FALSE(says(" ok")) << "one was timed: what its state says depends on the process: "
                            << text_;
}

TEST_F(Time, ACopyBesideItselfPasses) {
  EXPECT_EQ(
      run({"time", "--base", plugin("base"), "--head", plugin("base"), "--even-if-identical"}),
      kGood)
      << text_;
  EXPECT_TRUE(says("1 kernels, 1 ok")) << text_;
}

TEST_F(Time, TheSameCodeElsewhereInMemoryPasses) {
  EXPECT_EQ(
      run({"time", "--base", plugin("base"), "--head", plugin("shifted"), "--even-if-identical"}),
      kGood)
      << text_;
  EXPECT_TRUE(says("1 kernels, 1 ok")) << text_;
}

TEST_F(Time, FivePercentMoreWorkFails) {
  EXPECT_EQ(time("slower"), kSlower) << text_;
  EXPECT_TRUE(says("testbed1/subject") && says("FAIL")) << text_;
  EXPECT_EQ(time("base", "slower"), kGood) << "the other way round it is faster: " << text_;
}

TEST_F(Time, TwoFunctionsThatChangePlacesInATableFail) {
  EXPECT_EQ(time("table"), kSlower) << "equal in all but what the linker fills in: " << text_;
}

TEST_F(Time, TheSameCodeFailsIfItsConstructorSetsAFlagForASlowPath) {
  EXPECT_EQ(time("flag_true", "flag_false"), kSlower) << text_;
  EXPECT_EQ(time("owned_true", "owned_false"), kSlower) << "in memory that it owns: " << text_;
  EXPECT_EQ(time("flag_true", "flag_true"), kGood) << text_;
  EXPECT_TRUE(says("1 kernels identical")) << "a flag alone is no difference: " << text_;
}

TEST_F(Time, AKernelWithAnotherCountIsTimed) {
  make_counts();
  EXPECT_EQ(run({"check", "--base", plugin("spoiled"), "--head", plugin("base"), "--bench", "",
                 "--baselines", baselines()}),
            kGood)
      << text_;
  EXPECT_TRUE(says("1 kernels beside base: 1 differ") && says("1 kernels, 1 ok")) << text_;
  EXPECT_FALSE(says("identical")) << text_;
}

TEST_F(Time, AStallThatIsRareFails) {
  EXPECT_EQ(time("stall"), kSlower) << text_;
  EXPECT_TRUE(says("stalls: the 50 steps from sample 100000 on")) << text_;
}

TEST_F(Time, AStepThatWaitsFails) {
  EXPECT_EQ(time("sleep"), kSlower) << text_;
  EXPECT_TRUE(says("gives up the processor ")) << text_;
}

TEST_F(Time, ASlowPathForBadSamplesFails) {
  EXPECT_EQ(time("bad"), kSlower) << text_;
}

TEST_F(Time, ABranchThatNobodyCanPredictFails) {
  EXPECT_EQ(time("branch", "few"), kSlower) << text_;
}

TEST_F(Time, AnEkfWhoseTransposesAreCallsFails) {
  EXPECT_EQ(time("ekf_calls", "ekf"), kSlower) << text_;
  EXPECT_TRUE(says("wallmobot3/ekf") && says("FAIL")) << text_;
}

TEST_F(Time, AnEkfThatReadsWholeRegistersOfWhatItJustWroteByElementsFails) {
  EXPECT_EQ(time("ekf_waits", "ekf"), kSlower) << text_;
  EXPECT_TRUE(says("wallmobot3/ekf") && says("FAIL")) << text_;
}

TEST_F(Time, ADivideInTheChainFailsThoughInstructionsAreTheSame) {
  EXPECT_EQ(run({"check", "--base", plugin("base"), "--head", plugin("divides"), "--bench", "",
                 "--baselines", baselines()}),
            kSlower)
      << text_;
  EXPECT_TRUE(says("the same work, but slower")) << text_;
  EXPECT_EQ(run({"check", "--base", plugin("base"), "--head", plugin("more_divides"), "--bench", "",
                 "--baselines", baselines()}),
            kSlower);
  EXPECT_TRUE(says("instructions do not explain it")) << text_;
  const std::string subject = read_whole("regression/test/subject_plugin.cc");
  const auto before = subject.substr(0, subject.find("double divisor"));
  EXPECT_TRUE(says(fmt::format("a step at regression/test/subject_plugin.cc:{}",
                               1 + std::count(before.begin(), before.end(), '\n'))))
      << text_;
}

TEST_F(Time, ReportsAreWrittenAndCanBeRead) {
  const std::string j = baselines() + "/j.xml", m = baselines() + "/m.md",
                    h = baselines() + "/h.json";
  EXPECT_EQ(run({"time", "--base", plugin("base"), "--head", plugin("more_divides"), "--junit", j,
                 "--markdown", m, "--head-json", h}),
            kSlower);
  EXPECT_NE(read_whole(j).find("failures=\"1\""), std::string::npos) << read_whole(j);
  EXPECT_EQ(read_whole(m).find("## tauext-gate: SLOWER"), 0u) << read_whole(m);
  EXPECT_GE(nlohmann::json::parse(read_whole(h))["benchmarks"].size(), 20u);
}

}  // namespace
}  // namespace tauext::gate::test

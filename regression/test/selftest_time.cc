// SPDX-License-Identifier: Apache-2.0
// What is slower makes the gate fail, and nothing else does.
#include <nlohmann/json.hpp>

#include "regression/test/gate_fixture.h"

namespace tauext::gate::test {
namespace {

using Time = Gate;

TEST_F(Time, TheSameCodeIsIdenticalAndNotTimed) {
  EXPECT_EQ(time("base"), kGood) << text_;
  EXPECT_TRUE(says("identical: 1 kernels")) << text_;
}

TEST_F(Time, ACopyBesideItselfPasses) {
  EXPECT_EQ(
      run({"time", "--base", plugin("base"), "--head", plugin("base"), "--even-if-identical"}),
      kGood)
      << text_;
  EXPECT_TRUE(says("1 kernels, 1 ok")) << text_;
}

TEST_F(Time, TheSameCodeElsewhereInMemoryPasses) {
  EXPECT_EQ(time("shifted"), kGood) << text_;
  EXPECT_TRUE(says("1 kernels, 1 ok")) << text_;
}

TEST_F(Time, FivePercentMoreWorkFails) {
  EXPECT_EQ(time("slower"), kSlower) << text_;
  EXPECT_TRUE(says("testbed1/subject") && says("FAIL")) << text_;
  EXPECT_EQ(run({"time", "--base", plugin("slower"), "--head", plugin("base")}), kGood)
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
  EXPECT_EQ(run({"count", "--head", plugin("base"), "--baselines", baselines()}), kGood) << text_;
  EXPECT_EQ(run({"count", "--head", plugin("shifted"), "--baselines", baselines()}), kGood)
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
  EXPECT_EQ(count("base"), kCouldNotRun) << "its name is not its key's: " << text_;
}

TEST_F(Instructions, AFileThatIsNotWholeIsAnErrorWithItsName) {
  const std::string path = make_counts(), whole = content(path);
  for (const std::string& bad :
       {std::string(), whole.substr(0, whole.size() / 2), std::string("{}")}) {
    write(path, bad);
    EXPECT_EQ(count("base"), kCouldNotRun) << text_;
    EXPECT_TRUE(says(path)) << text_;
  }
}

}  // namespace
}  // namespace tauext::gate::test

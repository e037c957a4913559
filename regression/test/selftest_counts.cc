// SPDX-License-Identifier: Apache-2.0
// More instructions make the gate fail; counts of another compiler are not compared.
#include "mjcf/trace/input_file.h"
#include "regression/test/gate_fixture.h"

namespace tauext::gate::test {
namespace {

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

TEST_F(Instructions, WithoutABaseNoCheckPasses) {
  make_counts();
  const std::vector<std::string> check = {"check", "--head",      plugin("base"), "--bench",
                                          "",      "--baselines", baselines()};
  EXPECT_EQ(run(check), kInconclusive) << text_;
  EXPECT_TRUE(says("no base, so ") && !says("passed")) << text_;
}

TEST_F(Instructions, WithABaselineOfAnotherMachineTheyAreComparedWithBaseAlone) {
  EXPECT_EQ(count("base"), kUpdateNeeded) << "there is none at all: " << text_;
  const std::string path = make_counts();
  const auto with = [whole = read_whole(path)](const std::string& key) {
    std::string text = whole;
    return text.replace(text.find(key), key.size(), key + "1");
  };
  const std::string file = baselines() + "/instructions-00000000.tsv", other = with("# glibc: ");
  fs::remove(path);
  write(file, with("# flags: "));
  EXPECT_EQ(count("base"), kUpdateNeeded) << "those of this machine are out of date: " << text_;
  write(file, other);
  EXPECT_EQ(count("base"), kGood) << text_;
  EXPECT_TRUE(says("counts are compared between base and head alone") && says("glibc: '1"))
      << text_;
  EXPECT_FALSE(says("beside the committed")) << text_;
  EXPECT_EQ(count("instructions"), kSlower) << text_;
  EXPECT_EQ(run({"count", "--head", plugin("base"), "--baselines", baselines()}), kUpdateNeeded)
      << "and without a base with nothing: " << text_;
  EXPECT_TRUE(says("no baseline for this key") && says("glibc: '1")) << text_;
  write(path, other);
  EXPECT_EQ(count("base"), kCouldNotRun) << "its name is not its key's: " << text_;
}

TEST_F(Instructions, ValgrindKnowsThoseOfTheRoster) {
  EXPECT_EQ(run({"count", "--head", kBin + "/tauext_plugin.so", "--baselines", baselines()}),
            kUpdateNeeded)
      << "it has no baseline here: " << text_;
}

TEST_F(Instructions, AFileThatIsNotWholeIsAnErrorWithItsName) {
  const std::string path = make_counts(), whole = read_whole(path);
  for (const std::string& bad :
       {std::string(), whole.substr(0, whole.size() / 2), std::string("{}")}) {
    write(path, bad);
    EXPECT_EQ(count("base"), kCouldNotRun) << text_;
    EXPECT_TRUE(says(path)) << text_;
  }
}

}  // namespace
}  // namespace tauext::gate::test

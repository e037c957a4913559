// SPDX-License-Identifier: Apache-2.0
// What every commit measured is kept, and steps that each pass add up to one that does not.
#include "mjcf/trace/input_file.h"
#include "regression/test/gate_fixture.h"

namespace tauext::gate::test {
namespace {

class History : public Gate {
 protected:
  int append(const std::string& commit, const std::string& head, const std::string& bench = "") {
    return run({"append",      file(),
                "--commit",    commit,
                "--date",      "2026-01-01T00:00:00Z",
                "--title",     "work of " + commit,
                "--reference", "c0",
                "--base",      plugin("base"),
                "--head",      plugin(head),
                "--bench",     bench,
                "--baselines", baselines(),
                "--entries",   kEntries});
  }
  int show() { return run({"history", file()}); }
  std::string file() const { return baselines() + "/history.jsonl"; }
};

TEST_F(History, StepsOfOneAndAHalfPercentAreFlaggedByTheFourth) {
  ASSERT_EQ(append("c0", "base"), kGood) << text_;
  ASSERT_EQ(show(), kGood) << text_;
  EXPECT_TRUE(says("kernels that are as fast as the reference's: 1")) << text_;
  // each step adds one stage to the 60 of the step before it
  for (const char* step : {"1", "2", "3", "4"}) {
    ASSERT_EQ(append(std::string("c") + step, std::string("step") + step), kGood) << text_;
    if (step[0] == '1') {
      ASSERT_EQ(show(), kGood) << "one alone is nobody's drift: " << text_;
    }
  }
  EXPECT_EQ(show(), kSlower) << text_;
  EXPECT_TRUE(says("testbed1/subject: +") && says("beside the reference, surely more than"))
      << text_;
}

TEST_F(History, KeepsWhatItHasIfACommitCannotBeMeasured) {
  ASSERT_EQ(append("c0", "base"), kGood) << text_;
  const std::string before = read_whole(file());
  refuses({"append", file(), "--commit", "c0", "--date", "d", "--reference", "c0", "--base",
           plugin("base"), "--head", plugin("base"), "--bench", ""},
          "--commit c0: is on record already");
  EXPECT_EQ(append("c1", "nothing"), kCouldNotRun) << text_;
  EXPECT_EQ(append("c1", "base", kBin + "/nothing"), kCouldNotRun) << text_;
  EXPECT_EQ(read_whole(file()), before);
  write(file(), before.substr(0, before.size() / 2));
  refuses({"history", file()}, file() + ": line 1: no record of a commit: ");
  EXPECT_EQ(append("c1", "base"), kCouldNotRun) << text_;
  write(file(), "");
  refuses({"history", file()}, file() + ": no commit is on record");
  refuses({"history", file() + "x"}, "No such file or directory");
  write(file(), std::string(100'000, '[') + std::string(100'000, ']') + "\n");
  refuses({"history", file()}, file() + ": its brackets nest deeper than");
}

TEST_F(History, HoldsMetricsThatMoved) {
  const std::string bench = kBin + "/subject_bench";
  ASSERT_EQ(append("c0", "base", bench), kGood) << text_;
  ASSERT_EQ(append("c1", "base", bench), kGood) << text_;
  const std::string text = read_whole(file());
  EXPECT_NE(text.find("testbed1/hold/subject rmse_Nm"), std::string::npos);
  EXPECT_NE(text.find("\"metrics\":{},"), std::string::npos) << "c1 moved nothing: " << text;
}

}  // namespace
}  // namespace tauext::gate::test

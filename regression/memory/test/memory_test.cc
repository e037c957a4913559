// SPDX-License-Identifier: Apache-2.0
// Nothing moves without a reason, and what is accepted is exactly that.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "mjcf/test/error_of.h"
#include "regression/host/files.h"
#include "regression/memory/acceptance.h"
#include "regression/memory/committed.h"

namespace tauext::gate {
namespace {

using tauext::test::error_of;

class Memory : public testing::Test {
 protected:
  Memory() {
    for (const char* side : {"base", "head"}) {
      std::filesystem::create_directories(path(side, ""));
      golden(side, "1", "1.1");
      counts(side, 1000);
      changelog(side, "- 2026-01-01: the first\n");
    }
  }
  std::string path(const std::string& side, const std::string& name) const {
    return folder_.path() + "/" + side + "/" + name;
  }
  void write(const std::string& side, const std::string& name, const std::string& text) const {
    std::ofstream(path(side, name)) << text;
  }
  void golden(const std::string& side, const std::string& a, const std::string& b,
              const std::string& seeds = "seed 1\tseed 2") const {
    write(side, "accuracy.tsv",
          fmt::format("# tauext golden metrics 2\n# mujoco: 2.2.2\n# sensors: s\n"
                      "entry\tmetric\t{}\nr/s/e\trmse_Nm\t{}\t{}\n# end\n",
                      seeds, a, b));
  }
  void counts(const std::string& side, int n) const {
    write(side, "instructions-1.tsv",
          fmt::format("# tauext instruction counts 1\n# arch: x\n"
                      "r/e\t{}\n# end\n",
                      n));
  }
  void changelog(const std::string& side, const std::string& text) const {
    write(side, "log.md", "# Baselines\n" + text);
  }
  MemoryReport compare() const {
    return compare_committed({path("base", ""), path("base", "log.md")},
                             {path("head", ""), path("head", "log.md")});
  }

  TemporaryFolder folder_;
};

TEST_F(Memory, SaysNothingWhereNothingMoved) {
  const MemoryReport r = compare();
  EXPECT_TRUE(r.moved.empty()) << r.moved[0].what << r.moved[0].how;
  EXPECT_FALSE(r.without_reason());
  EXPECT_EQ(r.lines, 2);
}

TEST_F(Memory, AValueThatMovesWantsAReason) {
  golden("head", "0.5", "0.6");
  MemoryReport r = compare();
  ASSERT_EQ(r.moved.size(), 1u);
  EXPECT_EQ(r.moved[0].what, "accuracy.tsv r/s/e rmse_Nm");
  EXPECT_TRUE(r.without_reason());
  changelog("head", "- 2026-01-01: the first\n- 2026-01-02: better\n");
  r = compare();
  EXPECT_FALSE(r.without_reason());
  EXPECT_FALSE(r.worse_without_leave());
  EXPECT_EQ(r.reasons, std::vector<std::string>{"2026-01-02: better"});
}

TEST_F(Memory, WhatIsWorseWantsLeaveToo) {
  for (const auto& [a, b] : {std::pair{"2", "2.2"}, {"never", "never"}}) {
    golden("head", a, b);
    changelog("head", "- 2026-01-01: the first\n- 2026-01-02: other\n");
    EXPECT_TRUE(compare().worse_without_leave()) << a;
    changelog("head", "- 2026-01-01: the first\n- 2026-01-02: other (1 worse, accepted: noise)\n");
    EXPECT_FALSE(compare().worse_without_leave()) << a;
    changelog("head", "- 2026-01-01: the first\n- 2026-01-02: other (worse, accepted: noise)\n");
    EXPECT_TRUE(compare().worse_without_leave()) << "of how many lines?";
    EXPECT_EQ(compare().worse(), 1);
  }
}

TEST_F(Memory, ReasonsOfTheBaseAreNoneOfTheHeads) {
  changelog("base", "- 2026-01-01: the first (1 worse, accepted: once)\n");
  changelog("head", "- 2026-01-01: the first (1 worse, accepted: once)\n");
  golden("head", "2", "2.2");
  EXPECT_TRUE(compare().without_reason());
  EXPECT_TRUE(compare().worse_without_leave());
}

TEST_F(Memory, SeesSeedsEntriesCountsAndTheLastDigit) {
  golden("head", "1", "1.1", "seed 1\tseed 3");
  EXPECT_TRUE(compare().worse_without_leave()) << "other seeds";
  golden("head", "1", "1.1000000000000001");
  EXPECT_TRUE(compare().moved.empty()) << "the same number";
  golden("head", "1", "1.1000000000000003");
  ASSERT_EQ(compare().moved.size(), 1u);
  EXPECT_EQ(compare().moved[0].how, "within the tolerance");
  golden("head", "1", "1.1");
  counts("head", 1020);
  EXPECT_TRUE(compare().worse_without_leave());
  EXPECT_EQ(compare().moved[0].how, "1000 -> 1020 (+2.00 %)");
  counts("head", 1005);
  EXPECT_EQ(compare().worse(), 0);
  EXPECT_TRUE(compare().without_reason());
  counts("head", 1000);
  std::filesystem::remove(path("head", "accuracy.tsv"));
  EXPECT_TRUE(compare().worse_without_leave()) << "all gone";
}

TEST(Acceptance, IsReadBackAndCoversWhatIsNoLarger) {
  const TemporaryFolder folder;
  const std::string path = accepted_path(folder.path());
  EXPECT_TRUE(read_acceptances(path).empty()) << "no file, nothing accepted";
  const Acceptance a{"time", "r/e", 0.03, "abc", "two more terms"};
  std::ofstream(path) << format_acceptances({a, {"accuracy", "r/s/e rmse_Nm", 0.01, "abc", "x"}});
  const std::vector<Acceptance> all = read_acceptances(path);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[1].reason, "two more terms");
  EXPECT_TRUE(all[1].covers("time", "r/e", 0.03));
  EXPECT_FALSE(all[1].covers("time", "r/e", 0.0301));
  EXPECT_FALSE(all[1].covers("long", "r/e", 0.01));
  EXPECT_FALSE(all[1].covers("time", "r/f", 0.01));
}

TEST(Acceptance, ThatIsNotWholeIsAnError) {
  const TemporaryFolder folder;
  const std::string path = accepted_path(folder.path());
  const std::string text = format_acceptances({{"time", "r/e", 0.03, "abc", "why"}});
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string bad = text;
    std::ofstream(path) << bad.replace(bad.find(from), from.size(), to);
    return error_of([&] { read_acceptances(path); });
  };
  EXPECT_EQ(with("0.03", "lots"),
            path + ": line 3: at most is 'lots', and must be a number like 0.03");
  EXPECT_EQ(with("0.03", "-1"), path + ": line 3: at most is '-1', and must be a number like 0.03");
  EXPECT_EQ(with("\twhy", ""),
            path + ": line 3: 4 columns, and must be layer, subject, at most, base and reason");
  EXPECT_EQ(with("why", "why\tmore").find(path + ": line 3: 6 columns"), 0u);
  EXPECT_EQ(with("time", "tima").find("unknown layer 'tima' of " + path + ": line 3; known: "), 0u);
  EXPECT_EQ(with("# end\n", "# end\nmore\n"), path + ": there are lines behind '# end'");
  EXPECT_EQ(with("abc", ""), path + ": line 3: base is empty, and must be a commit");
  EXPECT_EQ(with("# end", ""),
            path + ": line 4: 0 columns, and must be layer, subject, at most, base and reason");
  EXPECT_NE(with("accepted findings", "x").find("line 1: it must be"), std::string::npos);
}

}  // namespace
}  // namespace tauext::gate

// SPDX-License-Identifier: Apache-2.0
#include "regression/counts/counts.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "mjcf/test/error_of.h"
#include "regression/counts/instructions.h"
#include "regression/host/files.h"

namespace tauext::gate {
namespace {

using tauext::test::error_of;

// as callgrind writes it: names are numbered once, a call's inclusive cost follows its calls= line
const char* const kDump =
    "# callgrind format\nversion: 1\ndesc: Trigger: Client Request: arm/ekf\n\nevents: Ir\n\n"
    "fn=(1) Ekf<Arm>::update(int)\n0 10\n0 5\ncfn=(2) Arm::inertia()\ncalls=3 0\n0 60\n0 1\n\n"
    "fn=(2)\n0 60\n\ntotals: 76\n";

TEST(Callgrind, SelfCostsAreTheFunctionsOwn) {
  const CallgrindDump d = parse_callgrind(kDump, "f");
  EXPECT_EQ(d.trigger, "arm/ekf");
  EXPECT_EQ(d.total, 76u);
  EXPECT_EQ(d.functions.at("Ekf<Arm>::update(int)"), 16u);
  EXPECT_EQ(d.functions.at("Arm::inertia()"), 60u);
}

TEST(Callgrind, LinesAreTheirFilesWhateverFunctionTheyAreInlinedInto) {
  const CallgrindDump d = parse_callgrind(
      "# callgrind format\nfl=(1) ././estimators/a.h\nfn=(1) f\n7 10\nfi=(2) estimators/b.h\n3 4\n"
      "fe=(3) ./build/release/../../estimators/a.h\n7 1\ncfi=(2)\ncfn=(2) g\ncalls=1 9\n8 60\n8 "
      "2\n0 5\n\ntotals: 82\n",
      "f");
  EXPECT_EQ(d.lines, (LineCounts{{{"estimators/a.h", 7}, 11},
                                 {{"estimators/b.h", 3}, 4},
                                 {{"estimators/a.h", 8}, 2}}))
      << "not the callee's 60, and nothing of no line";
}

TEST(Lines, ThatMovedAreNotOthers) {
  const LineCounts before = {
      {{"a.h", 10}, 100}, {{"a.h", 11}, 200}, {{"a.h", 12}, 100}, {{"b.h", 1}, 7}};
  const LineCounts moved = {
      {{"a.h", 20}, 100}, {{"a.h", 21}, 200}, {{"a.h", 22}, 100}, {{"b.h", 1}, 7}};
  EXPECT_TRUE(changed_lines(before, moved).empty());
  LineCounts more = moved;
  more[{"a.h", 21}] = 250;
  std::vector<LineChange> c = changed_lines(before, more);
  ASSERT_EQ(c.size(), 1u);
  EXPECT_EQ(c[0].file, "a.h");
  EXPECT_EQ(c[0].line, 21);
  EXPECT_EQ(c[0].by, 50);
  LineCounts fewer = moved;
  fewer.erase({"a.h", 21});
  c = changed_lines(before, fewer);
  ASSERT_EQ(c.size(), 1u);
  EXPECT_EQ(c[0].line, 22) << "behind what is gone";
  EXPECT_EQ(c[0].by, -200);
}

TEST(Lines, ArePairedAsManyAsCanBe) {
  const LineCounts before = {{{"a", 1}, 5}, {{"a", 2}, 7}, {{"a", 3}, 9}, {{"a", 4}, 11}},
                   after = {{{"a", 1}, 7}, {{"a", 2}, 9}, {{"a", 3}, 12}};
  const std::vector<LineChange> c = changed_lines(before, after);
  ASSERT_EQ(c.size(), 2u);
  EXPECT_EQ(c[0].by, -5);
  EXPECT_EQ(c[0].line, 1);
  EXPECT_EQ(c[1].by, 1);
  EXPECT_EQ(c[1].line, 3);
}

TEST(Lines, OfTheLargestChangeAreFirst) {
  const LineCounts before = {{{"a.h", 1}, 10}, {{"b.h", 1}, 10}},
                   after = {{{"a.h", 1}, 20}, {{"b.h", 1}, 10}, {{"c.h", 5}, 500}};
  const std::vector<LineChange> c = changed_lines(before, after);
  ASSERT_EQ(c.size(), 2u);
  EXPECT_EQ(c[0].file, "c.h");
  EXPECT_EQ(c[1].by, 10);
}

TEST(Callgrind, AFileThatIsCutOffIsRefused) {
  const std::string text = kDump;
  EXPECT_EQ(error_of([&] {
              parse_callgrind(text.substr(0, text.find("totals")), "f");
            }).find("f: cut off"),
            0u);
  EXPECT_EQ(error_of([] { parse_callgrind("", "f"); }).find("f: no file of callgrind's"), 0u);
}

Counts counts(std::uint64_t n) {
  return {{{"arch", "x86_64"}, {"glibc", "2.36"}}, {{"arm/ekf", n}, {"arm/ndob", 1000}}, {}, {}};
}

TEST(Counts, MoreThanOnePercentIsTooMany) {
  const auto only = [](std::uint64_t n) { return compare_counts(counts(100000), counts(n)).at(0); };
  EXPECT_TRUE(too_many(only(101001)));
  EXPECT_FALSE(too_many(only(100999)));
  EXPECT_FALSE(too_many(only(50000))) << "fewer is no failure";
  EXPECT_EQ(only(101001).kernel, "arm/ekf");
  EXPECT_TRUE(compare_counts(counts(7), counts(7)).empty());
}

TEST(Counts, NameTheFunctionsThatGained) {
  Counts before = counts(1000), after = counts(5000);
  before.functions["arm/ekf"] = {{"a", 500}, {"b", 500}};
  after.functions["arm/ekf"] = {{"a", 400}, {"b", 1500}, {"c", 3100}};
  const CountChange c = compare_counts(before, after).at(0);
  EXPECT_EQ(c.gained, (std::vector<std::string>{"+3.1 a step in c", "+1.0 a step in b"}));
}

TEST(Counts, OfAnotherKeyAreNeverCompared) {
  Counts other = counts(1000);
  other.key["glibc"] = "2.37";
  EXPECT_NE(error_of([&] {
              compare_counts(counts(1000), other);
            }).find("glibc: '2.36' there, '2.37' here"),
            std::string::npos);
  EXPECT_NE(counts_path("d", counts(1).key), counts_path("d", other.key));
}

class CountsFile : public testing::Test {
 protected:
  void write(const std::string& text) { std::ofstream(path_) << text; }
  TemporaryFolder folder_;
  std::string path_ = folder_.path() + "/counts.tsv";
};

TEST_F(CountsFile, IsReadBack) {
  write(format_counts(counts(123)));
  const Counts c = read_counts(path_);
  EXPECT_EQ(c.key, counts(1).key);
  EXPECT_EQ(c.kernels, counts(123).kernels);
}

TEST_F(CountsFile, IsRefusedWithItsNameWheneverItIsNotWhole) {
  const std::string text = format_counts(counts(123));
  for (std::size_t n = 0; n < text.size() - 1; ++n) {
    write(text.substr(0, n));
    EXPECT_EQ(error_of([&] { read_counts(path_); }).find(path_ + ": "), 0u) << n;
  }
  std::string bad = text;
  write(bad.replace(bad.find("123"), 3, "-12"));
  EXPECT_NE(error_of([&] { read_counts(path_); }).find("'-12' is no count"), std::string::npos);
  EXPECT_EQ(error_of([] { read_counts("/nowhere"); }), "/nowhere: No such file or directory");
}

}  // namespace
}  // namespace tauext::gate

// SPDX-License-Identifier: Apache-2.0
// Recordings that people have in several files.
#include "mjcf/trace/read/files/several_files.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "mjcf/test/error_of.h"
#include "mjcf/trace/read/recording.h"
#include "mjcf/trace/read/test/recording.h"

namespace tauext::test {
namespace {

class SeveralFiles : public Recording {
 protected:
  Trace read(const std::string& log, const std::string& map) {
    skipped_ = {};
    return read_recording(log, {.columns = put(map, "map.toml")}, &skipped_);
  }
  std::string error(const std::string& log, const std::string& map) {
    return error_of([&] { read(log, map); });
  }

  const std::string head_ = "t,q1,qd1,tau1\n",
                    parts_ = "preset = 'tauext'\nparts = 'run_(.+).csv'\n";
  SkippedRows skipped_;
};

TEST_F(SeveralFiles, FollowEachOtherByTheirNumbers) {
  for (int part = 1; part <= 11; ++part) {
    std::string csv = head_;
    for (int k = 0; k < 10; ++k) {
      const int at = 10 * (part - 1) + k;
      csv += fmt::format("{:.2f},{},0,{}\n", 0.01 * at, at, -at);
    }
    put(csv, fmt::format("run_{}.csv", part));  // 10 and 11 are before 2 by name
  }
  put("no part", "notes.txt");
  const Trace all = read(folder_.string(), parts_);
  ASSERT_EQ(all.size(), 110);
  for (int k = 0; k < 110; ++k) EXPECT_EQ(all.q(0, k), k);
  EXPECT_EQ(skipped_.total(), 0);
  // without a time the rows are counted through all of them
  const Trace counted = read(folder_.string(),
                             "parts = 'run_(.+).csv'\nrate = 50\n[q]\ncolumns = ['q1']\n[tau]\n"
                             "columns = ['tau1']\n");
  EXPECT_NEAR(counted.t.back(), 109 / 50., 1e-12);
}

TEST_F(SeveralFiles, ThatEachBeginWithTheRowBeforeHaveItOnce) {
  const auto cut = [&](int each, int rows_again) {
    for (int part = 0; part < 4; ++part) {
      std::string csv = "q1,none,tau1\n";
      for (int k = each * part - (part > 0 ? rows_again : 0); k < each * (part + 1); ++k)
        csv += fmt::format("{},{},{}\n", k / 3, part, k);  // q stands for three rows
      put(csv, fmt::format("run_{}.csv", part + 1));
    }
    return read(folder_.string(),
                "parts = 'run_(.+).csv'\nrate = 50\n[q]\ncolumns = ['q1']\n[tau]\n"
                "columns = ['tau1']\n");
  };
  const Trace whole = cut(10, 0), again = cut(10, 1);
  EXPECT_EQ(whole.size(), 40);
  EXPECT_EQ(again.q, whole.q);
  EXPECT_EQ(again.tau, whole.tau);
  EXPECT_EQ(skipped_.notes.back(),
            "3 of 4 parts begin with the last row of the one before, which is left out there");
  EXPECT_EQ(cut(10, 2).size(), 46);  // two rows again are no overlap of one
}

TEST_F(SeveralFiles, ThatAreNoPartsOfOneRecordingAreErrors) {
  EXPECT_EQ(
      error(folder_.string(), parts_),
      folder_.string() + ": no file's whole name matches `parts = 'run_(.+).csv'` of the map");
  put(head_ + "0,0,0,0\n1,0,0,0\n", "run_1.csv");
  const std::string second = put("t,q1,tau1,qd1\n2,0,0,0\n", "run_2.csv");
  EXPECT_EQ(
      error(folder_.string(), parts_),
      second + ": its columns are not those of 'run_1.csv': column 3 is 'tau1', and there 'qd1'");
  std::filesystem::remove(second);
  put(head_ + "2,0,0,0\n", "run_01.csv");
  EXPECT_EQ(error(folder_.string(), parts_),
            folder_.string() + ": 'run_01.csv' and 'run_1.csv' are both part 1");
  EXPECT_NE(error(path("run_1.csv"), parts_).find("are files in a folder: Not a directory"),
            std::string::npos);
  EXPECT_NE(error(folder_.string(), "parts = 'run_('\n[q]\ncolumns = [1]\n").find("parts 'run_('"),
            std::string::npos);
}

TEST_F(SeveralFiles, StandSideBySide) {
  const std::string log = put("t,a\n0,1\n0.01,2\n0.02,x\n0.03,4\n0.04,5\n", "motion.csv");
  put("a,b\n0,10\n0,20\n0,30\n0,40,50\n0,50\n", "torque.csv");
  const std::string map =
      "[t]\ncolumns = ['t']\n[q]\ncolumns = ['a']\n[tau]\nfile = 'torque.csv'\ncolumns = [2]\n";
  const Trace both = read(log, map);
  ASSERT_EQ(both.size(), 3);  // the rows 3 and 4 cannot be read in one of them each
  EXPECT_EQ(both.q, (Eigen::RowVector3d{1, 2, 5}));
  EXPECT_EQ(both.tau, (Eigen::RowVector3d{10, 20, 50}));
  EXPECT_EQ(skipped_.total(), 2);
  // the last line is cut off in one of them, whichever comes first
  put("t,a\n0,1\n0.01,2\n0.02", "motion.csv");
  put("a,b\n0,10\n0,20\n0,30\n", "torque.csv");
  EXPECT_EQ(read(log, map).size(), 2);
  put("t,a\n0,1\n0.01,2\n0.02,3\n", "motion.csv");
  put("a,b\n0,10\n0,20\n0", "torque.csv");
  EXPECT_EQ(read(log, map).size(), 2);
  put("t,a\n0,1\n0.01,2\n0.02,x\n0.03,4\n0.04,5\n", "motion.csv");
  put("a,b\n0,10\n0,20\n0,30\n0,40,50\n0,50\n", "torque.csv");
  // each in its own
  const Trace same = read(folder_.string(),
                          "[t]\nfile = 'motion.csv'\ncolumns = ['t']\n[q]\nfile = 'motion.csv'\n"
                          "columns = ['a']\n[tau]\nfile = 'torque.csv'\ncolumns = ['b']\n");
  EXPECT_EQ(same.tau, both.tau);
  EXPECT_EQ(error(folder_.string(), map),
            folder_.string() +
                ": is a folder, and not every quantity of the map names its `file` "
                "in it");
  put("a,b\n0,10\n0,20\n", "torque.csv");
  EXPECT_NE(error(log, map).find("torque.csv: has 2 rows, and " + log + " has more"),
            std::string::npos)
      << error(log, map);
  EXPECT_NE(
      error(log, map + "[qd]\nfile = 'none.csv'\ncolumns = [1]\n").find("none.csv: No such file"),
      std::string::npos);
}

// what both have, though it is read of one, is the same in both: but for digits, and for the times
// of two topics
TEST_F(SeveralFiles, SideBySideOfTwoRecordingsAreDoubted) {
  const auto notes = [&](double stamp, double position, const std::string& column) {
    std::string motion = head_, torque = "t,tau1," + column + "\n";
    for (int k = 0; k < 100; ++k) {
      motion += fmt::format("{:.6f},{:.6f},0,0\n", 0.01 * k, 0.001 * k);
      torque += std::isnan(stamp)
                    ? "12:30,1,none\n"
                    : fmt::format("{:.9f},1,{:.9f}\n", 0.01 * k + stamp, 0.001 * k + position);
    }
    skipped_ = {};
    put(torque, "torque.csv");
    const Trace t = read(put(motion, "motion.csv"),
                         "preset = 'tauext'\n[tau]\nfile = 'torque.csv'\ncolumns = ['tau1']\n");
    EXPECT_EQ(t.size(), 100);
    return skipped_.notes;
  };
  using Notes = std::vector<std::string>;
  EXPECT_EQ(notes(0, 0, "q1"), Notes{});
  EXPECT_EQ(notes(0.004, 1e-7, "q1"), Notes{});
  EXPECT_EQ(notes(0, 5, "q2"), Notes{});
  EXPECT_EQ(notes(NAN, 0, "q1"), Notes{}) << "which are no numbers";
  EXPECT_EQ(notes(5, 0, "q1"), Notes{"column 't' of torque.csv is up to 5 away from that of "
                                     "motion.csv: are these files of one recording?"});
  EXPECT_EQ(notes(0, -0.5, "q1"), Notes{"column 'q1' of torque.csv is up to 0.5 away from that of "
                                        "motion.csv: are these files of one recording?"});
}

}  // namespace
}  // namespace tauext::test

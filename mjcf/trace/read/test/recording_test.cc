// SPDX-License-Identifier: Apache-2.0
// Our own CSV, and what every recording has in common.
#include "mjcf/trace/read/recording.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>

#include "mjcf/test/error_of.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/read/npy_writer.h"
#include "mjcf/trace/test/same_trace.h"
#include "mjcf/trace/test/some_trace.h"

namespace tauext::test {
namespace {

namespace fs = std::filesystem;

Trace read_csv(const std::string& path, SkippedRows* skipped) {
  return read_recording(path, {}, skipped);
}

class TraceFile : public testing::Test {
 protected:
  TraceFile()
      : folder_(fs::temp_directory_path() / ("tauext_trace_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~TraceFile() override { fs::remove_all(folder_); }

  std::string path(const std::string& name = "t.csv") const { return (folder_ / name).string(); }
  std::string written(const std::string& text) const {
    std::ofstream(path()) << text;
    return path();
  }
  std::string error_of_reading(const std::string& text) const {
    SkippedRows skipped;
    const std::string file = written(text);
    return error_of([&] { read_csv(file, &skipped); });
  }
  fs::path folder_;
};

constexpr const char* kHead = "t,q1,q2,qd1,qd2,tau1,tau2\n";

TEST_F(TraceFile, ComesBackBitForBit) {
  const Trace t = some_trace(3, 2000);
  write_csv(t, path());
  SkippedRows skipped;
  const Trace r = read_csv(path(), &skipped);
  EXPECT_EQ(skipped.total(), 0);
  expect_same(r, t);
}

TEST_F(TraceFile, ComesBackFromNumPyBitForBit) {
  Trace t = some_trace(3, 2000);
  write_npz(path("t.npz"), t);
  SkippedRows skipped;
  expect_same(read_csv(path("t.npz"), &skipped), t);
  EXPECT_EQ(skipped.total(), 0);
  t.torque_at_instants = true;
  write_npz(path("instants.npz"), t);
  EXPECT_TRUE(read_csv(path("instants.npz"), &skipped).torque_at_instants);
}

TEST_F(TraceFile, HasTheColumnsOfTheReadme) {
  write_csv(some_trace(3, 10), path());
  std::ifstream in(path());
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "t,q1,q2,q3,qd1,qd2,qd3,tau1,tau2,tau3,tau_ext1,tau_ext2,tau_ext3,contact");
}

TEST_F(TraceFile, TorqueReadAtInstantsSaysSoInItsName) {
  Trace t = some_trace(2, 10);
  t.torque_at_instants = true;
  write_csv(t, path());
  std::ifstream in(path());
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "t,q1,q2,qd1,qd2,tau_instant1,tau_instant2,tau_ext1,tau_ext2,contact");
  SkippedRows skipped;
  const Trace r = read_csv(path(), &skipped);
  EXPECT_TRUE(r.torque_at_instants);
  expect_same(r, t);
  EXPECT_FALSE(
      read_csv(written(std::string(kHead) + "0,0,0,0,0,0,0\n"), &skipped).torque_at_instants);
  EXPECT_EQ(error_of_reading("t,q1,qd1,tau1,tau_instant1\n0,0,0,0,0\n"),
            path() +
                ": 'tau1' are [tau], and 'tau_instant1' are [tau_instant]: the map must choose one "
                "of them");
  EXPECT_EQ(error_of_reading("t,q1,q2,qd1,qd2,tau_instant1\n0,0,0,0,0,0\n"),
            path() + ": [tau_instant] has 1 columns ('tau_instant1'), and not 2, as q has");
}

TEST_F(TraceFile, BadRowsAreSkippedAndCountedByReason) {
  SkippedRows skipped;
  const Trace t = read_csv(
      written(std::string(kHead) + "0,1,2,3,4,5,6\n"          // good
                                   "0.001,1,2,3,nan,5,6\n"    // not finite
                                   "0.002,1,2,3,1e999,5,6\n"  // not finite either
                                   "0.003,1,2,3,4,5\n"        // a field too few
                                   "0.004,1,2,3,4,5,6,7\n"    // a field too many
                                   "0.005,1,2,x,4,5,6\n"      // no number
                                   "0.006,1,2,,4,5,6\n"       // nothing
                                   "0,1,2,3,4,5,6\n"          // time stands still
                                   "\n"                       // nothing, and no row
                                   "0.007, 7 ,2,3,4,5,6\r\n"  // good: blanks and CR do not matter
                                   "0.008,1,2,3"),            // cut off
      &skipped);
  EXPECT_EQ(t.size(), 2);
  EXPECT_EQ(t.q(0, 1), 7);
  EXPECT_EQ(skipped.not_finite, 3);
  EXPECT_EQ(skipped.wrong_field_count, 3);
  EXPECT_EQ(skipped.not_a_number, 1);
  EXPECT_EQ(skipped.time_order, 1);
  ASSERT_FALSE(skipped.first.empty());
  EXPECT_EQ(skipped.first[0], "line 3: column 'qd2' is empty or not finite");
  EXPECT_FALSE(t.has_truth());
  EXPECT_TRUE(t.contact.empty());
}

TEST_F(TraceFile, OneFalseTimeCostsOneRowAndANewClockNone) {
  const auto read = [this](const std::vector<double>& times, SkippedRows& skipped) {
    std::string csv = kHead;
    for (const double t : times) csv += fmt::format("{:.17g},1,2,3,4,5,6\n", t);
    return read_csv(written(csv), &skipped).t;
  };
  SkippedRows one, first, back, gap;
  const std::vector<double> good = {0, 0.001, 0.002, 0.003};
  EXPECT_EQ(read({0, 0.001, 1e9, 0.002, 0.003}, one), good);
  EXPECT_EQ(one.time_order, 1);
  EXPECT_EQ(one.first.at(0), "line 4: its time is not the next one");
  EXPECT_EQ(read({1e9, 0, 0.001, 0.002, 0.003}, first), good);
  EXPECT_EQ(first.time_order, 1);
  EXPECT_EQ(first.first.at(0), "line 2: its time is not the next one");
  SkippedRows second;
  EXPECT_EQ(read({0, 0.04, 0.002, 0.003, 0.004, 0.005}, second).size(), 5u);
  EXPECT_EQ(second.first.at(0), "line 3: its time is not the next one");
  EXPECT_TRUE(second.notes.empty());
  SkippedRows ahead;
  EXPECT_EQ(read({0, 0.001, 0.002, 0.008, 0.004, 0.005, 0.006, 0.007, 0.008}, ahead).size(), 8u);
  EXPECT_EQ(ahead.first.at(0), "line 5: its time is not the next one");
  EXPECT_TRUE(ahead.notes.empty());
  const std::vector<double> later = read({8, 8.001, 8.002, 3, 3.001, 3.002}, back);
  ASSERT_EQ(later.size(), 6u);
  EXPECT_NEAR(later[3], 9.002, 1e-9);
  EXPECT_NEAR(later[5], 9.004, 1e-9);
  EXPECT_EQ(back.total(), 0);
  EXPECT_EQ(back.notes.at(0),
            "line 5: its clock was set back by 5.002 s; 6.002 s are added to the times from there "
            "on");
  SkippedRows again;  // rows that come twice, as in parts that overlap
  EXPECT_EQ(read({0, 0.2, 0.4, 0.6, 0.8, 0.4, 0.6, 0.8, 1.0, 1.2}, again).size(), 7u);
  EXPECT_EQ(again.time_order, 3);
  EXPECT_EQ(again.notes.at(0).substr(0, 37), "line 7: its time goes back by 0.4 s; ");
  SkippedRows anew;  // another run, whose clock begins as the first one's
  EXPECT_EQ(read({0, 0.2, 0.4, 0.6, 0, 0.2, 0.4, 0.6, 0.8}, anew).size(), 9u);
  EXPECT_EQ(anew.set_back, 1);
  EXPECT_EQ(read({0, 0.001, 5, 5.001, 5.002, 5.003}, gap).size(), 6u);
  EXPECT_EQ(gap.total(), 0);
  EXPECT_TRUE(gap.notes.empty());
  SkippedRows no_digits;  // 3e17 + 0.001 is 3e17
  EXPECT_EQ(read({0, 0.001, 3e17, 3.1e17, 3.2e17, 5, 5.001, 5.002}, no_digits).size(), 5u);
  EXPECT_EQ(no_digits.first.at(0), "line 7: its time is not the next one");
}

TEST_F(TraceFile, ALastLineWithoutItsEndIsNotTrusted) {
  SkippedRows skipped;
  const Trace t =
      read_csv(written(std::string(kHead) + "0,1,2,3,4,5,6\n0.001,1,2,3,4,5,-5"), &skipped);
  EXPECT_EQ(t.size(), 1);
  EXPECT_EQ(skipped.first.at(0), "line 3: the last line has no end: the file may be cut off there");
  SkippedRows less;
  EXPECT_EQ(read_csv(written(std::string(kHead) + "0,1,2,3,4,5,6\n0.001,1,2,-"), &less).size(), 1);
  EXPECT_EQ(less.first, skipped.first);
  EXPECT_EQ(less.total(), 1);
}

TEST_F(TraceFile, HalfATruthIsRefused) {
  EXPECT_EQ(error_of_reading("t,q1,q2,qd1,qd2,tau1,tau2,tau_ext1\n0,1,2,3,4,5,6,7\n"),
            path() + ": [tau_ext] has 1 columns ('tau_ext1'), and not 2, as q has");
}

TEST_F(TraceFile, ColumnsAreFoundByNameInAnyOrder) {
  SkippedRows skipped;
  const Trace t = read_csv(written("temperature,tau1,qd1,q1,t\n20,3,2,1,0\n"), &skipped);
  EXPECT_EQ(t.dof(), 1);
  EXPECT_EQ(t.q(0, 0), 1);
  EXPECT_EQ(t.tau(0, 0), 3);
}

#ifndef TAUEXT_SANITIZED  // which keeps what was freed
// [kB] the most memory that this process has held since `reset`
long most_memory(bool reset) {
  if (reset) std::ofstream("/proc/self/clear_refs") << "5";
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word == "VmHWM:") return status >> word, std::stol(word);
  }
  return 0;
}

TEST_F(TraceFile, IsReadInMemoryThatDoesNotGrowWithIt) {
  constexpr int kRows = 300'000;
  {
    std::ofstream file(path());
    file << kHead;
    for (int k = 0; k < kRows; ++k)
      file << fmt::format("{},{},{},0.1234567890123456,-1.2345678901234567,{},{}\n", 1e-3 * k,
                          std::sin(1e-3 * k), std::cos(1e-3 * k), 1 + 1e-5 * k, 2 - 1e-5 * k);
  }
  const double megabytes = 1e-6 * static_cast<double>(fs::file_size(path()));
  const long before = most_memory(true);
  const std::clock_t begin = std::clock();
  RecordingReader reader(path(), {});
  int rows = 0;
  for (RecordedSample s; reader.next(s);) ++rows;
  const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  std::printf("%.0f MB of CSV at %.0f MB a second of CPU\n", megabytes, megabytes / seconds);
  EXPECT_EQ(rows, kRows);
  EXPECT_GT(megabytes, 25);
  EXPECT_LT(most_memory(false) - before, 6000) << "kB";
}
#endif

TEST_F(TraceFile, ErrorsNameTheFileAndTheReason) {
  EXPECT_EQ(error_of_reading(std::string(kHead) + "0,1,2\n"),
            path() + ": no usable row (1 skipped; line 2: fields: 3, columns: 7)");
  EXPECT_EQ(error_of_reading(kHead), path() + ": no usable row (0 skipped)");
  EXPECT_EQ(error_of_reading(""), path() + ": is empty");
  EXPECT_EQ(error_of_reading("t,q1,qd1\n0,1,2\n"),
            path() + ": no columns for tau; --columns says which they are. There are: t, q1, qd1");
  EXPECT_EQ(
      error_of_reading("0,1,2,3\n0.1,1,2,3\n"),
      path() + ": begins with numbers: the first line must name the columns, like t,q1,qd1,tau1");
  EXPECT_EQ(error_of_reading("t,t,q1,qd1,tau1\n"),
            path() +
                ": column 't' appears twice; a map (--columns) takes one by its number: [t] "
                "columns = [1]");
  EXPECT_EQ(error_of_reading("t,q1,q2,q1,qd1,tau1\n"),
            path() +
                ": column 'q1' appears twice; a map (--columns) takes one by its number: [q] "
                "columns = [2, ..]");
  for (const std::string time : {"2026-11-01T00:00:00.25Z", "2026-11-01 00:00:01", "00:00:02.5"})
    EXPECT_EQ(error_of_reading(kHead + time + ",1,2,3,4,5,6\n"),
              path() + ": no usable row (1 skipped; line 2: column 't' is '" + time +
                  "', not a number: times are numbers, of seconds or a unit that the map says; "
                  "`rate` [Hz] in a map of columns counts the rows instead)");
  for (const int rows : {1, 10000})  // in one block of the file, and in several
    EXPECT_EQ(
        error_of_reading("t,q1,qd1,tau1\r" + std::string(rows * 8UL, '1') + "\r"),
        path() + ": its lines end in CR, and not in LF: tr '\\r' '\\n' < " + path() + " > run.csv");
  EXPECT_EQ(
      error_of_reading("a,b,c\n"),
      path() +
          ": no column has the time, [t]: none is called 't'; --columns says which it is, or with "
          "`rate` that rows have no time. There are: a, b, c");
  SkippedRows skipped;
  EXPECT_EQ(error_of([&] { read_csv("/nowhere/x.csv", &skipped); }),
            "/nowhere/x.csv: No such file or directory");
  EXPECT_EQ(error_of([&] { read_csv(folder_.string(), &skipped); }),
            folder_.string() + ": Is a directory");
  EXPECT_NE(error_of_reading("\xfd\xff").find("There are: ?\?"), std::string::npos);
}

TEST_F(TraceFile, WithoutLineEndsIsNotTakenWhole) {
  EXPECT_NE(error_of_reading("t,q1,qd1,tau1\n0,1,2," + std::string(1 << 20, '1'))
                .find("line 2 is longer than"),
            std::string::npos);
}

TEST_F(TraceFile, AFullDiskAndAMissingFolderAreErrors) {
  const Trace t = some_trace(3, 1000);
  EXPECT_EQ(error_of([&] { write_csv(t, "/dev/full"); }),
            "/dev/full: cannot write: No space left on device");
  EXPECT_EQ(error_of([&] { write_csv(t, "/nowhere/t.csv"); }),
            "/nowhere/t.csv: cannot open for writing: No such file or directory");
}

}  // namespace
}  // namespace tauext::test

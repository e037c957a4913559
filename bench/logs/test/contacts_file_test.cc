// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/contacts_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "bench/logs/read_log.h"
#include "mjcf/test/error_of.h"
#include "mjcf/trace/input_file.h"

namespace tauext::test {
namespace {

namespace fs = std::filesystem;

class Contacts : public testing::Test {
 protected:
  Contacts() : folder_(fs::temp_directory_path() / fmt::format("tauext_contacts_{}", ::getpid())) {
    fs::create_directories(folder_);
  }
  ~Contacts() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string put(const std::string& name, const std::string& text) const {
    release_input(path(name));
    fs::create_directories(fs::path(path(name)).parent_path());
    std::ofstream(path(name)) << text;
    return path(name);
  }
  // 100 samples a second from `from` to `from` + 10 s, which touch where `touched` says so
  std::string put_log(const std::string& name, double from, bool (*touched)(int) = nullptr) const {
    std::string csv = touched == nullptr ? "t,q1,qd1,tau1\n" : "t,q1,qd1,tau1,contact\n";
    for (int k = 0; k <= 1000; ++k)
      csv += fmt::format("{:.2f},0,0,0{}\n", from + 0.01 * k,
                         touched == nullptr ? ""
                         : touched(k)       ? ",1"
                                            : ",0");
    return put(name, csv);
  }
  // of this log with these labels, and the messages about them
  std::vector<std::uint8_t> labels(const std::string& log, const std::string& text) {
    testing::internal::CaptureStderr();
    const RecordedLog read = [&] {
      try {
        LogOptions o;
        o.contacts = contacts_of(put("labels.csv", text), {log});
        return read_any_log(log, o);
      } catch (...) {
        messages_ = testing::internal::GetCapturedStderr();
        throw;
      }
    }();
    messages_ = testing::internal::GetCapturedStderr();
    return read.trace.contact;
  }
  std::string error_of_labels(const std::string& log, const std::string& text) {
    const std::string error = error_of([&] { labels(log, text); });
    const std::string own = path("labels.csv") + ": ";
    return error.starts_with(own) ? error.substr(own.size()) : "without its path: " + error;
  }

  fs::path folder_;
  std::string messages_;
};

TEST_F(Contacts, AreFromTheirStartToTheirEndAndOfTheirKind) {
  const std::string log = put_log("a.csv", 1.7e9);
  const std::vector<std::uint8_t> is =
      labels(log,
             "# by hand\r\nfile,start,end,kind,who\r\na.csv,1700000001,1700000001.5,,x\r\n\r\n"
             "\"a.csv\",1700000003,1700000003,intentional,y\r\na.csv,1700000005,1700000006,"
             "accidental,z\r\n");
  ASSERT_EQ(is.size(), 1001u);
  for (int k = 0; k <= 1000; ++k) {
    const bool collides = (k >= 100 && k <= 150) || (k >= 500 && k <= 600);
    ASSERT_EQ(is[static_cast<std::size_t>(k)], collides ? 1 : k == 300 ? 2 : 0) << k;
  }
}

TEST_F(Contacts, ALineWithoutTimesSaysThatNothingTouches) {
  const std::vector<std::uint8_t> is = labels(put_log("a.csv", 0), "end;file;start\n;a.csv;\n");
  ASSERT_EQ(is.size(), 1001u);
  EXPECT_EQ(std::count(is.begin(), is.end(), 0), 1001);
}

TEST_F(Contacts, TakeThePlaceOfTheLogsOwnAndSaySoWhereTheyDiffer) {
  const std::string log = put_log("a.csv", 0, [](int k) { return k >= 100 && k <= 200; });
  labels(log, "file,start,end\na.csv,1,2\n");
  EXPECT_EQ(messages_.find("labels"), std::string::npos) << messages_;
  labels(log, "file,start,end\na.csv,1.5,2.5\n");
  EXPECT_NE(messages_.find("its own labels are not used, and are others than those of " +
                           path("labels.csv") + " in 100 samples"),
            std::string::npos)
      << messages_;
}

TEST_F(Contacts, OfALogWhoseClockWasSetBackCanMeanTwoSamples) {
  std::string csv = "t,q1,qd1,tau1\n";
  for (const double from : {0, 4})
    for (int k = 0; k <= 1000; ++k) csv += fmt::format("{:.2f},0,0,0\n", from + 0.01 * k);
  const std::string log = put("a.csv", csv);
  const std::string error = error_of([&] { labels(log, "file,start,end\na.csv,5,6\n"); });
  EXPECT_NE(error.find("a.csv: its clock was set back, so a time in " + path("labels.csv") +
                       " can mean two samples"),
            std::string::npos)
      << error;
  EXPECT_EQ(labels(log, "file,start,end\na.csv,,\n").size(), 2002u);
}

TEST_F(Contacts, AreFoundByNameOrByPath) {
  const std::string a = put_log("one/x.csv", 0), b = put_log("two/x.csv", 0),
                    c = put_log("c.csv", 0);
  const ContactsFile by_path(
      put("labels.csv", fmt::format("file,start,end\none/x.csv,1,2\n{},3,4\nc.csv,5,6\n", b)),
      {a, b, c});
  EXPECT_EQ(by_path.of(a).at(0).from, 1);
  EXPECT_EQ(by_path.of(b).at(0).from, 3);
  EXPECT_EQ(by_path.of(c).at(0).from, 5);
  EXPECT_NE(
      error_of([&] {
        ContactsFile(put("labels.csv", "file,start,end\nx.csv,1,2\n"), {a, b});
      }).find("labels.csv: line 2: 'x.csv' is more than one of the recordings: name its path"),
      std::string::npos);
}

TEST_F(Contacts, OfFilesThatAreNotReadAreLeftOutWithAWord) {
  const std::string log = put_log("a.csv", 20);
  const auto contact = labels(log, "file,start,end\nb.csv,1,2\na.csv,21,22\nb.csv,3,4\nc.csv,,\n");
  EXPECT_EQ(std::count(contact.begin(), contact.end(), 1), 101);
  EXPECT_NE(messages_.find(
                "labels.csv: left out what it has of 2 files that are not read: 'b.csv', 'c.csv'"),
            std::string::npos)
      << messages_;
}

TEST_F(Contacts, ThatAreWrongAreErrorsOfTheirLine) {
  const std::string log = put_log("a.csv", 20), head = "file,start,end,kind\n";
  const auto error = [&](const std::string& lines) { return error_of_labels(log, head + lines); };
  EXPECT_EQ(error(""), "has no line for " + log +
                           "; where nothing touches the arm in it, say so by "
                           "a line without times: a.csv,,");
  EXPECT_EQ(error("a.csv,22,21,\n"), "line 2: ends at 21 s, before its start at 22 s");
  EXPECT_EQ(error("a.csv,21,22,\na.csv,25,26,\na.csv,21.5,23,\n"),
            "line 4: 21.5 to 23 s overlaps line 2, 21 to 22 s");
  EXPECT_EQ(error("a.csv,21,22,\na.csv,21,22,\n"),
            "line 3: 21 to 22 s overlaps line 2, 21 to 22 s");
  EXPECT_EQ(error("a.csv,21,22,\na.csv,,,\n"),
            "line 3: says that nothing touches the arm in 'a.csv', and line 2 has a contact of it");
  EXPECT_EQ(error("a.csv,21,22 s,\n"), "line 2: '21' to '22 s' are no times [s]");
  EXPECT_EQ(error("a.csv,21,,\n"), "line 2: '21' to '' are no times [s]");
  EXPECT_EQ(error("a.csv,21,nan,\n"), "line 2: '21' to 'nan' are no times [s]");
  EXPECT_EQ(error("a.csv,21,22\n"), "line 2: 3 fields, and the first line names 4");
  EXPECT_EQ(error("a.csv,21,22,hit\n"),
            "line 2: unknown kind of contact 'hit'; known: collision, accidental, intended, "
            "intentional");
  EXPECT_EQ(error("a.csv,1,2,\n"),
            "line 2: 1 to 2 s begins before the first sample of " + log +
                ", at 20 s; times are those of the recording, and do not begin with 0 there");
  EXPECT_EQ(error("a.csv,29,30.5,\n"),
            "line 2: 29 to 30.5 s ends behind the last sample of " + log + ", at 30 s");
  EXPECT_EQ(error("a.csv,29,30.05,\n"), "without its path: no error") << "rounded";
  EXPECT_EQ(error("a.csv,25.001,25.009,\n"),
            "line 2: 25.001 to 25.009 s has no sample of " + log +
                " in it, which goes from 20 s on: is it in a gap?");
  EXPECT_EQ(
      error_of_labels(log, "path,start,end\n"),
      "line 1: has no column 'file': the first line is file,start,end or file,start,end,kind");
  EXPECT_EQ(error_of_labels(log, "\n# no\n"), "is empty: no line names the columns");
}

}  // namespace
}  // namespace tauext::test

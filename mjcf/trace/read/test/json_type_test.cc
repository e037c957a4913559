// SPDX-License-Identifier: Apache-2.0
// Messages in JSON. samples.mcap and json.mcap were written by a program of its own in Python, by
// mcap.dev/spec; Python's json wrote the messages.
#include "mjcf/trace/read/bag/json_type.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "mjcf/trace/read/bag/bag_rows.h"
#include "mjcf/trace/read/recording.h"
#include "mjcf/trace/read/test/recording.h"
#include "mjcf/trace/read/test/some_bag.h"

namespace tauext::test {
namespace {

using Names = std::vector<std::string>;

const std::string kSamples = "mjcf/trace/read/test/samples.mcap";
const std::string kJson = "mjcf/trace/read/test/json.mcap";

class JsonBag : public Recording {
 protected:
  // messages on topics of any types, each with the time at which it was recorded
  struct Line {
    int topic;  // from 1
    long long ns;
    std::string text;
  };
  std::string with(const std::vector<Line>& lines) const {
    put("", "x.db3");
    SomeBag bag(path("x.db3"));
    bag.make_tables();
    bag.add_topic("/a", "own/A", "json");
    bag.add_topic("/b", "own/B", "json");
    for (const Line& l : lines) bag.add_message(l.topic, l.ns, l.text);
    return path("x.db3");
  }
};

void expect_same_rows(const Rows& rows, const Rows& want) {
  ASSERT_EQ(rows.size(), want.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_EQ(rows[i].size(), want[i].size());
    for (std::size_t k = 0; k < want[i].size(); ++k)
      EXPECT_TRUE(rows[i][k] == want[i][k] || (std::isnan(rows[i][k]) && std::isnan(want[i][k])))
          << "row " << i << ", column " << k << ": " << rows[i][k];
  }
}

TEST_F(JsonBag, OurSamplesAreReadWithTheirTruth) {
  SkippedRows skipped;
  const Trace t = read_recording(kSamples, {}, &skipped);
  EXPECT_EQ(skipped.total(), 0);
  EXPECT_TRUE(skipped.notes.empty());
  ASSERT_EQ(t.size(), 3);
  for (int k = 0; k < 3; ++k) {
    const double at = 1. / 3 + (k == 0 ? 0 : k * 1e-3);
    EXPECT_EQ(t.t[static_cast<std::size_t>(k)], at) << "t of the message, and not of the file";
    EXPECT_EQ(t.q.col(k), Eigen::Vector2d(at, -at));
    EXPECT_EQ(t.qd.col(k), Eigen::Vector2d(0.25, 0.5));
    EXPECT_EQ(t.tau.col(k), Eigen::Vector2d(10 * at, 20 * at));
    EXPECT_EQ(t.tau_ext.col(k), Eigen::Vector2d(1 + at, 2 + at));
    EXPECT_EQ(t.contact[static_cast<std::size_t>(k)], k != 0) << "0, 1, 2 in the file";
  }
  EXPECT_FALSE(t.torque_at_instants);
  EXPECT_FALSE(read_recording(kSamples, {"", "/measured", {}}, &skipped).has_truth());
  EXPECT_NE(error_of([&] {
              read_recording(kSamples, {"", "/truth", {}}, &skipped);
            }).find("--columns says which it is"),
            std::string::npos);
}

// the keys are in the alphabet's order, so that the names come after the efforts
TEST_F(JsonBag, NamesSayWhichJointANumberBelongsTo) {
  const Rows want = {{100.25, 970, 980, 97, 98, 0.5, 0.5}, {100.5, 970, 980, 97, 98, 0.5, 0.5}};
  BagRows rows(kJson, "", {"a", "b"});
  EXPECT_EQ(rows.columns(), (Names{"t", "effort.a", "effort.b", "position.a", "position.b",
                                   "velocity.a", "velocity.b"}));
  expect_same_rows(rows_of(BagRows(kJson, "", {"a", "b"})), want);
  SkippedRows skipped;
  const Trace t = read_recording(kJson, {"", "", {"b", "a"}}, &skipped);
  EXPECT_EQ(t.q.col(1), Eigen::Vector2d(98, 97));
  EXPECT_NE(error_of([&] {
              BagRows(kJson, "", {"a", "c"});
            }).find("never name c;"),
            std::string::npos);
}

TEST_F(JsonBag, NumbersAreFoundByTheirPathsWhateverHasThem) {
  BagRows rows(kJson, "/a");
  EXPECT_EQ(rows.columns(), (Names{"t", "legs[0].q", "legs[1].q", "legs[0].on", "legs[1].on",
                                   "x.y.z[0]", "x.y.z[1]", "x.y.z[2]", "x"}));
  const double none = std::nan("");
  expect_same_rows(rows_of(BagRows(kJson, "/a")), {{6 * 1e-9, 1.5, none, 1, 0, 1, 2, none, none},
                                                   {8e-9, 2.5, 3.5, none, 1, none, none, none, 7}});
}

TEST_F(JsonBag, MessagesOfOneTimeAreARowUnlessTheyContradictEachOther) {
  const double none = std::nan("");
  const std::string file = with({{1, 1000000000, R"({"q":1,"t":5})"},
                                 {2, 1000000000, R"({"t":5,"x":2})"},
                                 {2, 2000000000, R"({"x":3})"},
                                 {1, 2000000000, R"({"q":4,"t":6})"},
                                 {1, 2000000000, R"({"q":4,"t":6})"},
                                 {1, 3000000000, R"({"q":5,"t":7})"},
                                 {2, 3000000000, R"({"t":8,"x":6})"},
                                 {2, 4000000000, R"({"x":7})"}});
  BagRows rows(file, "/a,/b");
  EXPECT_EQ(rows.columns(), (Names{"t", "q", "message.t", "x"}));
  SkippedRows skipped;
  std::vector<long> numbers;
  Rows all;
  for (std::vector<double> row; rows.next(row, skipped);) {
    all.push_back(row);
    numbers.push_back(rows.number());
  }
  expect_same_rows(all, {{1, 1, 5, 2},
                         {2, 4, 6, 3},
                         {2, 4, 6, none},
                         {3, 5, 7, none},
                         {3, none, 8, 6},
                         {4, none, none, 7}});
  EXPECT_EQ(numbers, (std::vector<long>{1, 3, 5, 6, 7, 8}));
  std::vector<double> row;
  EXPECT_FALSE(rows.next(row, skipped)) << "which stays so";
}

TEST_F(JsonBag, WhatIsNoMessageIsSkippedAndCounted) {
  std::string many, deep;
  for (int i = 0; i < 65; ++i) many += fmt::format("{}\"j{}\"", i == 0 ? "" : ",", i);
  for (int i = 0; i < 100000; ++i) deep += "[";
  const std::pair<std::string, std::string> bad[] = {
      {R"({"q":1)", "it is no JSON"},
      {R"({"q":1} x)", "it is no JSON"},
      {R"({"q":1e999})", "it is no JSON"},
      {R"({"q":NaN})", "it is no JSON"},
      {"", "it is no JSON"},
      {"\xff", "it is no JSON"},
      {"7", "it is no object of JSON"},
      {R"("text")", "it is no object of JSON"},
      {"[1,2]", "it is no object of JSON"},
      {R"({"name":["a","a"],"q":[1,2]})", "it names a joint twice"},
      {R"({"name":[)" + many + R"(]})", "it has more than 64 joints"},
      {R"({"name":["a","b"],"q":[1,2,3]})", "it has not as many numbers as names"},
      {R"({"q":[1],"x":)" + deep, "it has too many levels"}};
  for (const auto& [text, why] : bad) {
    JsonType type;
    MessageNumbers to;
    const char* const reason = type.read(text, to);
    EXPECT_STREQ(reason, why.c_str()) << text.substr(0, 100);
    BagRows rows(with({{1, 1, R"({"q":1})"}, {1, 2, text}, {1, 3, R"({"q":3})"}}), "/a");
    SkippedRows skipped;
    EXPECT_EQ(rows_of(rows, skipped).size(), 2U);
    EXPECT_EQ(skipped.wrong_field_count, 1);
    EXPECT_EQ(skipped.first, Names{"message 2: " + why});
  }
}

// a thousand messages of a thousand keys that no other has, keys without end, and long arrays
TEST_F(JsonBag, NothingGrowsWithoutEnd) {
  JsonType type;
  MessageNumbers to;
  int key = 0;
  for (int k = 0; k < 200; ++k) {
    std::string text = "{\"q\":1";
    for (int i = 0; i < 500; ++i) text += fmt::format(",\"k{}\":{{\"x\":[1]}}", key++);
    EXPECT_EQ(type.read(text + "}", to), nullptr);
  }
  EXPECT_LE(type.fields().size(), 4096U);
  EXPECT_EQ(to.numbers[0], std::vector<double>{1}) << "what was known stays known";
  JsonType other;
  std::string numbers = "0";
  for (int i = 1; i < 300; ++i) numbers += fmt::format(",{}", i);
  EXPECT_EQ(other.read(fmt::format(R"({{"{}":1,"long":[{}],"a":[[1]],"n":{{"a":[{{"b":[1]}}]}}}})",
                                   std::string(1000, 'k'), numbers),
                       to),
            nullptr);
  ASSERT_EQ(other.fields().size(), 1U) << "paths of 1000 letters and arrays in arrays are none";
  EXPECT_EQ(other.fields()[0].begin, "long");
  EXPECT_TRUE(to.numbers[0].empty()) << "nor are 300 numbers";
}

TEST_F(JsonBag, KeysThatMakeOneNameAreToldApart) {
  BagRows rows(with({{1, 1000000000, R"({"a.b":1,"a":{"b":2},"t":3,"message":{"t":4}})"}}), "/a");
  EXPECT_EQ(rows.columns(), (Names{"t", "a.b", "a.b#2", "message.t", "message.t#2"}));
}

TEST_F(JsonBag, ThatIsDamagedEnds) {
  int readable = 0;
  for (const std::string& whole : {get(kSamples), get(kJson)}) {
    for (std::size_t at = 0; at < whole.size(); ++at) {
      std::string changed = whole;
      changed[at] = static_cast<char>(changed[at] ^ 0x15);
      const std::string file = put(changed, "y.mcap");
      SkippedRows skipped;
      const std::string error = error_of([&] { read_recording(file, {}, &skipped); });
      EXPECT_TRUE(error == "no error" || error.starts_with(file + ": ")) << error;
      readable += error == "no error" ? 1 : 0;
    }
  }
  EXPECT_GT(readable, 20);
}

}  // namespace
}  // namespace tauext::test

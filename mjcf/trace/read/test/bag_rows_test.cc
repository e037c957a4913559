// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/bag/bag_rows.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "mjcf/trace/read/bag/message_type.h"
#include "mjcf/trace/read/recording.h"
#include "mjcf/trace/read/test/recording.h"
#include "mjcf/trace/read/test/some_bag.h"

namespace tauext::test {
namespace {

using Names = std::vector<std::string>;

// stamp 1700000000.25, joints j1 and joint2, position 0.5 -1, velocity 0 2, effort 10 -20.5; bytes
// put together by hand from Fast-CDR's rules
const std::string kAll = bytes_of_hex(
    "00 01 00 00 00 f1 53 65 80 b2 e6 0e 05 00 00 00 62 61 73 65 00 00 00 00 02 00 00 00 03 00 00 "
    "00 6a 31 00 00 07 00 00 00 6a 6f 69 6e 74 32 00 00 02 00 00 00 00 00 00 00 00 00 e0 3f 00 00 "
    "00 00 00 00 f0 bf 02 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 40 02 "
    "00 00 00 00 00 00 00 00 00 00 00 00 00 24 40 00 00 00 00 00 80 34 c0");
// the same without a frame and without velocities
const std::string kSome = bytes_of_hex(
    "00 01 00 00 00 f1 53 65 80 b2 e6 0e 01 00 00 00 00 00 00 00 02 00 00 00 03 00 00 00 6a 31 00 "
    "00 07 00 00 00 6a 6f 69 6e 74 32 00 00 02 00 00 00 00 00 00 00 00 00 00 00 00 00 e0 3f 00 00 "
    "00 00 00 00 f0 bf 00 00 00 00 02 00 00 00 00 00 00 00 00 00 24 40 00 00 00 00 00 80 34 c0");

SomeMessage message(unsigned nanoseconds, const Names& names, bool big = false) {
  return SomeMessage(big).stamp(5, nanoseconds).text("base").texts(names);
}

std::string one_joint(unsigned nanoseconds, double position, const std::string& name = "a") {
  return message(nanoseconds, {name}).numbers({position}).numbers({}).numbers({}).bytes();
}

class Bag : public Recording {
 protected:
  // one topic with these messages
  std::string with(const std::vector<std::string>& messages) const {
    return with_topic("/joint_states", "sensor_msgs/msg/JointState", "cdr", messages);
  }
  std::string with_topic(const std::string& name, const std::string& type,
                         const std::string& format,
                         const std::vector<std::string>& messages) const {
    put("", "x.db3");
    SomeBag bag(path("x.db3"));
    bag.make_tables();
    bag.add_topic(name, type, format);
    long long t = 0;
    for (const std::string& m : messages) bag.add_message(1, t += 500000000, m);
    return path("x.db3");
  }
  std::string error_of_opening(const std::string& file, const std::string& topic = "") const {
    const std::string error = error_of([&] { BagRows x(file, topic); });
    EXPECT_TRUE(error.starts_with(file + ": ")) << error;
    return error.substr(error.find(": ") + 2);
  }
};

void expect_rows(const Rows& is, const Rows& want) {
  ASSERT_EQ(is.size(), want.size());
  for (std::size_t k = 0; k < is.size(); ++k) {
    ASSERT_EQ(is[k].size(), want[k].size());
    for (std::size_t i = 0; i < is[k].size(); ++i) {
      const bool both_missing = std::isnan(is[k][i]) && std::isnan(want[k][i]);
      EXPECT_TRUE(both_missing || is[k][i] == want[k][i]) << k << " " << i << ": " << is[k][i];
    }
  }
}

TEST_F(Bag, AMessageIsARow) {
  BagRows rows(with({kAll, kSome}));
  EXPECT_EQ(rows.columns(), (Names{"t", "position.j1", "position.joint2", "velocity.j1",
                                   "velocity.joint2", "effort.j1", "effort.joint2"}));
  SkippedRows skipped;
  expect_rows(rows_of(rows, skipped), {{1700000000.25, 0.5, -1, 0, 2, 10, -20.5},
                                       {1700000000.25, 0.5, -1, NAN, NAN, 10, -20.5}});
  EXPECT_EQ(rows.number(), 2);
  EXPECT_EQ(skipped.total(), 0);
  EXPECT_TRUE(skipped.notes.empty());
}

// an arm of three joints whose first two are on one topic, and whose third is on another
TEST_F(Bag, SeveralTopicsAreReadAsOneAndJoined) {
  put("", "x.db3");
  {
    SomeBag bag(path("x.db3"));
    bag.make_tables();
    for (const char* topic : {"/left", "/right", "/grip"}) bag.add_topic(topic);
    for (unsigned k = 0; k < 20; ++k) {
      const auto add = [&](int topic, unsigned late, const Names& names, double x) {
        const std::vector<double> all(names.size(), x);
        const unsigned at = 10000000 * k + late;
        bag.add_message(topic, at,
                        message(at, names).numbers(all).numbers(all).numbers(all).bytes());
      };
      add(1, 0, {"a", "b"}, k);
      add(3, 500000, {"a", "b", "c"}, -1);
      add(2, 1000000, {"c"}, k + 0.5);
    }
  }
  const RecordingOptions options{
      put("preset = 'joint_state'\njoin = 0.002\n", "map.toml"), "/left,/right", {"a", "b", "c"}};
  SkippedRows skipped;
  const Trace t = read_recording(path("x.db3"), options, &skipped);
  ASSERT_EQ(t.size(), 20);
  EXPECT_EQ(skipped.total(), 0);
  for (int k = 0; k < t.size(); ++k) {
    EXPECT_EQ(t.q.col(k), Eigen::Vector3d(k, k, k + 0.5));
    EXPECT_EQ(t.tau.col(k), Eigen::Vector3d(k, k, k + 0.5));
  }
  EXPECT_NE(error_of([&] {
              read_recording(path("x.db3"), {"", "/left,/right", {"a", "b", "c"}}, &skipped);
            }).find("join = 0.005 in a map of columns"),
            std::string::npos);
  EXPECT_EQ(error_of_opening(path("x.db3"), "/left,/none"),
            "has no topic /none; it has /grip (sensor_msgs/msg/JointState), /left "
            "(sensor_msgs/msg/JointState), /right (sensor_msgs/msg/JointState)");
}

TEST_F(Bag, TheHighByteMayBeTheFirst) {
  const std::string big =
      message(750000000, {"a", "bc"}, true).numbers({1, 2}).numbers({3, 4}).numbers({5, 6}).bytes();
  expect_rows(rows_of(BagRows(with({big}))), {{5.75, 1, 2, 3, 4, 5, 6}});
}

TEST_F(Bag, TheNamesSayWhichJointANumberBelongsTo) {
  const std::string first =
      message(0, {"a", "b"}).numbers({1, 2}).numbers({}).numbers({3, 4}).bytes();
  const std::string turned =
      message(1, {"b", "a"}).numbers({1, 2}).numbers({5, 6}).numbers({3, 4}).bytes();
  const std::string with_others =
      message(2, {"grip", "b"}).numbers({1, 2}).numbers({}).numbers({}).bytes();
  const std::string others = message(3, {"grip"}).numbers({1}).numbers({}).numbers({}).bytes();
  BagRows rows(with({first, turned, with_others, others}));
  SkippedRows skipped;
  expect_rows(rows_of(rows, skipped), {{5, 1, 2, NAN, NAN, 3, 4},
                                       {5 + 1e-9, 2, 1, 6, 5, 4, 3},
                                       {5 + 2e-9, NAN, 2, NAN, NAN, NAN, NAN}});
  EXPECT_EQ(skipped.total(), 0);
  EXPECT_EQ(skipped.notes, (Names{"2 messages name other joints, which are left out: grip"}));
}

TEST_F(Bag, TheRobotsJointsAreFoundByNameInEveryMessage) {
  const auto of = [](int at, const Names& names, const std::vector<double>& x) {
    return message(at, names).numbers(x).numbers(x).numbers(x).bytes();
  };
  const std::string file =
      with({of(0, {"finger", "knuckle"}, {8, 9}), of(1, {"elbow", "finger", "hip"}, {2, 9, 1}),
            of(2, {"hip", "elbow"}, {1, 2})});
  BagRows rows(file, "", {"hip", "elbow"});
  SkippedRows skipped;
  expect_rows(rows_of(rows, skipped), {{5 + 1e-9, 1, 2, 1, 2, 1, 2}, {5 + 2e-9, 1, 2, 1, 2, 1, 2}});
  EXPECT_EQ(skipped.total(), 0);
  EXPECT_EQ(skipped.notes,
            (Names{"2 messages name other joints, which are left out: finger, knuckle"}));
}

TEST_F(Bag, AJointOfTheRobotThatNeverComesIsAnErrorWithBothLists) {
  const std::string file =
      with({message(0, {"b", "a"}).numbers({1, 2}).numbers({}).numbers({}).bytes(),
            message(1, {"grip"}).numbers({1}).numbers({}).numbers({}).bytes()});
  EXPECT_EQ(error_of([&] {
              BagRows x(file, "", {"a", "elbow", "b"});
            }),
            file +
                ": the messages on topic /joint_states never name elbow; the robot has a, elbow, "
                "b, and they name a, b, grip. Where a joint has another name there, --columns "
                "FILE.toml says which it is: [q] columns = [\"position.NAME\", ..], and [qd] and "
                "[tau_instant] likewise");
}

// as drivers begin: without efforts, then with NaN; a gripper's own never come
TEST_F(Bag, WhatIsThereIsDecidedByAllMessages) {
  const Names names{"a", "grip"};
  const std::string file =
      with({message(0, names).numbers({1, 2}).numbers({}).numbers({}).bytes(),
            message(1, names).numbers({1, 2}).numbers({}).numbers({NAN, 3}).bytes(),
            message(2, names).numbers({1, 2}).numbers({}).numbers({4, NAN}).bytes()});
  BagRows rows(file, "", {"a"});
  EXPECT_EQ(rows.columns(), (Names{"t", "position.a", "effort.a"}));
  SkippedRows skipped;
  expect_rows(rows_of(rows, skipped), {{5, 1, NAN}, {5 + 1e-9, 1, NAN}, {5 + 2e-9, 1, 4}});
}

// one text before all names, in the messages or in the robot's file
TEST_F(Bag, TheRobotsJointsAreFoundBehindAPrefix) {
  const std::string file = with({message(0, {"ur/b_joint", "ur/a", "grip"})
                                     .numbers({1, 2, 3})
                                     .numbers({})
                                     .numbers({})
                                     .bytes()});
  BagRows rows(file, "", {"a", "b_joint"});
  EXPECT_EQ(rows.columns()[1], "position.a");
  SkippedRows skipped;
  expect_rows(rows_of(rows, skipped), {{5, 2, 1}});
  EXPECT_EQ(skipped.notes[0], "its joints' names have the prefix 'ur/'");
  const std::string bare =
      with({message(0, {"b", "a"}).numbers({1, 2}).numbers({}).numbers({}).bytes()});
  expect_rows(rows_of(BagRows(bare, "", {"left_arm_a", "left_arm_b"})), {{5, 2, 1}});
  const std::string two = with({message(0, {"l_a", "l_b", "r_a", "r_b"})
                                    .numbers({1, 2, 3, 4})
                                    .numbers({})
                                    .numbers({})
                                    .bytes()});
  EXPECT_NE(error_of([&] {
              BagRows x(two, "", {"a", "b"});
            }).find("their names have the prefix 'l_', or they have the prefix 'r_'"),
            std::string::npos);
  EXPECT_NE(error_of([&] {
              BagRows x(two, "", {"a", "c"});
            }).find("never name a, c"),
            std::string::npos);
}

TEST_F(Bag, WhereNoStampIsGivenTheTimeOfRecordingIsTaken) {
  const auto unstamped = [](double q) {
    return SomeMessage().stamp(0, 0).text("").texts({"a"}).numbers({q}).numbers({}).numbers({});
  };
  const std::string one = unstamped(1).bytes(), two = unstamped(2).bytes();
  expect_rows(rows_of(BagRows(with({one, two}))), {{0.5, 1}, {1, 2}});
  expect_rows(rows_of(BagRows(with({one, one_joint(0, 3)}))), {{0, 1}, {5, 3}});
}

TEST_F(Bag, MessagesComeInTheOrderInWhichTheyWereRecorded) {
  {
    put("", "y.db3");
    SomeBag bag(path("y.db3"));
    bag.make_newer_tables();
    bag.run("PRAGMA journal_mode = WAL");  // as the preset "resilient" does
    bag.add_topic("/tf", "tf2_msgs/msg/TFMessage");
    bag.add_topic("/arm");
    bag.add_message(2, 30, one_joint(3, 3));
    bag.add_message(2, 10, one_joint(1, 1));
    bag.add_message(1, 15, "no joint state");
    bag.add_message(2, 20, one_joint(2, 2));
  }
  const Rows r = rows_of(BagRows(path("y.db3"), "/arm"));
  ASSERT_EQ(r.size(), 3u);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(r[k][1], k + 1);
  std::set<std::string> beside;
  for (const auto& e : std::filesystem::directory_iterator(folder_)) {
    beside.insert(e.path().filename().string());
  }
  EXPECT_EQ(beside, std::set<std::string>{"y.db3"});  // nothing was written
}

TEST_F(Bag, MessagesThatCannotBeReadAreSkippedAndCounted) {
  const std::vector<std::pair<std::string, std::string>> bad = {
      {kAll.substr(0, 100), "it is cut off"},
      {"", "it is cut off"},
      {std::string("\0\3\0\0", 4) + kAll.substr(4), "it is no plain CDR"},
      {"\x28\xB5\x2F\xFD" + kAll,
       "it is compressed: write the bag without compression by ros2 bag convert"},
      {std::string(1 << 20, '\0') + "x", "it is longer than 1 MB"},
      {message(0, {}).numbers({}).numbers({}).numbers({}).bytes(), "it names no joint"},
      {message(0, {"a", "a"}).bytes(), "it names a joint twice"},
      {message(0, {"a"}).numbers({1, 2}).bytes(), "it has not as many numbers as names"},
      {message(0, {"a"}).numbers({1}).numbers({}).number(0xFFFFFFFF, 4).bytes(),
       "it has not as many numbers as names"},
      {SomeMessage().stamp(5, 0).text("").number(65, 4).bytes(), "it has more than 64 joints"},
      {SomeMessage().stamp(5, 0).number(0xFFFFFFFF, 4).bytes(), "it is cut off"}};
  for (const auto& [bytes, why] : bad) {
    BagRows rows(with({one_joint(0, 1), bytes, one_joint(1, 2)}));
    SkippedRows skipped;
    EXPECT_EQ(rows_of(rows, skipped).size(), 2u) << why;
    EXPECT_EQ(skipped.wrong_field_count, 1);
    EXPECT_EQ(skipped.first, Names{"message 2: " + why});
    EXPECT_EQ(error_of_opening(with({bytes})),
              "no message on topic /joint_states can be read; of the first: " + why);
  }
}

TEST_F(Bag, ATopicIsChosenByItsName) {
  put("", "x.db3");
  {
    SomeBag bag(path("x.db3"));
    bag.make_tables();
    bag.add_topic("/left");
    bag.add_topic("/right", "sensor_msgs/JointState");
    bag.add_topic("/tf", "tf2_msgs/msg/TFMessage");
    bag.add_message(1, 1, one_joint(0, 1));
    bag.add_message(2, 2, one_joint(0, 2));
  }
  const std::string file = path("x.db3");
  EXPECT_EQ(rows_of(BagRows(file, "/right"))[0][1], 2);
  EXPECT_EQ(error_of_opening(file),
            "choose one of its topics, or several apart by commas (--channel): /left "
            "(sensor_msgs/msg/JointState), /right (sensor_msgs/JointState)");
  EXPECT_EQ(error_of_opening(file, "/middle"),
            "has no topic /middle; it has /left (sensor_msgs/msg/JointState), /right "
            "(sensor_msgs/JointState), /tf (tf2_msgs/msg/TFMessage)");
}

TEST_F(Bag, ErrorsNameTheRemedy) {
  EXPECT_EQ(
      error_of_opening(with_topic("/tf", "tf2_msgs/msg/TFMessage", "cdr", {})),
      "has no topic of sensor_msgs/msg/JointState, or of another type that a preset reads; it "
      "has /tf (tf2_msgs/msg/TFMessage)");
  EXPECT_EQ(
      error_of_opening(with_topic("/a", "sensor_msgs/msg/JointState", "fory", {})),
      "topic /a is serialized as 'fory', and not as 'cdr' or 'json': write it anew by ros2 bag "
      "convert");
  EXPECT_EQ(error_of_opening(with({})),
            "no message on topic /joint_states can be read; of the first: there is none");
  EXPECT_EQ(error_of_opening(put("t,q1\n", "x.csv")),
            "begins as no bag of ROS 2 does (.db3, .mcap)");
  EXPECT_EQ(error_of_opening(path("none")), "No such file or directory");
  const std::string file = with({kAll}), wal = put("x", "x.db3-wal");
  EXPECT_EQ(error_of_opening(file),
            fmt::format("was not closed, and {} holds a part of it: bring them together by sqlite3 "
                        "{} 'PRAGMA quick_check'",
                        wal, file));
}

// made by a program of its own, by mcap.dev/spec, zstd and lz4
TEST_F(Bag, OfTheStorageMcapIsRead) {
  const Rows want = {{100, 2, 1, 0.25, 0.5, 20, 10},
                     {101, 3, 1, 0.25, 0.5, 20, 10},
                     {102, 2, 2, 0.25, 0.5, 20, 20},
                     {103, 3, 2, 0.25, 0.5, 20, 20}};
  for (const std::string kind : {"plain", "zstd", "lz4"}) {
    const std::string bytes = get(fixture("chunks_" + kind + ".mcap"));
    expect_rows(rows_of(BagRows(put(bytes, "x.mcap"), "", {"a", "b"})), want);
    // without its summary, and within the second chunk
    for (const std::size_t size : {bytes.size() - 8, bytes.size() - 400}) {
      BagRows cut(put(bytes.substr(0, size), "cut.mcap"), "", {"a", "b"});
      SkippedRows skipped;
      const Rows rows = rows_of(cut, skipped);
      expect_rows(rows, Rows(want.begin(), want.begin() + static_cast<long>(rows.size())));
      EXPECT_EQ(rows.size(), size == bytes.size() - 8 ? 4U : 2U) << kind;
      EXPECT_EQ(skipped.notes.size(), rows.size() < 4 ? 1U : 0U) << kind;
    }
  }
  std::string wrong = get(fixture("chunks_plain.mcap"));
  wrong[wrong.find("/chatter") + 60] ^= 1;
  EXPECT_EQ(error_of_opening(put(wrong, "wrong.mcap")),
            "is damaged: the bytes of a chunk do not have its checksum; `mcap recover` makes a "
            "file of what is whole");
  const int readable = beginnings_that_can_be_read<BagRows>(get(fixture("chunks_zstd.mcap")));
  EXPECT_GT(readable, 100);
}

// of a file of MCAP the kinds of its records, and where the first begins and each ends, by
// mcap.dev/spec: a byte, and how many bytes follow, as 8
struct McapRecords {
  std::vector<std::size_t> ends = {8};
  std::vector<int> kinds;
};

McapRecords records_of(const std::string& bytes) {
  constexpr std::size_t kHeadSize = 9;
  McapRecords r;
  while (r.kinds.empty() || r.kinds.back() != 15) {
    std::size_t size = 0;
    for (std::size_t i = 8; i > 0; --i)
      size = size << 8 | static_cast<unsigned char>(bytes[r.ends.back() + i]);
    r.kinds.push_back(bytes[r.ends.back()]);
    r.ends.push_back(r.ends.back() + kHeadSize + size);
  }
  return r;
}

TEST_F(Bag, OfTheStorageMcapIsReadUpToAChunkThatIsDamaged) {
  for (const std::string kind : {"plain", "zstd", "lz4"}) {
    const std::string bytes = get(fixture("chunks_" + kind + ".mcap"));
    const auto [ends, kinds] = records_of(bytes);
    const auto chunk = std::find(kinds.begin(), kinds.end(), 6);
    const auto second = std::find(chunk + 1, kinds.end(), 6);
    const std::size_t first_end = ends.at(static_cast<std::size_t>(chunk - kinds.begin()) + 1),
                      begin = ends.at(static_cast<std::size_t>(second - kinds.begin())),
                      end = ends.at(static_cast<std::size_t>(second - kinds.begin()) + 1);
    std::string zeros = bytes.substr(0, end - 30);
    zeros.resize(bytes.size());
    std::vector<std::string> damaged = {zeros};
    for (const std::size_t at : {end - 12, end - 40, begin + 9 + 16}) {  // the last: its size
      damaged.push_back(bytes);
      damaged.back()[at] ^= 0x55;
    }
    for (const std::string& one : damaged) {
      BagRows rows(put(one, "damaged.mcap"), "", {"a", "b"});
      SkippedRows skipped;
      EXPECT_EQ(rows_of(rows, skipped).size(), 2U) << kind;
      ASSERT_EQ(skipped.notes.size(), 1U) << kind;
      EXPECT_TRUE(skipped.notes[0].starts_with(
          fmt::format("the last {} of its {} bytes are not read: a chunk ", bytes.size() - begin,
                      bytes.size())))
          << skipped.notes[0];
      EXPECT_TRUE(
          skipped.notes[0].ends_with("; `mcap recover` makes a file of what is whole; 2 "
                                     "messages were read, the last of t = 101.000 s"))
          << skipped.notes[0];
    }
    std::string none = bytes;
    none[first_end - 12] ^= 0x55;
    const std::string error = error_of_opening(put(none, "none.mcap"));
    EXPECT_TRUE(error.ends_with("; `mcap recover` makes a file of what is whole")) << error;
  }
}

TEST_F(Bag, OfTheStorageMcapThatIsCutOffSaysWhatIsLeft) {
  constexpr std::size_t kHeadSize = 9;
  const std::string bytes = get(fixture("chunks_plain.mcap"));
  const auto [ends, kinds] = records_of(bytes);
  std::size_t chunks = 0;
  for (std::size_t r = 0; r + 1 < kinds.size(); ++r) {
    chunks += kinds[r] == 6 ? 1 : 0;
    if (chunks == 0) continue;
    const std::string end = chunks == 1 ? "; 2 messages were read, the last of t = 101.000 s"
                                        : "; 4 messages were read, the last of t = 103.000 s";
    const auto note = [&](const std::string& cut) {
      BagRows rows(put(cut, "cut.mcap"), "", {"a", "b"});
      SkippedRows skipped;
      EXPECT_EQ(rows_of(rows, skipped).size(), 2 * chunks) << r;
      return skipped.notes.at(0);
    };
    const std::string whole = bytes.substr(0, ends[r + 1]);
    EXPECT_EQ(note(whole), "it was not closed, so its last messages may be missing" + end);
    const std::size_t next = ends[r + 2] - ends[r + 1];
    for (const std::size_t more : {std::size_t{1}, kHeadSize, next - 1})
      EXPECT_EQ(note(bytes.substr(0, whole.size() + more)),
                fmt::format("it ends too early: the last {} of its {} bytes are no whole record, "
                            "and are not read",
                            more, whole.size() + more) +
                    end);
    for (const std::size_t zeros : {5U, 90U, 4096U})  // as after a power cut
      EXPECT_NE(note(whole + std::string(zeros, '\0')).find(fmt::format("the last {} of", zeros)),
                std::string::npos);
  }
  EXPECT_EQ(chunks, 2U);
  EXPECT_EQ(error_of_opening(put(bytes.substr(0, ends[1] + 50), "cut.mcap")),
            fmt::format("it ends too early: the last 50 of its {} bytes are no whole record, and "
                        "are not read",
                        ends[1] + 50));
}

TEST_F(Bag, ADatabaseThatComputesIsNone) {
  put("", "x.db3");
  {
    SomeBag bag(path("x.db3"));
    bag.make_tables();
    bag.add_topic("/a");
    bag.run("DROP TABLE messages");
    bag.run(
        "CREATE VIEW messages AS WITH RECURSIVE r(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM r)"
        " SELECT n AS id, 1 AS topic_id, n AS timestamp, x'00' AS data FROM r");
  }
  EXPECT_EQ(error_of_opening(path("x.db3")),
            "is no bag of ROS 2: it lacks the tables topics and messages");
}

TEST_F(Bag, ItsPathMayHaveAnyCharacter) {
  const std::string odd = path("a b?mode=rw#%41'\xC3\xA9.db3");
  std::filesystem::rename(with({kAll}), odd);
  EXPECT_EQ(rows_of(BagRows(odd)).size(), 1u);
}

TEST_F(Bag, ADamagedFileEndsInAnError) {
  const std::string bytes = get(with({kAll, kSome, kAll, kSome, kAll, one_joint(1, 2), kSome}));
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    const std::string file = put(bytes.substr(0, n), "y.db3");
    const std::string error = error_of([&] { rows_of(BagRows(file)); });
    EXPECT_TRUE(error.starts_with(file + ": ")) << n << " of " << bytes.size() << ": " << error;
  }
  EXPECT_EQ(
      error_of_opening(put(bytes.substr(0, bytes.size() - 1), "y.db3")),
      fmt::format("is cut off: {} of {} bytes; sqlite3 {} .dump | sed 's/^ROLLBACK.*/COMMIT;/' "
                  "| sqlite3 whole.db3 saves what SQLite still finds in it",
                  bytes.size() - 1, bytes.size(), path("y.db3")));
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 0xFF);
    const std::string file = put(changed, "y.db3");  // whatever becomes of it, it ends
    error_of([&] { rows_of(BagRows(file)); });
  }
}

TEST_F(Bag, AMessageIsRefusedWhereverItEnds) {
  for (const std::string& whole : {kAll, kSome}) {
    RosType type("sensor_msgs/msg/JointState");
    MessageNumbers to;
    EXPECT_EQ(type.read(whole, to), nullptr);
    EXPECT_EQ(type.read(whole + std::string(3, '\0'), to), nullptr);
    for (std::size_t n = 0; n < whole.size(); ++n) {
      const std::vector<char> exact(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n));
      EXPECT_STREQ(type.read({exact.data(), n}, to), "it is cut off") << n;
    }
  }
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
// Bags in several files, and compressed ones: packed.db3.zst holds three messages of two joints,
// and packed.mcap.zst is chunks_plain.mcap, as the program zstd packs them.
#include "mjcf/trace/read/bag/parts.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <string>
#include <vector>

#include "mjcf/trace/read/bag/bag_rows.h"
#include "mjcf/trace/read/recording.h"
#include "mjcf/trace/read/test/recording.h"
#include "mjcf/trace/read/test/some_bag.h"

namespace tauext::test {
namespace {

namespace fs = std::filesystem;

class Parts : public Recording {
 protected:
  Parts() { fs::create_directories(path("bag")); }

  // a part with a message of one joint at each of these times
  void put_part(const std::string& name, const std::vector<unsigned>& times,
                const std::string& topic = "/joint_states") const {
    SomeBag bag(path("bag/" + name));
    bag.make_tables();
    bag.add_topic(topic);
    for (const unsigned t : times)
      bag.add_message(1, t,
                      SomeMessage()
                          .stamp(t, 0)
                          .text("")
                          .texts({"a"})
                          .numbers({0.5 * t})
                          .numbers({0})
                          .numbers({1})
                          .bytes());
  }
  // as rosbag2 writes it
  void put_metadata(const std::string& list) const {
    put("rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n" + list +
            "  duration:\n    nanoseconds: 5\n",
        "bag/metadata.yaml");
  }
  std::vector<double> times() const {
    std::vector<double> all;
    for (const auto& row : rows_of(BagRows(path("bag")))) all.push_back(row[0]);
    return all;
  }
};

TEST_F(Parts, FollowEachOtherAsTheMetadataListsThem) {
  put_part("x_1.db3", {3, 4});
  put_part("x_0.db3", {1, 2});
  put_part("y.db3", {9});
  put_metadata("  relative_file_paths:\n    - x_0.db3\n    - \"x_1.db3\"\n");
  EXPECT_EQ(times(), (std::vector<double>{1, 2, 3, 4}));
  SkippedRows skipped;
  const Trace t = read_recording(path("bag"), {}, &skipped);
  EXPECT_EQ(t.t, (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(t.q(0, 3), 2);
  put_metadata("  relative_file_paths:\n    - bag/x_1.db3\n");  // as the first ROS 2 did
  EXPECT_EQ(times(), (std::vector<double>{3, 4}));
}

TEST_F(Parts, WithoutMetadataAreInTheOrderOfTheirNumbers) {
  put_part("x_10.db3", {3});
  put_part("x_2.db3", {2});
  put_part("x_1.db3", {1});
  put_part("x_3.db3", {7}, "/others");  // no such topic
  const std::string file = path("bag");
  EXPECT_EQ(error_of([&] { BagRows x(file); }),
            file +
                ": choose one of its topics, or several apart by commas (--channel): /joint_states "
                "(sensor_msgs/msg/JointState), "
                "/others (sensor_msgs/msg/JointState)");
  std::vector<double> all;
  for (const auto& row : rows_of(BagRows(file, "/joint_states"))) all.push_back(row[0]);
  EXPECT_EQ(all, (std::vector<double>{1, 2, 3}));
}

TEST_F(Parts, ThatAreMissingOrDamagedAreNamed) {
  const std::string file = path("bag");
  EXPECT_EQ(error_of([&] { BagRows x(file); }),
            file + ": is a folder without a file of a bag (.db3, .mcap)");
  put_part("x_0.db3", {1, 2});
  put_metadata("  relative_file_paths:\n    - x_0.db3\n    - x_1.db3\n");
  EXPECT_EQ(error_of([&] { BagRows x(file); }),
            file + ": metadata.yaml names the part x_1.db3, which is not there");
  put("SQLite", "bag/x_1.db3");
  EXPECT_EQ(error_of([&] { BagRows x(file); }),
            file + "/x_1.db3: begins as no bag of ROS 2 does (.db3, .mcap)");
}

TEST_F(Parts, ThatAreCompressedAreReadAndLeaveNothingBehind) {
  const std::string before = std::getenv("TMPDIR") == nullptr ? "" : std::getenv("TMPDIR");
  fs::create_directories(path("empty"));
  ::setenv("TMPDIR", path("empty").c_str(), 1);
  EXPECT_EQ(rows_of(BagRows(fixture("packed.db3.zst"))), (Rows{{100, 1, 2, 0.5, 0.25, 10, 20},
                                                               {101, 2, 2, 0.5, 0.25, 10, 20},
                                                               {102, 3, 2, 0.5, 0.25, 10, 20}}));
  EXPECT_EQ(rows_of(BagRows(fixture("packed.mcap.zst"), "", {"a", "b"})),
            rows_of(BagRows(fixture("chunks_plain.mcap"), "", {"a", "b"})));
  put(get(fixture("packed.db3.zst")), "bag/x_0.db3.zstd");
  put_metadata("  relative_file_paths:\n    - x_0.db3.zstd\n");
  EXPECT_EQ(times(), (std::vector<double>{100, 101, 102}));
  SkippedRows skipped;
  EXPECT_EQ(read_recording(fixture("packed.db3.zst"), {}, &skipped).size(), 3);
  const std::string bytes = get(fixture("packed.db3.zst"));
  for (std::size_t n = 4; n < bytes.size(); n += 11) {
    const std::string file = put(bytes.substr(0, n), "cut.db3.zst");
    const std::string error = error_of([&] { rows_of(BagRows(file)); });
    EXPECT_TRUE(error.starts_with(file + ": ")) << error;
    EXPECT_TRUE(error.ends_with("; zstd -dc " + file + " > part.db3 gets what is before that"))
        << n << ": " << error;
  }
  EXPECT_TRUE(fs::is_empty(path("empty")));
  fs::remove(path("empty"));
  const std::string error = error_of([&] { BagRows x(fixture("packed.db3.zst")); });
  EXPECT_NE(error.find("TMPDIR"), std::string::npos) << error;
  before.empty() ? ::unsetenv("TMPDIR") : ::setenv("TMPDIR", before.c_str(), 1);
}

}  // namespace
}  // namespace tauext::test

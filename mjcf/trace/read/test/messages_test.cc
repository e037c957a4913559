// SPDX-License-Identifier: Apache-2.0
// Messages of types whose definition is in the bag. states.mcap was written by a program of its own
// in Python, by the rules of OMG's standard and mcap.dev/spec: two messages each on /franka,
// /franka_old, /lbr (the high byte first) and /legs (the second one too).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "mjcf/trace/read/bag/bag_rows.h"
#include "mjcf/trace/read/bag/message_type.h"
#include "mjcf/trace/read/recording.h"
#include "mjcf/trace/read/test/recording.h"
#include "mjcf/trace/read/test/some_bag.h"

namespace tauext::test {
namespace {

using Names = std::vector<std::string>;

const std::string kStates = "mjcf/trace/read/test/states.mcap";

Trace read_topic(const std::string& topic, SkippedRows& skipped, const std::string& columns = "",
                 const Names& joints = {}) {
  return read_recording(kStates, {columns, topic, joints}, &skipped);
}

Names joints_called(const std::string& begin) {
  Names names;
  for (int j = 1; j <= 7; ++j) names.push_back(fmt::format("{}{}", begin, j));
  return names;
}

// joint j was at j + t / 2 rad, where t is the time since the first message, with 10 j N m
void expect_states(const Trace& t, bool has_velocity) {
  EXPECT_EQ(t.t, (std::vector<double>{100, 100.25}));
  ASSERT_EQ(t.dof(), 7);
  for (int k = 0; k < 2; ++k)
    for (int j = 1; j <= 7; ++j) {
      EXPECT_EQ(t.q(j - 1, k), j + k / 8.);
      EXPECT_TRUE(t.qd(j - 1, k) == -j || !has_velocity);
      EXPECT_EQ(t.tau(j - 1, k), 10 * j);
      EXPECT_EQ(t.tau_ext_of_driver(j - 1, k), j / 4.);
    }
  EXPECT_TRUE(t.torque_at_instants);
}

class Messages : public Recording {};

TEST_F(Messages, OfFrankaAreReadByTheirJointsNames) {
  SkippedRows skipped;
  for (const char* begin : {"arm_joint", "joint"}) {  // in the message 2, 1, 3, ..
    skipped = {};
    expect_states(read_topic("/franka", skipped, "", joints_called(begin)), true);
    EXPECT_EQ(skipped.total(), 0);
  }
  EXPECT_EQ(skipped.notes, Names{"its joints' names have the prefix 'arm_'"});
  EXPECT_EQ(read_topic("/franka", skipped).q(0, 0), 2);  // in the message's order, which is said
  EXPECT_EQ(skipped.notes.size(), 1U);
}

TEST_F(Messages, OfOlderFrankaAndOfKukaAreReadByTheirNumbers) {
  SkippedRows skipped;
  expect_states(read_topic("/franka_old", skipped, "", joints_called("any")), true);
  EXPECT_TRUE(skipped.notes.empty());
  expect_states(read_topic("/lbr", skipped), false);
  ASSERT_EQ(skipped.notes.size(), 1U);
  EXPECT_TRUE(skipped.notes[0].starts_with("no qd: it is made of q")) << skipped.notes[0];
}

TEST_F(Messages, OfAnyTypeHaveColumnsByTheirPaths) {
  BagRows rows(kStates, "/legs");
  EXPECT_EQ(rows.columns(), (Names{"t",
                                   "on",
                                   "big",
                                   "three[0]",
                                   "three[1]",
                                   "three[2]",
                                   "few[0]",
                                   "few[1]",
                                   "pairs[0].a",
                                   "pairs[0].b",
                                   "small",
                                   "motor[0].mode",
                                   "motor[1].mode",
                                   "motor[0].q",
                                   "motor[1].q",
                                   "motor[0].dq",
                                   "motor[1].dq",
                                   "motor[0].tau_est",
                                   "motor[1].tau_est",
                                   "tick_ms"}));
}

TEST_F(Messages, OfAnyTypeAreReadByAMap) {
  put("[t]\ncolumns = ['tick_ms']\nunit = 'ms'\n[q]\ncolumns = 'motor\\[(\\d+)\\]\\.q'\n"
      "[qd]\ncolumns = 'motor\\[(\\d+)\\]\\.dq'\n[tau]\ncolumns = 'motor\\[(\\d+)\\]\\.tau_est'\n",
      "legs.toml");
  SkippedRows skipped;
  const Trace t = read_topic("/legs", skipped, path("legs.toml"));
  EXPECT_EQ(t.t, (std::vector<double>{1, 1.25}));
  EXPECT_EQ(t.q, (Eigen::Matrix2d{{1.5, 2.5}, {2.5, 3.5}}));
  EXPECT_EQ(t.qd, (Eigen::Matrix2d{{-0.5, -0.5}, {0.25, 0.25}}));
  EXPECT_EQ(t.tau, (Eigen::Matrix2d{{4, 4}, {8, 8}}));
  EXPECT_NE(error_of([&] { read_topic("/legs", skipped); }).find("--columns says which it is"),
            std::string::npos);
}

TEST_F(Messages, ATopicMustBeNamedWhereSeveralFit) {
  SkippedRows skipped;
  EXPECT_EQ(error_of([&] { read_topic("", skipped); }),
            kStates +
                ": choose one of its topics, or several apart by commas (--channel): "
                "/franka (franka_msgs/msg/FrankaRobotState), "
                "/franka_old (franka_msgs/msg/FrankaState), /lbr (lbr_fri_idl/msg/LBRState)");
}

// of a type with these lines
std::string error_of_type(const std::string& definition) {
  return error_of([&] { RosType("a/msg/A", definition); });
}

TEST(RosType, ADefinitionThatIsNoneIsAnErrorThatNamesIt) {
  const std::string inner = "\n====\nMSG: a/B\n";
  for (const auto& [definition, error] : std::vector<std::pair<std::string, std::string>>{
           {"B b" + inner + "c/D d\n",
            "its definition needs the type c/D, which it does not define"},
           {"B b" + inner + "A[] a\n", "its definition has the type a/A within itself"},
           {"B b" + inner + "wstring w\n", "its definition has a wstring, which is not read: w"},
           {"B b" + inner + "int8 x\n" + inner + "int9 x\n", "the type a/B is defined in two ways"},
           {"B b\nIDL: a/B\nmodule a {}\n", "a/B is defined in IDL, which is not read"},
           {"float64[0] x", "the definition of a/A has a line that is no field: 'float64[0] x'"},
           {"float64[99999999999] x",
            "the definition of a/A has a line that is no field: 'float64[99999999999] x'"},
           {"float64", "the definition of a/A has a line that is no field: 'float64'"},
           {"\x01\xff x", "the definition of a/A has a line that is no field: '?? x'"}})
    EXPECT_EQ(error_of_type(definition), error);
}

// twelve structures, each of ten arrays of the next one; and thirty in each other
TEST(RosType, ADefinitionThatGrowsWithoutEndIsAnError) {
  std::string wide, deep;
  for (int i = 0; i < 12; ++i) {
    if (i > 0) wide += fmt::format("MSG: a/B{}\n", i);
    for (int k = 0; k < 10; ++k) wide += fmt::format("B{}[3] x{}\n", i + 1, k);
  }
  for (int i = 0; i < 30; ++i)
    deep += fmt::format("{}B{} x\n", i == 0 ? "" : fmt::format("MSG: a/B{}\n", i), i + 1);
  const std::string error = error_of_type(wide + "MSG: a/B12\nbool x\n");
  EXPECT_TRUE(error.starts_with("its definition has too many fields in a/B")) << error;
  EXPECT_EQ(error_of_type(deep + "MSG: a/B30\nbool x\n"),
            "its definition has too many structures in a/B20");
}

TEST(RosType, ReadsAsManyBytesAsThereAre) {
  RosType type("a/msg/A",
               "string[<=2] joint_names\nfloat64[] effort\nB[] all\nbool[2000000000] x\n"
               "MSG: a/B\nC c\nint16[3] e\nMSG: a/C\n");
  MessageNumbers to;
  const std::string begin =
      SomeMessage().texts({"a", "b"}).numbers({1, 2}).number(4000000000, 4).bytes();
  for (std::size_t n = 4; n < 5000; n += n < 80 ? 1 : 100) {
    std::string some = begin;
    some.resize(n, '\1');
    const std::vector<char> exact(some.begin(), some.end());
    EXPECT_STREQ(type.read({exact.data(), n}, to), "it is cut off") << n;
  }
}

TEST(RosType, WhatItsDefinitionDoesNotSayIsNotBelieved) {
  RosType type("a/A", "float64 x");
  MessageNumbers to;
  EXPECT_EQ(type.read(SomeMessage().number(0, 8).number(0, 8).bytes(), to), nullptr);
  EXPECT_EQ(type.read(SomeMessage().number(0, 8).number(0, 8).number(0, 1).bytes(), to),
            std::string("it is longer than its definition says"));
}

TEST_F(Messages, InADatabaseNeedTheirDefinition) {
  const auto put_bag = [&](const std::string& language, bool with_definitions) {
    put("", "x.db3");
    SomeBag bag(path("x.db3"));
    with_definitions ? bag.make_newer_tables() : bag.make_tables();
    bag.add_topic("/tf", "tf2_msgs/msg/TFMessage");
    bag.add_topic("/a", "own/msg/Torques");
    if (with_definitions)
      bag.run(
          "INSERT INTO message_definitions(topic_type,encoding,encoded_message_definition,"
          "type_description_hash) VALUES ('own/msg/Torques','" +
          language + "','float64[] tau','')");
    bag.add_message(1, 5, "no torques");
    for (const double x : {0.5, 1.5})
      bag.add_message(2, 1000000000, SomeMessage().numbers({x}).bytes());
    return path("x.db3");
  };
  EXPECT_EQ(rows_of(BagRows(put_bag("ros2msg", true), "/a")), (Rows{{1, 0.5}, {1, 1.5}}));
  for (const auto& [language, words] :
       {std::pair{"ros2idl", "/a, own/msg/Torques: its type is defined in 'ros2idl', and not in"},
        std::pair{"", "/a, own/msg/Torques: the bag has no definition of its type, as those of"}}) {
    const std::string file = put_bag(language, *language != 0);
    const std::string error = error_of([&] { BagRows x(file, "/a"); });
    EXPECT_TRUE(error.starts_with(file + ": topic " + words)) << error;
  }
}

// whatever becomes of it, it ends
TEST_F(Messages, ThatAreDamagedEnd) {
  const std::string bytes = get(kStates);
  int readable = 0;
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 0x7F);
    const std::string file = put(changed, "y.mcap");
    const std::string error = error_of([&] { rows_of(BagRows(file, "/franka")); });
    EXPECT_TRUE(error == "no error" || error.starts_with(file + ": ")) << error;
    readable += error == "no error" ? 1 : 0;
  }
  EXPECT_GT(readable, 100);
}

}  // namespace
}  // namespace tauext::test

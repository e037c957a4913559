// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/layout_writer.h"

#include <sqlite3.h>

#include "mjcf/trace/input_file.h"
#include "mjcf/trace/read/recording.h"
#include "mjcf/trace/read/test/recording.h"
#include "mjcf/trace/read/test/some_bag.h"

namespace tauext::test {
namespace {

class Layouts : public Recording {
 protected:
  // two joints, two samples
  Layouts() {
    trace_.t = {0, 0.008};
    trace_.q = (Eigen::MatrixXd(2, 2) << 0.1, 0.2, -1.5, 1.25).finished();
    trace_.qd = trace_.q * 2;
    trace_.tau = trace_.q * 100;
    trace_.tau_ext = trace_.q;
    trace_.contact = {0, 1};
  }
  std::string written(const std::string& layout, const std::string& name) const {
    write_layout(trace_, layout, Eigen::Vector2d(10, 5), {}, path(name));
    return read_whole(path(name));
  }
  Trace read(const std::string& columns, const std::string& name) const {
    SkippedRows skipped;
    return read_recording(path(name), {.columns = columns}, &skipped);
  }
  Trace trace_;
};

TEST_F(Layouts, OfLibfrankaIsThatOfItsLogToCsv) {
  EXPECT_EQ(written("libfranka", "f.csv"),
            "time,success_rate,state.q[0],state.q[1],state.dq[0],state.dq[1],state.tau_J[0],"
            "state.tau_J[1],contact\n"
            "125000,1,0.1,-1.5,0.2,-3,10,-150,0\n125008,1,0.2,1.25,0.4,2.5,20,125,1\n");
  const Trace back = read("libfranka", "f.csv");
  EXPECT_EQ(back.q, trace_.q);
  EXPECT_EQ(back.tau, trace_.tau);
  EXPECT_TRUE(back.torque_at_instants);
  EXPECT_NEAR(back.t[1] - back.t[0], 0.008, 1e-9);
}

TEST_F(Layouts, OfRtdeHasCurrentsAndBlanks) {
  EXPECT_EQ(written("ur_rtde", "u.csv"),
            "timestamp actual_q_0 actual_q_1 actual_qd_0 actual_qd_1 actual_current_0 "
            "actual_current_1 contact\n"
            "4021.500 0.1 -1.5 0.2 -3 1 -30 0\n4021.508 0.2 1.25 0.4 2.5 2 25 1\n");
  EXPECT_TRUE(read("ur_rtde", "u.csv").tau_is_current);
  EXPECT_NE(error_of([&] {
              write_layout(trace_, "ur_rtde", Eigen::Vector2d(10, 0), {}, path("x.csv"));
            }).find("must say the `gain` of each drive"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(path("x.csv")));
}

TEST_F(Layouts, OfABagIsCdrByTheBook) {
  write_layout(trace_, "joint_state", {}, {}, path("b.db3"));
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(path("b.db3").c_str(), &db), SQLITE_OK);
  sqlite3_stmt* s = nullptr;
  ASSERT_EQ(sqlite3_prepare_v2(db,
                               "SELECT messages.timestamp, data, name, type FROM messages JOIN "
                               "topics ON topic_id = topics.id ORDER BY messages.id",
                               -1, &s, nullptr),
            SQLITE_OK);
  ASSERT_EQ(sqlite3_step(s), SQLITE_ROW);
  ASSERT_EQ(sqlite3_step(s), SQLITE_ROW);
  EXPECT_EQ(sqlite3_column_int64(s, 0), 1'700'000'000'008'000'000);
  const std::string data(static_cast<const char*>(sqlite3_column_blob(s, 1)),
                         static_cast<std::size_t>(sqlite3_column_bytes(s, 1)));
  SomeMessage wanted;
  wanted.stamp(1'700'000'000, 8'000'000).text("base").texts({"joint1", "joint2"});
  EXPECT_EQ(data, wanted.numbers({0.2, 1.25}).numbers({0.4, 2.5}).numbers({20, 125}).bytes());
  EXPECT_STREQ(reinterpret_cast<const char*>(sqlite3_column_text(s, 2)), "/joint_states");
  EXPECT_STREQ(reinterpret_cast<const char*>(sqlite3_column_text(s, 3)),
               "sensor_msgs/msg/JointState");
  sqlite3_finalize(s);
  sqlite3_close(db);
  EXPECT_EQ(read("", "b.db3").tau, trace_.tau);
}

TEST_F(Layouts, OfNobodyListsTheKnownOnes) {
  EXPECT_NE(error_of([&] { written("abb", "x.csv"); }).find("unknown layout 'abb'; known: "),
            std::string::npos);
}

}  // namespace
}  // namespace tauext::test

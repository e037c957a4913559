// SPDX-License-Identifier: Apache-2.0
// Recordings as other people's programs write them; the layouts are those of their sources.
#include "mjcf/trace/read/column_map.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "mjcf/test/error_of.h"
#include "mjcf/trace/read/recording.h"

namespace tauext::test {
namespace {

namespace fs = std::filesystem;

class Columns : public testing::Test {
 protected:
  Columns() : folder_(fs::temp_directory_path() / fmt::format("tauext_columns_{}", ::getpid())) {
    fs::create_directories(folder_);
  }
  ~Columns() override { fs::remove_all(folder_); }

  std::string put(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }
  Trace read(const std::string& text, const std::string& map) {
    skipped_ = {};
    return read_recording(put("log.csv", text), {.columns = map, .joints = joints_}, &skipped_,
                          &regularity_);
  }
  // with a map of these lines
  Trace read_by(const std::string& text, const std::string& toml) {
    return read(text, put("map.toml", toml));
  }
  std::string error_of_map(const std::string& toml, const std::string& text = "a,b\n1,2\n") {
    return error_of([&] { read_by(text, toml); });
  }
  static void expect_says(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  }

  fs::path folder_;
  std::vector<std::string> joints_;  // of the robot; empty: unknown
  SkippedRows skipped_;
  Regularity regularity_;
};

// "x[0]<between>x[1].." of seven
std::string seven(const std::string& name, const std::string& between = ",") {
  std::string all;
  for (int i = 0; i < 7; ++i) all += fmt::format("{}{}[{}]", i > 0 ? between : "", name, i);
  return all;
}
std::string numbers(int n, double first) {
  std::string all;
  for (int i = 0; i < n; ++i) all += fmt::format("{}{}", i > 0 ? "," : "", first + i);
  return all;
}

// libfranka 0.9.1 and newer: src/logging/robot_state_log.cpp
TEST_F(Columns, OfLibfrankaAreMillisecondsAndLinkSideTorques) {
  std::string head = "time,success_rate";
  for (const char* array : {"q", "q_d", "dq", "dq_d", "tau_J", "tau_ext_hat_filtered"})
    head += "," + seven(fmt::format("state.{}", array));
  head += "," + seven("cmd.q_d") + "," + seven("cmd.tau_J_d");
  const std::string row = ",0.99," + numbers(42, 1) + "," + numbers(14, 100) + "\n";
  const Trace t = read(head + "\n12345" + row + "12346" + row + "12348" + row, "libfranka");
  ASSERT_EQ(t.size(), 3);
  ASSERT_EQ(t.dof(), 7);
  EXPECT_NEAR(t.t[2] - t.t[0], 0.003, 1e-12);
  EXPECT_EQ(t.q(6, 0), 7);
  EXPECT_EQ(t.qd(0, 0), 15);
  EXPECT_EQ(t.tau(1, 1), 30);
  EXPECT_EQ(t.tau_ext_of_driver(0, 2), 36) << "the sign of (3)";
  EXPECT_TRUE(t.torque_at_instants);
  EXPECT_FALSE(t.has_truth());
}

// up to 0.9.0: blanks, names that come twice, and a column without numbers
TEST_F(Columns, OfOldLibfrankaAreThoseOfTheState) {
  std::string head = "duration, success rate, " + seven("q", ", ");
  for (const char* array : {"q_d", "dq", "dq_d", "tau_J", "tau_ext_hat_filtered"})
    head += "," + seven(array, ", ");
  head += ",sent commands," + seven("q_d", ", ") + "," + seven("tau_J_d", ", ");
  const std::string row = ",0.99," + numbers(42, 1) + ",," + numbers(14, 100) + "\n";
  const Trace t = read(head + "\n1" + row + "2" + row + "3" + row, "libfranka");
  ASSERT_EQ(t.size(), 3);
  EXPECT_EQ(t.q(0, 0), 1);
  EXPECT_EQ(t.tau(6, 0), 35);
  EXPECT_EQ(skipped_.total(), 0);
}

std::string six(const std::string& name, const char* between) {
  std::string all;
  for (int i = 0; i < 6; ++i) all += fmt::format("{}{}_{}", i > 0 ? between : "", name, i);
  return all;
}

// record.py of RTDE_Python_Client_Library: blanks, CR LF, True and False
TEST_F(Columns, OfRtdeWantTheGainsOfTheDrives) {
  const std::string head = "timestamp " + six("actual_q", " ") + " " + six("actual_qd", " ") + " " +
                           six("actual_current", " ") + " running\r\n";
  std::string rows;
  for (int k = 0; k < 4; ++k)
    rows += fmt::format("{} 0.1 -1.5707963267948966 1e-05 0 0 0 1 2 3 4 5 6 1 -2 3 4 5 6 True\r\n",
                        100 + 0.002 * k);
  Trace currents = read(head + rows, "ur_rtde");
  EXPECT_TRUE(currents.tau_is_current);
  EXPECT_EQ(currents.tau(1, 0), -2);
  Eigen::VectorXd gain = Eigen::VectorXd::Constant(6, 10);
  gain[3] = 0;
  expect_says(error_of([&] { make_torques(currents, gain); }), "the gain of drive 4 [N m/A]");
  gain[3] = 9;
  make_torques(currents, gain);
  EXPECT_FALSE(currents.tau_is_current);
  EXPECT_EQ(currents.tau(1, 0), -20);
  const std::string map = "preset = 'ur_rtde'\n[current]\ngain = [10, 10.7, 8.5, 9, 9.5, 10]\n";
  const Trace t = read_by(head + rows, map);
  ASSERT_EQ(t.size(), 4);
  EXPECT_EQ(t.q(1, 3), -1.5707963267948966);
  EXPECT_NEAR(t.tau(1, 0), -2 * 10.7, 1e-12);
  EXPECT_FALSE(t.tau_is_current);
  EXPECT_TRUE(t.torque_at_instants);
  EXPECT_NEAR(regularity_.step, 0.002, 1e-12);
  EXPECT_EQ(regularity_.repeats, 3);
}

// a torque of the map stands in the place of the preset's, with its columns unless it has others
TEST_F(Columns, ATorqueSaysWhatItIsAndWhenItActed) {
  const std::string csv = "t,q1,qd1,tau1\n0,1,2,3\n0.001,1,2,4\n";
  const Trace plain = read(csv, "tauext");
  EXPECT_FALSE(plain.torque_at_instants || plain.tau_without_gravity);
  const Trace without = read_by(csv, "preset = 'tauext'\n[tau_without_gravity]\nsign = -1\n");
  EXPECT_TRUE(without.torque_at_instants && without.tau_without_gravity);
  EXPECT_EQ(without.tau(0, 1), -4);
  const Trace held =
      read_by(csv,
              "preset = 'tauext'\n[tau_without_gravity]\nheld = true\ncolumns = ['qd1']\n[qd]\n"
              "columns = ['tau1']\n");
  EXPECT_TRUE(!held.torque_at_instants && held.tau_without_gravity);
  EXPECT_EQ(held.tau(0, 0), 2);
  EXPECT_TRUE(read_by(csv, "preset = 'tauext'\n[tau]\nheld = false\n").torque_at_instants);
  const Trace currents = read_by(csv, "preset = 'tauext'\n[current]\ngain = 10\nunit = 'mA'\n");
  EXPECT_FALSE(currents.tau_is_current);
  EXPECT_NEAR(currents.tau(0, 0), 0.03, 1e-15);
  expect_says(error_of([&] { read_by(csv, "preset = 'tauext'\n[q]\nheld = true\n"); }),
              "unknown key 'held'");
  expect_says(error_of([&] { read_by(csv, "preset = 'tauext'\n[tau]\nheld = 1\n"); }),
              "held must be true or false");
}

// the time of a row that is left out goes by
TEST_F(Columns, RowsWithoutATimeFollowAtARate) {
  const std::string csv = "q1,qd1,tau1\n1,2,3\nx,2,4\n1,2,5\n";
  const Trace t = read_by(csv, "preset = 'tauext'\nrate = 125\n");
  EXPECT_EQ(t.t, (std::vector<double>{0, 2 / 125.}));
  expect_says(error_of([&] { read_by(csv, "rate = 125\n[t]\ncolumns = ['q1']\n"); }),
              "a `rate` and a [t]");
  expect_says(error_of([&] { read_by(csv, "preset = 'tauext'\nrate = 0\n"); }), "positive [Hz]");
}

// pyfri's collect_data: no velocity, and external torque as KUKA has it
TEST_F(Columns, OfFriMakeAVelocityAndTurnTheExternalTorque) {
  std::string head = "index,time,record_time_nsec,tsec,tnsec", rows;
  for (const char* array : {"mp", "ip", "mt", "et"}) {
    for (int j = 1; j <= 7; ++j) head += fmt::format(",{}{}", array, j);
  }
  const auto q = [](double t) { return 0.3 * std::sin(2 * t); };
  for (int k = 0; k < 2000; ++k) {
    const double t = 0.002 * k;
    rows += fmt::format("{},{},0,{},{}", k, t, 1700000000 + k / 500, k % 500 * 2000000);
    for (int j = 0; j < 28; ++j) rows += fmt::format(",{:.17g}", j < 7 ? q(t) : j < 14 ? 0. : j);
    rows += ",0.002\n";
  }
  const Trace t = read(head + ",dt\n" + rows, "kuka_fri");
  ASSERT_EQ(t.size(), 2000);
  EXPECT_NEAR(t.t[1999] - t.t[0], 3.998, 1e-6);
  EXPECT_EQ(t.tau(0, 0), 14);
  EXPECT_EQ(t.tau_ext_of_driver(0, 0), -21);
  ASSERT_EQ(skipped_.notes.size(), 1U);
  EXPECT_EQ(skipped_.notes[0],
            "no qd: it is made of q by two poles at 100 rad/s and a difference (velocity_filter)");
  double worst = 0;  // two poles at 100 rad/s are 20 ms late, and half a sample
  for (int k = 0; k < 2000; ++k)
    worst = std::max(worst, std::abs(t.qd(3, k) - 0.6 * std::cos(2 * (0.002 * k - 0.021))));
  EXPECT_LT(worst, 0.003) << "from the first sample on, though the arm moves there";
}

TEST_F(Columns, ByNumbersInAnyUnitAndOrder) {
  const Trace t = read_by(
      "0;90;180;-2;1500\n10;90;180;-2;1500\n20;0;0;0;0\n",
      "separator = ';'\nheader = false\norder = [2, 1]\n[t]\ncolumns = [1]\nunit = 'ms'\n[q]\n"
      "columns = [2, 3]\nunit = 'deg'\nsign = [1, -1]\nzero = [0.25, 1]\n[tau]\ncolumns = [4, 5]\n"
      "unit = ['Nm', 'Nmm']\n");
  ASSERT_EQ(t.size(), 3);
  EXPECT_NEAR(t.t[1], 0.01, 1e-15);
  EXPECT_FALSE(t.torque_at_instants);
  // joint 1 of the robot is the second one of the recording; its sign, unit and zero go with it
  EXPECT_NEAR(t.q(0, 0), 1 - std::numbers::pi, 1e-15);
  EXPECT_NEAR(t.q(1, 0), 0.25 + std::numbers::pi / 2, 1e-15);
  EXPECT_NEAR(t.tau(0, 0), 1.5, 1e-12);
  EXPECT_EQ(t.tau(1, 0), -2);
}

using Names = std::vector<std::string>;

// two rows in which q of joint number i of these names is i, qd 10 i and tau 100 i, and which have
// the joints in this order; {} in a pattern is the name
std::string rows_with(const Names& joints, const std::vector<std::size_t>& order,
                      const Names& patterns) {
  std::string head = "t", row;
  for (std::size_t k = 0; k < patterns.size(); ++k) {
    for (const std::size_t i : order) {
      head += "," + fmt::format(fmt::runtime(patterns[k]), joints[i]);
      row += fmt::format(",{}", static_cast<double>(i) * std::pow(10., static_cast<double>(k)));
    }
  }
  return head + "\n0" + row + "\n0.001" + row + "\n";
}

std::string map_of(const Names& columns) {
  return fmt::format(
      "[t]\ncolumns = ['t']\n[q]\ncolumns = {}\n[qd]\ncolumns = {}\n[tau]\ncolumns = {}\n",
      columns[0], columns[1], columns[2]);
}

// as PlotJuggler, and programs of people's own, write what a bag has
TEST_F(Columns, OfJointsAreFoundByTheRobotsNames) {
  joints_ = {"hip_x", "knee", "ankle"};
  const std::vector<std::pair<Names, std::string>> layouts = {
      {{"position.{}", "velocity.{}", "effort.{}"}, "joint_state"},
      {{"position.left/leg_{}", "velocity.left/leg_{}", "effort.left/leg_{}"}, "joint_state"},
      {{"/joints/{}/position", "/joints/{}/velocity", "/joints/{}/effort"},
       map_of({"'/joints/(.*)/position'", "'/joints/(.*)/velocity'", "'/joints/(.*)/effort'"})},
      {{"{}_q", "{}_v", "{}Nm"}, map_of({"'.*_q'", "'.*_v'", "'[a-z_]*Nm'"})}};
  for (const auto& [patterns, map] : layouts) {
    for (const std::vector<std::size_t>& order :
         {std::vector<std::size_t>{0, 1, 2}, {2, 0, 1}, {1, 3, 2, 0}}) {
      const std::string csv = rows_with({"hip_x", "knee", "ankle", "grip"}, order, patterns);
      const Trace t = map.find('\n') == map.npos ? read(csv, map) : read_by(csv, map);
      ASSERT_EQ(t.dof(), 3) << csv;
      EXPECT_EQ(t.q.col(1), Eigen::Vector3d(0, 1, 2)) << csv;
      EXPECT_EQ(t.qd.col(1), Eigen::Vector3d(0, 10, 20)) << csv;
      EXPECT_EQ(t.tau.col(1), Eigen::Vector3d(0, 100, 200)) << csv;
      const bool has_grip = order.size() == 4;
      ASSERT_EQ(skipped_.notes.size(), has_grip ? 1U : 0U) << csv;
      if (has_grip)
        expect_says(skipped_.notes[0], "3 columns of other joints are left out: " +
                                           fmt::format(fmt::runtime(patterns[0]), "grip") + ", ");
    }
  }
}

// each with the sign that the map gives it
TEST_F(Columns, OfAListAreFoundByTheRobotsNamesIfItHasAll) {
  joints_ = {"hip", "knee"};
  const std::string csv = rows_with({"hip", "knee"}, {1, 0}, {"q_{}", "v_{}", "e_{}"});
  const std::string map = map_of({"['q_knee', 'q_hip']\nsign = [-1, 1]\nzero = [0.5, 0.25]",
                                  "['v_hip', 'v_knee']", "['e_knee', 'e_hip']"});
  const Trace t = read_by(csv, map);
  EXPECT_EQ(t.q.col(0), Eigen::Vector2d(0.25, -0.5));
  EXPECT_EQ(t.tau.col(0), Eigen::Vector2d(0, 100));
  EXPECT_EQ(skipped_.notes,
            Names{"joints are taken by the robot's names, and not in the map's order: [q] [tau]"});
  // who renames a joint lists the names, and `order` is by places
  joints_ = {"hip", "shin"};
  EXPECT_EQ(read_by(csv, map).tau.col(0), Eigen::Vector2d(100, 0));
  joints_ = {"hip", "knee"};
  EXPECT_EQ(read_by(csv, "order = [1, 2]\n" + map).tau.col(0), Eigen::Vector2d(100, 0));
}

TEST_F(Columns, ThatHaveOtherNamesThanTheRobotsJointsAreToldSo) {
  const Names patterns = {"position.{}", "velocity.{}", "effort.{}"};
  const std::string csv = rows_with({"hip", "knee", "l_toe"}, {2, 1, 0}, patterns);
  joints_ = {"a", "b", "c"};
  EXPECT_EQ(read(csv, "joint_state").q.col(0), Eigen::Vector3d(2, 1, 0)) << "the file's order";
  EXPECT_EQ(skipped_.notes,
            Names{"no column has the name of a joint of the robot (a, b, c), so joints are in the "
                  "file's order: [q] [qd] [tau_instant]"});
  joints_ = {"knee", "ankle", "hip"};
  expect_says(error_of([&] { read(csv, "joint_state"); }),
              "the columns of [q] never name ankle; the robot has knee, ankle, hip, and they name "
              "hip, knee, l_toe. Where a joint has another name there, --columns FILE.toml says");
  joints_ = {"toe"};
  expect_says(error_of([&] {
                read(rows_with({"l_toe", "r_toe"}, {0, 1}, patterns), "joint_state");
              }),
              "their names have the prefix 'l_', or they have the prefix 'r_'");
  joints_ = {"q2", "q1", "q0"};  // a number in the name is the order that the map asks for
  EXPECT_EQ(read("t,q1,q2,q3,tau1,tau2,tau3\n0,1,2,3,4,5,6\n1,1,2,3,4,5,6\n", "tauext").q.col(0),
            Eigen::Vector3d(1, 2, 3));
}

TEST_F(Columns, ThatNobodyWantsMayHoldAnything) {
  const Trace t = read_by("t,q1,qd1,tau1,note\n0,1,2,3,a word\n1,1,2,3,\n", "preset = 'tauext'\n");
  EXPECT_EQ(t.size(), 2);
  EXPECT_EQ(skipped_.total(), 0);
}

// as R and pandas write them
TEST_F(Columns, MayHaveTheirNamesInQuotes) {
  const Trace t = read("\"t\",\"q1\",\"qd1\",\"tau1\"\n0,1,2,3\n1,3,2,4\n", "tauext");
  ASSERT_EQ(t.size(), 2);
  EXPECT_EQ(t.tau(0, 1), 4);
}

TEST_F(Columns, HaveTheirNamesBelowComments) {
  const std::string rows = "0,1,2,3\n1,3,2,4\n";
  for (const std::string head :
       {"# made by hand, today\n\n% twice\nt,q1,qd1,tau1\n", "# noted\n#t,q1,qd1,tau1\n",
        "% t,q1,qd1,tau1\n", "sep=,\nt,q1,qd1,tau1\n"}) {
    const Trace t = read(head + rows, "tauext");
    ASSERT_EQ(t.size(), 2) << head;
    EXPECT_EQ(t.tau(0, 1), 4) << head;
    EXPECT_EQ(skipped_.total(), 0) << head;
  }
}

TEST_F(Columns, HaveADecimalPoint) {
  read("t;q1;qd1;tau1\n0;1;2;3\n0,5;1;2;3\n", "tauext");
  EXPECT_EQ(skipped_.first.at(0),
            "line 3: column 't' is '0,5', not a number: write decimals with a point");
}

TEST_F(Columns, ThatAMapOfOnesOwnWantsAndNobodyHasAreTold) {
  const std::string log = "t,q1,qd1,tau1\n0,1,2,3\n1,1,2,3\n";
  read_by(log, "preset = 'tauext'\n[contact]\ncolumns = 'touched'\n");
  EXPECT_EQ(skipped_.notes,
            std::vector<std::string>{"no column has [contact]: none is called 'touched'"});
}

TEST_F(Columns, OfAMapThatIsNoneAreRefusedWithTheLine) {
  expect_says(error_of_map("[q"), "map.toml: line 1: ");
  expect_says(error_of_map(""), "map.toml: nothing says which columns are [t]");
  expect_says(error_of_map("[|]"), "map.toml: ");
  expect_says(error_of_map("[q]\ncolumns='\xC3\xA4(.)'"), "line 2: a map is written in ASCII");
  expect_says(error_of_map("seperator = ','"), "line 1: unknown key 'seperator'; known: preset, ");
  expect_says(error_of_map("preset = 'franka'"),
              "unknown preset of columns 'franka'; known: tauext");
  expect_says(error_of_map("\n[velocity]\ncolumns='v'"), "line 2: unknown quantity 'velocity'");
  expect_says(error_of_map("[q]\ncolumns='('"), "line 2: columns '(': ");
  expect_says(error_of_map("[q]\nunit='deg'"), "line 1: [q] names no columns");
  expect_says(error_of_map("rate = 100\n[tau]\ncolumns=[1]"), "nothing says which columns are [q]");
  expect_says(error_of_map("[q]\ncolumns=[1]\n[tau]\ncolumns=[2]"),
              "nothing says which columns are [t]");
  expect_says(error_of_map(""), "like preset = \"tauext\"");
  expect_says(error_of_map("[q]\ncolumns='q'\nunit='ms'"),
              "line 3: [q] cannot be in 'ms'; it may be in: rad deg m mm");
  expect_says(error_of_map("[q]\ncolumns=[0]"), "line 2: columns must be a number from 1");
  expect_says(error_of_map("[q]\ncolumns='q'\nsign=2"), "sign must be 1 or -1");
  expect_says(error_of_map("[t]\ncolumns='a'\n[q]\ncolumns=['c']"), "no column 'c' for [q]");
  expect_says(error_of_map("[t]\ncolumns='a'\n[q]\ncolumns=[3]"), "no column 3 for [q]");
  expect_says(error_of_map("[t]\ncolumns='a'\n[q]\ncolumns='[ab]'"),
              "[q] matches 2 columns by '[ab]', and no group in it gives each its own number");
  expect_says(error_of_map("order=[1,2]\n[t]\ncolumns='a'\n[q]\ncolumns=[2]"),
              "[q] has 1 columns, and `order` names joint 2");
  expect_says(error_of_map("order=[1,1]\n[t]\ncolumns='a'\n[q]\ncolumns=[2]"),
              "`order` names joint 1 of the recording twice");
  expect_says(error_of_map("[t]\ncolumns='a'\n[q]\ncolumns=['b','b']"),
              "[q] names column 'b' twice");
  expect_says(error_of_map("[t]\ncolumns='a'\n[q]\ncolumns=[1]"), "column 'a' is both [t] and [q]");
  expect_says(error_of_map("[t]\ncolumns='a'\n[q]\ncolumns=[1,2]\ngain=[1,2,3]"),
              "[q] has 2 columns, and the map 3 gains");
  expect_says(error_of([&] { read("a,b\n", "nowhere.toml"); }), "nowhere.toml: No such file");
}

TEST_F(Columns, GapsAndJitterAreCounted) {
  std::string rows = "t,q1,qd1,tau1\n";
  for (int k = 0; k < 100; ++k)
    rows += fmt::format("{},{},0,0\n", 0.01 * k + (k % 2 == 0 ? 0.001 : 0) + (k >= 50 ? 3 : 0), k);
  read(rows, "tauext");
  EXPECT_EQ(regularity_.samples, 100);
  EXPECT_EQ(regularity_.gaps, 1);
  EXPECT_NEAR(regularity_.longest_gap, 3.011, 1e-9);
  EXPECT_NEAR(regularity_.step, 0.01, 1e-4);
  EXPECT_NEAR(regularity_.jitter, 0.001, 1e-5) << "steps of 9 and 11 ms in turn";
  EXPECT_EQ(regularity_.repeats, 0);
  RegularityCounter counter;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(1);
  for (const double t : {-1., 300., 300.01, 300.02}) counter.take(t, none, none, none);
  EXPECT_EQ(counter.so_far().gaps, 1) << "where the first step is the gap";
  EXPECT_NEAR(counter.so_far().step, 0.01, 1e-9);
  EXPECT_EQ(counter.so_far().longest_gap, 301);
  RegularityCounter burst;
  for (const double t : {0., 0.0001, 0.01, 0.02, 0.03, 0.04, 5.04}) burst.take(t, none, none, none);
  EXPECT_EQ(burst.so_far().gaps, 1) << "where the first step is short, or samples become rarer";
  EXPECT_NEAR(burst.so_far().step, 0.01, 1e-9);
  EXPECT_EQ(burst.so_far().longest_gap, 5);
}

}  // namespace
}  // namespace tauext::test

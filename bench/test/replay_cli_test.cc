// SPDX-License-Identifier: Apache-2.0
// tauext-replay.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "bench/test/programs.h"
#include "mjcf/trace/read/bag/bag_rows.h"
#include "mjcf/trace/read/layout_writer.h"
#include "mjcf/trace/read/recording.h"
#include "mjcf/trace/read/text/csv_rows.h"

namespace tauext::test {
namespace {

TEST_F(Programs, ReplayWritesOneRowPerSampleAndPrintsTheErrors) {
  run("tauext-record --robot wallmobot3 --scenario collision --out log.csv");
  const Outcome o =
      run("tauext-replay log.csv --robot wallmobot3 --estimator ekf,truth --detector pan_tompkins "
          "--out est.csv");
  EXPECT_EQ(o.code, 0) << o.text;
  EXPECT_TRUE(o.says("recall 1")) << o.text;
  const std::string est = content("est.csv");
  EXPECT_EQ(est.substr(0, est.find('\n')),
            "t,ekf_tau_ext1,ekf_tau_ext2,ekf_tau_ext3,ekf_status,ekf_pan_tompkins_mark,"
            "truth_tau_ext1,truth_tau_ext2,truth_tau_ext3,truth_status,truth_pan_tompkins_mark");
  EXPECT_EQ(std::count(est.begin(), est.end(), '\n'), 30001);
  const Outcome one = run(
      "tauext-replay log.csv --robot wallmobot3 --estimator ndob --detector pan_tompkins --out -");
  EXPECT_EQ(one.text.substr(0, one.text.find('\n')),
            "t,ndob_tau_ext1,ndob_tau_ext2,ndob_tau_ext3,ndob_status,pan_tompkins_mark");
}

// the dynamic linker tells what it loads
TEST_F(Programs, ReplayOfARobotByNameRunsWithoutMuJoCo) {
  const std::string linker = "LD_DEBUG=files " + kBin + "/";
  const Outcome record =
      run_system(linker + "tauext-record --robot wallmobot3 --scenario step --out log.csv");
  EXPECT_TRUE(record.says("file=libmujoco")) << "who simulates needs it";
  const Outcome replay = run_system(
      linker + "tauext-replay log.csv --robot wallmobot3 --estimator ekf,mo2 --out est.csv");
  EXPECT_EQ(replay.code, 0);
  EXPECT_FALSE(replay.says("libmujoco"));
}

// by the truth of a touch without a moment, at the end effector of an arm that sees all of it
TEST_F(Programs, ReplayFindsTheForceAndTheLink) {
  const std::string arm = " --robot " + kExamples + "/arm7.xml --lock 'finger.*'";
  run("tauext-record" + arm + " --scenario blow --out log.csv");
  const Outcome o = run("tauext-replay log.csv" + arm +
                        " --estimator truth --wrench end_effector "
                        "--out est.csv");
  EXPECT_EQ(o.code, 0) << o.text;
  EXPECT_TRUE(o.says("truth: the largest force is ")) << o.text;
  EXPECT_TRUE(o.says("joint 7 carries") ||
              o.says("joint 6 carries the link that is touched, or one behind it"))
      << o.text;
  std::istringstream est(content("est.csv"));
  std::string line, title;
  std::getline(est, line);
  std::map<std::string, int> column;
  for (std::istringstream titles(line); std::getline(titles, title, ',');) {
    const int at = static_cast<int>(column.size());
    column[title] = at;
  }
  int touched = 0;
  double largest = 0;
  while (std::getline(est, line)) {
    std::vector<double> x;
    for (std::istringstream cells(line); std::getline(cells, title, ',');)
      x.push_back(title.empty() ? 0 : std::stod(title));
    x.resize(column.size());
    const auto of = [&](const char* name) {
      return x[static_cast<std::size_t>(column.at(std::string("truth_") + name))];
    };
    largest = std::max(largest, std::hypot(of("fx"), of("fy"), of("fz")));
    touched += of("link") > 0;
    ASSERT_LT(of("left_over"), 1e-9) << line;
    ASSERT_LT(std::hypot(of("mx"), of("my"), of("mz")), 1e-8) << line;
    ASSERT_GT(of("seen_mz"), 1 - 1e-9);
  }
  EXPECT_GT(largest, 5) << "N";
  EXPECT_GT(touched, 5);
  EXPECT_EQ(run("tauext-replay log.csv" + arm + " --estimator mo2 --wrench nose --out x.csv").code,
            2);
  EXPECT_FALSE(exists("x.csv"));
}

TEST_F(Programs, ReplayWorksWithoutTruthAndReportsBadRows) {
  write("log.csv",
        "t,q1,q2,q3,qd1,qd2,qd3,tau1,tau2,tau3\n"
        "0,0,0,0,0,0,0,1,2,3\n"
        "0.001,0,0,0,0,0,inf,1,2,3\n"
        "0.002,0,0\n"
        "0.003,0,0,0,0,0,0,1,2,3\n");
  const Outcome o = run("tauext-replay log.csv --robot wallmobot3 --estimator ndob --out est.csv");
  EXPECT_EQ(o.code, 0) << o.text;
  EXPECT_TRUE(o.says("skipped 2 rows")) << o.text;
  EXPECT_TRUE(o.says("line 3: column 'qd3' is empty or not finite")) << o.text;
  const std::string est = content("est.csv");
  EXPECT_EQ(std::count(est.begin(), est.end(), '\n'), 3);
  const Outcome truth =
      run("tauext-replay log.csv --robot wallmobot3 --estimator truth --out e2.csv");
  EXPECT_EQ(truth.code, 2);
  EXPECT_TRUE(truth.says("needs columns tau_ext1..")) << truth.text;
  const Outcome twice =
      run("tauext-replay log.csv --robot wallmobot3 --estimator ndob,ndob --out e2.csv");
  EXPECT_EQ(twice.code, 2);
  EXPECT_TRUE(twice.says("'ndob' is named twice")) << twice.text;
}

TEST_F(Programs, ReplayTakesTheTorqueAsTheLogsColumnsSay) {
  run("tauext-record --robot testbed1 --scenario identify --out log.csv");
  const std::string log = content("log.csv");
  const std::string replay = "tauext-replay log.csv --robot testbed1 --out - --estimator mo2";
  const auto rows = [](const Outcome& o) {  // without the names of estimators
    return o.text.substr(0, o.text.find("\nestimator")).substr(o.text.find('\n'));
  };
  const Outcome held = run(replay), told = run(replay + " --torque instant");
  write("log.csv", "t,q1,qd1,tau_instant1,tau_ext1,contact" + log.substr(log.find('\n')));
  EXPECT_TRUE(rows(run(replay)) == rows(told));
  EXPECT_TRUE(rows(run(replay + " --torque held")) == rows(held));
  EXPECT_TRUE(rows(told) != rows(held));
}

TEST_F(Programs, ReplaySaysWhereTheTorqueIsReadTheWrongWay) {
  ASSERT_EQ(run("tauext-record --robot wallmobot3 --scenario free --out log.csv").code, 0);
  const std::string replay = "tauext-replay log.csv --robot wallmobot3 --out est.csv --estimator ";
  const std::string seems = "tau seems to be";
  const Outcome wrong = run(replay + "mo1 --torque instant");
  EXPECT_TRUE(wrong.says("tau seems to be held from each t (weight ")) << wrong.text;
  EXPECT_TRUE(wrong.says("and is taken as read at each t; use --torque held\n")) << wrong.text;
  EXPECT_FALSE(run(replay + "mo1 --torque held").says(seems));
  EXPECT_FALSE(run(replay + "mo1").says(seems));
  // where an estimator says it, --torque would be an error
  const Outcome own = run(replay + "mo1:torque=instant:bandwidth=20");
  EXPECT_TRUE(own.says("use --estimator mo1:bandwidth=20:torque=held\n")) << own.text;
  EXPECT_FALSE(run(replay + "mo1:bandwidth=20:torque=held").says(seems));
  EXPECT_FALSE(run(replay + "zero").says(seems)) << "which reads no torque";
  std::string log = content("log.csv");  // in contact all the time, it tells nothing
  for (std::size_t at = log.find('\n'); (at = log.find(",0\n", at)) != log.npos; ++at)
    log.replace(at, 3, ",1\n");
  write("log.csv", log);
  EXPECT_FALSE(run(replay + "mo1 --torque instant").says(seems));
}

TEST_F(Programs, ReplayRefusesLogsItCannotUse) {
  run("tauext-record --robot wallmobot3 --scenario free --out log.csv");
  write("empty.csv", "t,q1,q2,q3,qd1,qd2,qd3,tau1,tau2,tau3\nx\n");
  write("two.csv", "t,q1,q2,qd1,qd2,tau1,tau2\n0,1,2,3,4,5,6\n");
  const Outcome empty =
      run("tauext-replay empty.csv --robot wallmobot3 --estimator ndob --out est.csv");
  EXPECT_EQ(empty.code, 2);
  EXPECT_TRUE(empty.says("empty.csv: no usable row (1 skipped")) << empty.text;
  const Outcome two =
      run("tauext-replay two.csv --robot wallmobot3 --estimator ndob --out est.csv");
  EXPECT_EQ(two.code, 2);
  EXPECT_TRUE(two.says("wallmobot3 has 3 joints, the samples have 2")) << two.text;
  EXPECT_FALSE(exists("est.csv"));
  const Outcome npy =
      run("tauext-replay log.csv --robot wallmobot3 --estimator ndob --out est.npy");
  EXPECT_EQ(npy.code, 2);
  EXPECT_TRUE(npy.says("--out est.npy: estimates are written as CSV, or to an .npz")) << npy.text;
  EXPECT_FALSE(exists("est.npy"));
  const Outcome pipe = run_system("mkfifo log.fifo && " + kBin +
                                  "/tauext-replay log.fifo --robot wallmobot3 --estimator ndob "
                                  "--out est.csv");
  EXPECT_EQ(pipe.code, 2);
  EXPECT_TRUE(pipe.says("log.fifo: is a pipe")) << pipe.text;
  const Outcome bag = run("tauext-record --robot wallmobot3 --scenario free --out log.db3");
  EXPECT_TRUE(bag.says("--out log.db3: --layout joint_state makes a bag")) << bag.text;
  EXPECT_FALSE(exists("log.db3"));
}

TEST_F(Programs, ReplayOfALogInWrongUnitsIsAnErrorAndNotAnEstimate) {
  // milliseconds in place of seconds: every sample lies beyond the longest gap
  std::string log = "\xEF\xBB\xBFt,q1,qd1,tau1\n";  // with a byte order mark
  for (int k = 0; k < 100; ++k) log += std::to_string(k) + ",0.1,0,115\n";
  write("ms.csv", log);
  const Outcome o = run("tauext-replay --robot testbed1 --estimator ekf,ndob ms.csv --out est.csv");
  EXPECT_EQ(o.code, 1) << o.text;
  EXPECT_TRUE(o.says("Samples are 1 s apart")) << o.text;
}

// ROS sorts the names of a message by the alphabet
TEST_F(Programs, ReplayFindsTheJointsOfABagByName) {
  const std::string arm = " --robot " + kExamples + "/arm6.xml";
  run("tauext-record" + arm + " --scenario in_motion --out log.csv");
  SkippedRows skipped;
  const Trace log = read_recording((folder_ / "log.csv").string(), {}, &skipped);
  const std::vector<std::string> names = {"shoulder_pan", "shoulder_lift", "elbow",
                                          "wrist1",       "wrist2",        "wrist3"};
  const auto estimates_of = [&](const std::vector<int>& order) {
    Trace turned = log;
    turned.q = log.q(order, Eigen::indexing::all);
    turned.qd = log.qd(order, Eigen::indexing::all);
    turned.tau = log.tau(order, Eigen::indexing::all);
    std::vector<std::string> turned_names;
    for (const int j : order) turned_names.push_back(names[static_cast<std::size_t>(j)]);
    write_layout(turned, "joint_state", {}, turned_names, (folder_ / "log.db3").string());
    const Outcome o = run("tauext-replay log.db3" + arm + " --estimator mo2 --out est.csv");
    EXPECT_EQ(o.code, 0) << o.text;
    return content("est.csv");
  };
  const std::string plain = estimates_of({0, 1, 2, 3, 4, 5});
  EXPECT_EQ(std::count(plain.begin(), plain.end(), '\n'), 1 + log.size());
  EXPECT_TRUE(estimates_of({2, 1, 0, 3, 4, 5}) == plain) << "by the alphabet";
  EXPECT_TRUE(estimates_of({5, 3, 1, 0, 4, 2}) == plain);

  std::ofstream((folder_ / "q.toml").string())
      << "preset = 'joint_state'\n[q]\ncolumns = ['position."
      << fmt::format("{}']\n", fmt::join(names, "', 'position."));
  const Outcome half =
      run("tauext-replay log.db3" + arm + " --columns q.toml --estimator mo2 --out half.csv");
  EXPECT_EQ(half.code, 0) << half.text;
  EXPECT_TRUE(content("half.csv") == plain) << "the others are found by the robot's names, too";

  const Outcome other = run("tauext-replay log.db3 --robot " + kExamples +
                            "/arm7.xml --lock 'finger.*' --estimator mo2 --out other.csv");
  EXPECT_EQ(other.code, 2);
  EXPECT_TRUE(other.says("never name joint1, joint2, joint3, joint4, joint5, joint6, joint7; the "
                         "robot has joint1, ") &&
              other.says("and they name elbow, shoulder_lift, shoulder_pan, wrist1"))
      << other.text;
  EXPECT_FALSE(exists("other.csv"));
}

// [kB] the peak memory of one of the programs
long memory_of(const std::string& folder, const std::string& command) {
  const pid_t child = ::fork();
  if (child == 0) {
    const std::string line =
        "cd " + folder + " && exec " + kBin + "/" + command + " >/dev/null 2>&1";
    ::execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
    ::_exit(127);
  }
  int status = 0;
  struct rusage used {};
  ::wait4(child, &status, 0, &used);
  EXPECT_EQ(status, 0) << command;
  return used.ru_maxrss;
}

TEST_F(Programs, ReplayTakesNoMoreMemoryForALongerLog) {
  for (const std::string ending : {"csv", "lcm", "mcap"}) {
    std::vector<long> kilobytes;
    const int some = ending == "mcap" ? 10 : 2;  // chunks of it
    for (const int seconds : {some, 60}) {
      write("long.json",
            fmt::format(R"({{ "scenarios": [ {{ "name": "long", "duration": {}, "asks": "error",
        "sines": [ {{ "joint": 1, "amplitude": 0.3, "w": 2 }} ] }} ] }})",
                        seconds));
      const std::string log = fmt::format("log{}.{}", seconds, ending);
      const Outcome o =
          run("tauext-record --robot wallmobot3 --scenarios long.json --scenario long "
              "--out " +
              log);
      ASSERT_EQ(o.code, 0) << o.text;
      kilobytes.push_back(
          memory_of(folder_.string(), "tauext-replay " + log +
                                          " --robot wallmobot3 --estimator "
                                          "mo2,ekf --detector pan_tompkins --out est." +
                                          (ending == "mcap" ? "mcap" : "csv")));
    }
    EXPECT_LT(kilobytes[1], kilobytes[0] + 4000) << ending;
    EXPECT_LT(kilobytes[1], 64000) << ending;
  }
}

// through a row that is left out, with torques that were read at t, and with forces
TEST_F(Programs, ReplayOfMcapIsThatOfTheCsv) {
  const std::string arm = " --robot " + kExamples + "/arm7.xml --lock 'finger.*'";
  const std::string record = "tauext-record" + arm + " --scenario blow --every 8 --out ";
  ASSERT_EQ(run(record + "log.csv").code, 0);
  ASSERT_EQ(run(record + "log.mcap").code, 0);
  const std::string replay = arm +
                             " --estimator mo2,eso:bandwidth=60 --detector pan_tompkins "
                             "--wrench end_effector --out ";
  const Outcome csv = run("tauext-replay log.csv" + replay + "csv.csv");
  EXPECT_EQ(csv.code, 0) << csv.text;
  EXPECT_TRUE(csv.says("recall")) << csv.text;
  // and once more from the file that has the estimates, too
  ASSERT_EQ(run("tauext-replay log.csv" + replay + "est.mcap").code, 0);
  for (const char* log : {"log.mcap", "est.mcap"}) {
    const Outcome mcap = run(std::string("tauext-replay ") + log + replay + "mcap.csv");
    EXPECT_EQ(mcap.code, 0);
    EXPECT_EQ(mcap.text, csv.text) << "errors and verdicts";
    EXPECT_TRUE(content("mcap.csv") == content("csv.csv")) << log;
  }
}

// mo2_tau_ext1 of the CSV is tau_ext[0] on /estimate/mo2
TEST_F(Programs, ReplayWritesItsEstimatesToMcapAsToCsv) {
  ASSERT_EQ(run("tauext-record --robot wallmobot3 --scenario collision --out log.csv").code, 0);
  const std::string replay =
      "tauext-replay log.csv --robot wallmobot3 --estimator mo2,ekf --detector pan_tompkins --out ";
  ASSERT_EQ(run(replay + "est.csv").code, 0);
  ASSERT_EQ(run(replay + "est.mcap").code, 0);
  BagRows rows((folder_ / "est.mcap").string(), "/estimate/mo2,/estimate/ekf");
  EXPECT_EQ(rows.columns().size(), 1U + 1 + 3 + 1 + 1) << "both have the same names";
  for (const std::string estimator : {"mo2", "ekf"}) {
    BagRows mcap((folder_ / "est.mcap").string(), "/estimate/" + estimator);
    EXPECT_EQ(mcap.columns(),
              (std::vector<std::string>{"t", "message.t", "tau_ext[0]", "tau_ext[1]", "tau_ext[2]",
                                        "status", "mark"}));
    CsvRows csv((folder_ / "est.csv").string(), {});
    const auto at = [&](const std::string& name) {
      const auto found = std::find(csv.columns().begin(), csv.columns().end(), name);
      EXPECT_NE(found, csv.columns().end()) << name;
      return static_cast<std::size_t>(found - csv.columns().begin());
    };
    const std::size_t first = at(estimator + "_tau_ext1"), status = at(estimator + "_status");
    const std::size_t mark = at(estimator + "_pan_tompkins_mark");
    SkippedRows skipped;
    int count = 0, marks = 0;
    for (std::vector<double> a, b; mcap.next(a, skipped); ++count) {
      ASSERT_TRUE(csv.next(b, skipped));
      ASSERT_NEAR(a[0], b[0], 0.6e-9);
      ASSERT_EQ(a[1], b[0]);
      for (std::size_t j = 0; j < 3; ++j) ASSERT_EQ(a[2 + j], b[first + j]);
      ASSERT_EQ(a[5], b[status]);
      ASSERT_EQ(a[6], b[mark]);
      marks += a[6] != 0;
    }
    EXPECT_EQ(count, 30000);
    EXPECT_GT(marks, 0);
  }
}

// the robot's file multiplies the torques of logs, ours as others, and the log of estimates again
TEST_F(Programs, ReplayScalesTorquesOfMcapOnce) {
  fs::copy(kExamples + "/arm7.xml", folder_ / "arm7.xml");
  write("arm.json", R"({"format": "tauext-robot-1", "file": "arm7.xml", "lock": "finger.*",
    "joints": {"joint2": {"torque_gain": 1.04}, "joint4": {"torque_gain": 0.97}}})");
  ASSERT_EQ(run("tauext-record --robot arm.json --scenario free --out log.csv").code, 0);
  const std::string replay = " --robot arm.json --estimator mo2 --out ";
  const Outcome csv = run("tauext-replay log.csv" + replay + "csv.csv");
  EXPECT_EQ(run("tauext-replay log.csv" + replay + "est.mcap").code, csv.code) << csv.text;
  EXPECT_EQ(run("tauext-replay est.mcap" + replay + "mcap.csv").code, csv.code);
  EXPECT_TRUE(content("mcap.csv") == content("csv.csv"));
  EXPECT_EQ(run("tauext-replay log.csv --robot arm7.xml --lock 'finger.*' --estimator mo2 --out "
                "plain.csv")
                .code,
            0);
  EXPECT_TRUE(content("plain.csv") != content("csv.csv")) << "the gains matter";
}

TEST_F(Programs, McapAppearsWholeOrNotAtAll) {
  fs::create_symlink("/dev/full", folder_ / "full.mcap");
  const Outcome full = run("tauext-record --robot testbed1 --scenario hold --out full.mcap");
  EXPECT_EQ(full.code, 2) << full.text;
  EXPECT_TRUE(full.says("No space left on device")) << full.text;
  ASSERT_EQ(run("tauext-record --robot testbed1 --scenario hold --out log.mcap").code, 0);
  EXPECT_EQ(run("tauext-replay log.mcap --robot wallmobot3 --estimator mo1 --out e.mcap").code, 2);
  EXPECT_EQ(run("tauext-replay log.mcap --robot testbed1 --estimator mo1 --score_from 1e9 --out "
                "e.mcap")
                .code,
            2);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 2);
  const Outcome self =
      run("tauext-replay log.mcap --robot testbed1 --estimator mo1 --out log.mcap");
  EXPECT_EQ(self.code, 2) << self.text;
  const Outcome layout =
      run("tauext-record --robot testbed1 --scenario hold --layout libfranka --out x.mcap");
  EXPECT_EQ(layout.code, 2) << layout.text;
  EXPECT_TRUE(layout.says("--layout libfranka writes text or a bag, and --out is x.mcap"));
}

TEST_F(Programs, ReplayScoresFromATimeWithinTheLog) {
  ASSERT_EQ(run("tauext-record --robot testbed1 --scenario hold --out log.csv").code, 0);
  const std::string replay =
      "tauext-replay log.csv --robot testbed1 --estimator mo1 --out e.csv --score_from ";
  for (const std::string from : {"1e9", "inf", "nan"}) {
    const Outcome o = run(replay + from);
    EXPECT_EQ(o.code, 2) << o.text;
    EXPECT_TRUE(o.says("the log ends at")) << o.text;
    EXPECT_FALSE(exists("e.csv"));
  }
  EXPECT_EQ(run(replay + "1").code, 0);
}

TEST_F(Programs, RenderDrawsARobotAndSaysWhatItCannot) {
  const Outcome o =
      run("tauext-render --robot wallmobot6 --q 0.3,0,0,0,0,0 --camera front --size 160x120 --out "
          "a.png");
  if (o.says("pictures are left out of this build")) GTEST_SKIP() << o.text;
  EXPECT_EQ(o.code, 0) << o.text;
  const std::string png = content("a.png");
  EXPECT_EQ(png.substr(1, 3), "PNG");
  EXPECT_GT(png.size(), 4000u) << "not all of one colour";
  run("tauext-render --robot wallmobot6 --q 0,0,0,0,0,0 --camera front --size 160x120 --out b.png");
  EXPECT_TRUE(run("tauext-render --list").says("wallmobot6\n"));
  EXPECT_TRUE(run("tauext-render --list --robot wallmobot6").says("front"));
  EXPECT_NE(png, content("b.png")) << "another pose";
  const std::string arm = "tauext-render --robot " + kExamples + "/two_arms.urdf ";
  EXPECT_EQ(run(arm + "--out c.png").code, 0) << "without shapes or cameras";
  EXPECT_EQ(run(arm + "--q 1,2 --out d.png").code, 2);
  EXPECT_EQ(run(arm + "--camera nose --out d.png").code, 2);
  EXPECT_EQ(run(arm + "--size 1x1 --out d.png").code, 2);
  EXPECT_FALSE(exists("d.png"));
}

}  // namespace
}  // namespace tauext::test

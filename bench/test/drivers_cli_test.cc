// SPDX-License-Identifier: Apache-2.0
// An arm of seven joints that speaks as Drake's drivers do, from a log and off the air.
#include <cmath>
#include <regex>
#include <string>
#include <vector>

#include "bench/roster/test/hinge_arm.h"
#include "bench/test/live_programs.h"
#include "lcmtypes/log.h"
#include "lcmtypes/wire.h"
#include "mjcf/plant/model.h"
#include "mjcf/record.h"
#include "mjcf/scenarios/motion.h"

namespace tauext::test {
namespace {

std::vector<double> column(const Eigen::MatrixXd& m, int k, double sign = 1) {
  const Eigen::VectorXd c = sign * m.col(k);
  return {c.begin(), c.end()};
}

// The messages of Drake's drivers, with the signs of its manipulation/README.md: the iiwa's driver
// negates the measured torque, the Panda's the external one, if positive is what accelerates the
// joint; tau_ext of (3) is the opposite of that.
iiwa_status_t iiwa(const Trace& t, int k) {
  iiwa_status_t m{};
  m.num_joints = t.dof();
  m.joint_position_measured = column(t.q, k);
  m.joint_velocity_estimated = column(t.qd, k);
  m.joint_torque_measured = column(t.tau, k, -1);
  m.joint_torque_external = column(t.tau_ext, k, -1);
  m.joint_position_commanded.resize(m.num_joints);
  m.joint_position_ipo.resize(m.num_joints);
  m.joint_torque_commanded.resize(m.num_joints);
  return m;
}
panda_status_t panda(const Trace& t, int k) {
  panda_status_t m{};
  m.num_joints = t.dof();
  m.joint_position = column(t.q, k);
  m.joint_velocity = column(t.qd, k);
  m.joint_torque = column(t.tau, k);
  m.joint_torque_external = column(t.tau_ext, k);
  for (auto* const v : {&m.joint_position_desired, &m.joint_velocity_desired,
                        &m.joint_acceleration_desired, &m.joint_torque_desired}) {
    v->resize(m.num_joints);
  }
  return m;
}

// a log of them, encoded by the code of lcm-gen
template <class Make>
LogBuffer log_of(const Trace& t, const std::string& channel, Make make) {
  LogBuffer log;
  for (int k = 0; k < t.size(); ++k) {
    auto m = make(t, k);
    m.utime = std::llround(t.t[k] * 1e6);
    std::vector<std::byte> bytes(m.getEncodedSize());
    m.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    log.append(channel, m.utime, bytes);
  }
  return log;
}

// rmse [N m] of mo1, of each table
std::vector<double> rmse_of_mo1(const std::string& text) {
  const std::regex row("mo1 +([0-9.e+-]+)");
  std::vector<double> all;
  for (std::sregex_iterator r(text.begin(), text.end(), row), end; r != end; ++r) {
    all.push_back(std::stod((*r)[1]));
  }
  return all;
}

// six seconds in motion under gravity, and from one second on a load that comes and goes
Trace seven_joints(const std::string& mjcf) {
  Scenario s = quiet();
  s.duration = 6;
  s.start_on_reference = true;
  s.reference = [](double t, int) { return sine_motion(0.3, 1, t); };
  s.tau_ext = [](double t, int) { return t < 1 ? 0 : 3 * std::sin(2 * (t - 1)); };
  return record(load_mjcf(mjcf), s);
}

class Drivers : public LivePrograms {
 protected:
  Drivers() {
    write("arm.xml", hinge_arm(7));
    trace_ = seven_joints((folder_ / "arm.xml").string());
  }
  void check(const std::string& type, const std::string& channel) {
    ASSERT_GT(trace_.tau.row(1).cwiseAbs().maxCoeff(), 10) << "N m: a wrong sign would be seen";
    const std::string live = "--robot arm.xml --estimator mo1 ";
    const Outcome o =
        in_network("tauext-live --speed 4 --from driver.lcm " + live + "> played\n" +
                   listening("--subscribe " + channel + " --type " + type + " " + live) +
                   "lcm-logplayer --speed=4 driver.lcm > /dev/null; cat played\n" + kSumUp);
    EXPECT_EQ(o.code, 0) << o.text;
    EXPECT_TRUE(o.says("6000 samples")) << o.text;
    // the first few of UDP may not arrive on a busy machine; nobody can know that they were sent
    EXPECT_GT(number(o, "used"), 5900) << o.text;
    EXPECT_TRUE(o.says("+ 0 late + 0 repeated + 0 rejected + 0 lost")) << o.text;
    const std::vector<double> rmse = rmse_of_mo1(o.text);
    ASSERT_EQ(rmse.size(), 2u) << o.text;  // of the log, and off the air
    for (const double r : rmse) {
      EXPECT_GT(r, 0) << "N m, the lag of 30 rad/s";
      EXPECT_LT(r, 1) << "N m";
    }
  }
  Trace trace_;
};

TEST_F(Drivers, EveryMessageOfAnIiwaIsUsedWithItsSigns) {
  SKIP_WITHOUT_NAMESPACE();
  LogBuffer log = log_of(trace_, "IIWA_STATUS", iiwa);
  put_log("driver.lcm", log);
  check("iiwa", "IIWA_STATUS");
}

TEST_F(Drivers, EveryMessageOfAPandaIsUsedWithItsSigns) {
  SKIP_WITHOUT_NAMESPACE();
  LogBuffer log = log_of(trace_, "PANDA_STATUS", panda);
  put_log("driver.lcm", log);
  check("panda", "PANDA_STATUS");
}

// an arm as newer MuJoCo has it, with a gripper
TEST_F(Programs, AnImportedArmIsTheFilesOwn) {
  std::string newer = hinge_arm(3, false);
  newer.insert(newer.find("<joint"), "<joint name='grip' type='slide' actuatorfrcrange='-5 5'/>");
  write("newer.xml", newer);
  write("log.csv",
        "t,q1,q2,q3,qd1,qd2,qd3,tau1,tau2,tau3\n0,.1,.2,.3,0,0,0,1,2,3\n"
        ".001,.1,.2,.3,0,0,0,1,2,3\n.002,.1,.2,.3,0,0,0,1,2,3\n");
  const Outcome import = run("tauext-import newer.xml --lock grip --out arm.xml");
  EXPECT_EQ(import.code, 0) << import.text;
  EXPECT_TRUE(import.says("arm.xml: 3 joints")) << import.text;
  EXPECT_TRUE(import.says("1 joint.actuatorfrcrange")) << import.text;
  const std::string replay = "tauext-replay log.csv --estimator mo1,ekf --out ";
  for (const char* robot :
       {"own.csv --robot newer.xml --lock grip", "imported.csv --robot arm.xml"})
    EXPECT_EQ(run(replay + robot).code, 1) << "three samples tell nothing of their torques";
  EXPECT_NE(content("own.csv"), "");
  EXPECT_EQ(content("own.csv"), content("imported.csv"));

  EXPECT_TRUE(run(replay + "x.csv --robot newer.xml --lock grab").says("there are: grip"));
  EXPECT_TRUE(run(replay + "x.csv --robot wallmobot3 --lock grip").says("a robot from a file"));
  EXPECT_EQ(run("tauext-import newer.xml --out newer.xml").code, 2) << "it would be replaced";
  EXPECT_FALSE(exists("x.csv"));
}

// the message's own command, as a user copies it
TEST_F(Programs, WhatARefusedRobotNeedsIsNamedAndMendsIt) {
  std::string floats = hinge_arm(9, false);
  floats.insert(floats.find("</worldbody>"), "</body>");
  floats.insert(floats.find("<worldbody>") + 11, "<body name='base'><freejoint/><geom size='.1'/>");
  write("humanoid.xml", floats);
  const Outcome refused = run("tauext-import humanoid.xml --out arm.xml");
  EXPECT_EQ(refused.code, 2);
  EXPECT_FALSE(exists("arm.xml"));
  EXPECT_TRUE(refused.says("humanoid.xml: joint 1 'base' is free")) << refused.text;
  EXPECT_TRUE(refused.says("; to mend it: --lock 'base'")) << refused.text;
  EXPECT_EQ(run("tauext-import humanoid.xml --lock 'base' --out arm.xml").code, 0);
  // nine joints are too many for estimators, and eight are not
  const Outcome live = run("tauext-record --list --robot humanoid.xml");
  EXPECT_EQ(live.code, 2);
  const std::string keeps = " keeps the 8 from ";
  const std::size_t end = live.text.find(keeps), at = live.text.rfind("--lock '", end);
  ASSERT_NE(end, live.text.npos) << live.text;
  const Outcome fewer =
      run("tauext-record --list --robot humanoid.xml " + live.text.substr(at, end - at));
  EXPECT_EQ(fewer.code, 0) << fewer.text;
  EXPECT_TRUE(fewer.says("robot humanoid.xml")) << fewer.text;

  write("arm.urdf.xacro", "<robot/>");
  for (const char* command :
       {"tauext-import arm.urdf.xacro --out x.xml", "tauext-record --list --robot arm.urdf.xacro",
        "tauext-record --list --robot arm.urdf.xacro --lock grip"}) {
    const Outcome o = run(command);
    EXPECT_EQ(o.code, 2);
    EXPECT_TRUE(o.says("xacro arm.urdf.xacro > arm.urdf")) << o.text;
  }
  EXPECT_TRUE(run("tauext-record --list --robot .").says("like ./arm.urdf.xacro")) << "a folder";
  EXPECT_FALSE(exists("x.xml"));
}

}  // namespace
}  // namespace tauext::test

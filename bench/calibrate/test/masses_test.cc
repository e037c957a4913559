// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/masses/masses.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "bench/calibrate/arm_motion.h"
#include "mjcf/plant/any_tree.h"
#include "mjcf/plant/model.h"
#include "mjcf/plant/simulated.h"
#include "mjcf/record.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kArmFile = "bench/examples/arm6.xml";
constexpr const char* kArm6Known = "bench/examples/arm6.json";  // with friction and rotors

// joints that swing together, each at frequencies of its own
Scenario swing(double duration, double size, double tempo, const std::vector<double>& home) {
  Scenario s = quiet();
  s.duration = duration;
  s.start_on_reference = true;
  s.reference = [=](double t, int i) {
    const Reference slow = sine_motion(size, tempo * (0.61 + 0.17 * i), t),
                    fast = sine_motion(0.35 * size, tempo * (1.9 + 0.31 * i), t + i);
    return Reference{home[static_cast<std::size_t>(i)] + slow.q + fast.q, slow.qd + fast.qd,
                     slow.qdd + fast.qdd};
  };
  return s;
}
const std::vector<double> kBent = {0, -0.8, 0.9, 0.4, 0.5, 0};

Trace recorded(const Model& arm, const Scenario& s, double noise = 1e-3, std::uint64_t seed = 1) {
  Sensors sensors;
  sensors.velocity_noise = noise;
  sensors.loadcell_noise = 20 * noise;
  sensors.seed = seed;
  return record(arm, s, sensors);
}

class Masses : public testing::Test {
 protected:
  Masses() { fs::create_directories(folder_); }
  ~Masses() override { fs::remove_all(folder_); }

  std::string written(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  // arm6 whose bodies have 1.2 or 0.8 times their masses, in turn
  std::string arm6_with_wrong_masses() const {
    std::ifstream in(kArmFile);
    std::string text, line;
    for (int body = 0; std::getline(in, line); text += line + "\n") {
      const std::size_t at = line.find("mass=\"");
      if (at == line.npos) continue;
      const std::size_t from = at + 6, end = line.find('"', from);
      const double factor = body++ % 2 == 0 ? 1.2 : 0.8;
      const double mass = std::stod(line.substr(from, end - from));
      line.replace(from, end - from, fmt::format("{:.6g}", factor * mass));
    }
    return written("wrong.xml", text);
  }

  fs::path folder_ = fs::temp_directory_path() / ("tauext_masses_" + std::to_string(::getpid()));
};

bool doubts(const IdentifiedMasses& m, const std::string& why) {
  return std::any_of(m.doubts.begin(), m.doubts.end(), [&](const std::string& words) {
    return words.find(why) != std::string::npos;
  });
}

// [N m] rms by which the torques of two arms differ in windows of a motion, joint by joint
Eigen::VectorXd torque_difference(const ArmTree& a, const ArmTree& b, const Trace& log) {
  const ArmMotion one(a, log), other(b, log);
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(a.dof());
  for (int i = 0; i < a.dof(); ++i) {
    int left_out = 0;
    const auto windows = windows_of(log, i, {}, left_out);
    for (const Window& w : windows)
      squares[i] += std::pow(one.expected(i, w) - other.expected(i, w), 2) /
                    static_cast<double>(windows.size());
  }
  return squares.cwiseSqrt();
}

// [N m] rms and largest over poses of all of the range, of what holds them
double gravity_difference(const ArmTree& a, const ArmTree& b, int joint) {
  const auto one = gravity_of(a), other = gravity_of(b);
  double squares = 0;
  constexpr int kPoses = 300;
  for (int k = 0; k < kPoses; ++k) {
    const Eigen::VectorXd q = 3 * Eigen::VectorXd::Random(a.dof());
    squares += std::pow(one(q)[joint] - other(q)[joint], 2) / kPoses;
  }
  return std::sqrt(squares);
}

// Two links in a vertical plane, whose torques are made of six combinations of their masses: with
// l the length of the first, z along the links,
//   I1 + m2 l^2 (with the rotor), m1 z1 + m2 l, m1 x1, I2, m2 z2, m2 x2,
// the I about the joints.
class TwoLinks : public Masses {
 protected:
  static constexpr double kLength = 0.4;

  std::string arm(double m1, double x1, double z1, double I1, double m2, double x2, double z2,
                  double I2, const std::string& name) const {
    return written(
        name, fmt::format(
                  "<mujoco><compiler angle='radian'/><worldbody><body name='upper'><inertial "
                  "pos='{} 0 {}' mass='{}' diaginertia='{} {} {}'/><joint name='shoulder' axis='0 "
                  "1 0' armature='.05' damping='1' frictionloss='.8'/><body name='lower' pos='0 0 "
                  "{}'><inertial pos='{} 0 {}' mass='{}' diaginertia='{} {} {}'/><joint "
                  "name='elbow' axis='0 1 0' armature='.02' damping='.6' frictionloss='.5'/>"
                  "</body></body></worldbody></mujoco>",
                  x1, z1, m1, I1, I1, 0.4 * I1, kLength, x2, z2, m2, I2, I2, 0.4 * I2));
  }
};

TEST_F(TwoLinks, HaveTheBaseParametersOfTheTextbook) {
  const double m1 = 5, x1 = 0.03, z1 = 0.17, I1 = 0.06, m2 = 3, x2 = -0.04, z2 = 0.15, I2 = 0.03;
  const std::string truth = arm(m1, x1, z1, I1, m2, x2, z2, I2, "truth.xml"),
                    wrong = arm(7, 0, 0.2, 0.1, 2, 0, 0.1, 0.02, "wrong.xml");
  const Trace log = recorded(simulated(load_mjcf(truth)), swing(40, 1, 1.2, {0.4, 0.7}));
  NewRobotFile robot{wrong, ""};
  const IdentifiedMasses m = identify_masses(tree_of(load_mjcf(wrong)), {}, {log}, {}, robot);
  EXPECT_EQ(m.doubts, std::vector<std::string>());
  const MeasuredBody upper = robot.bodies.at("upper"), lower = robot.bodies.at("lower");
  const auto about_joint = [](const MeasuredBody& b) {
    return b.inertia[1] + b.mass * (b.center[0] * b.center[0] + b.center[2] * b.center[2]);
  };
  const double armature = robot.joints[0].terms[0].value;
  EXPECT_NEAR(upper.mass * upper.center[2] + lower.mass * kLength, m1 * z1 + m2 * kLength, 5e-3);
  EXPECT_NEAR(upper.mass * upper.center[0], m1 * x1, 3e-3);
  EXPECT_NEAR(lower.mass * lower.center[2], m2 * z2, 3e-3);
  EXPECT_NEAR(lower.mass * lower.center[0], m2 * x2, 3e-3);
  EXPECT_NEAR(about_joint(lower), I2 + m2 * (x2 * x2 + z2 * z2), 5e-3);
  EXPECT_NEAR(about_joint(upper) + lower.mass * kLength * kLength + armature,
              I1 + m1 * (x1 * x1 + z1 * z1) + m2 * kLength * kLength + 0.05, 5e-3);
  // the first of the six is its rotor's as well
  EXPECT_EQ(m.base.all, 5);
  EXPECT_EQ(m.base.shown, 5);
}

// Six hinges of which the first is upright have 36 base parameters (Gautier and Khalil). Two are
// those of rotors, too: the first joint's, and the second's, as its axis is level.
TEST_F(Masses, OfSixJointsWithWrongOnesComeOutAsTorquesShowThem) {
  const Model truth = simulated(load_mjcf(kArm6Known));
  const std::string wrong = arm6_with_wrong_masses();
  std::vector<Trace> logs;
  for (const std::uint64_t seed : {1, 2, 3})
    logs.push_back(recorded(truth,
                            swing(30, 0.6 + 0.2 * static_cast<double>(seed),
                                  0.8 + 0.2 * static_cast<double>(seed), kBent),
                            1e-3, seed));
  NewRobotFile robot{wrong, ""};
  const IdentifiedMasses m = identify_masses(tree_of(load_mjcf(wrong)), {}, logs, {}, robot);
  EXPECT_EQ(m.doubts, std::vector<std::string>());
  EXPECT_EQ(m.base.all, 34);
  EXPECT_GE(m.base.shown, 17);
  const ArmTree right = tree_of(load_mjcf(kArm6Known)), found = read_back(robot);
  const Trace other = recorded(truth, swing(20, 1.1, 1.1, {1, -1.4, 0.3, -0.6, 1.2, 1}), 0, 9);
  const Eigen::VectorXd misses = torque_difference(found, right, other);
  const Eigen::VectorXd missed = torque_difference(tree_of(load_mjcf(wrong)), right, other);
  judge_by_file(robot, logs, {});
  NewRobotFile exact{kArm6Known, "", calibrate_arm(right, logs)};
  for (int i = 0; i < 6; ++i) {
    const auto j = static_cast<std::size_t>(i);
    EXPECT_LT(gravity_difference(found, right, i), 0.01 * right.usual_torque[i]) << i;
    EXPECT_LT(misses[i], 0.02 * right.usual_torque[i]) << i;
    EXPECT_LT(misses[i], 0.3 * missed[i]) << i;
    // what the true masses leave is noise
    EXPECT_LT(m.joints[j].held_out, 1.1 * exact.joints[j].held_out + 1e-3) << i;
    EXPECT_GE(m.joints[j].nominal, m.joints[j].held_out) << i;
    EXPECT_TRUE(robot.joints[j].doubts.empty()) << i;
  }
}

// of a URDF without any mass, as those of industrial arms are
TEST_F(Masses, OfAFileWithoutAnyAreFound) {
  const double at[6][3] = {{0, 0, .16}, {0, .13, 0}, {0, -.12, .43},
                           {0, 0, .39}, {0, .12, 0}, {0, 0, .1}};
  const char* const joints[] = {"shoulder_pan", "shoulder_lift", "elbow",
                                "wrist1",       "wrist2",        "wrist3"};
  std::string text = "<robot name='bare'><link name='l0'/>";
  for (int i = 0; i < 6; ++i)
    text += fmt::format(
        "<link name='l{0}'><visual/></link><joint name='{1}' type='continuous'><parent "
        "link='l{2}'/><child link='l{0}'/><origin xyz='{3} {4} {5}'/><axis xyz='{6}'/></joint>",
        i + 1, joints[i], i, at[i][0], at[i][1], at[i][2], i == 0 || i == 4 ? "0 0 1" : "0 1 0");
  const std::string bare = written("bare.urdf", text + "</robot>");
  EXPECT_NE(error_of([&] { load_mjcf(bare); }).find("tauext-calibrate --masses"),
            std::string::npos);
  ImportOptions how;
  how.masses_unknown = true;
  const auto massless = import_mjcf(bare, how).massless;
  EXPECT_EQ(massless.size(), 6u);
  const Model truth = simulated(load_mjcf(kArm6Known));
  const std::vector<Trace> logs = {recorded(truth, swing(40, 0.9, 1, kBent)),
                                   recorded(truth, swing(40, 1.1, 1.3, kBent), 1e-3, 2)};
  NewRobotFile robot{bare, ""};
  const IdentifiedMasses m =
      identify_masses(tree_of(load_mjcf(bare, how)), massless, logs, {}, robot);
  EXPECT_EQ(m.doubts, std::vector<std::string>());
  EXPECT_FALSE(m.has_nominal);
  const ArmTree right = tree_of(load_mjcf(kArm6Known)), found = read_back(robot);
  const Trace other = recorded(truth, swing(20, 1.1, 1.1, {1, -1.4, 0.3, -0.6, 1.2, 1}), 0, 9);
  const Eigen::VectorXd misses = torque_difference(found, right, other);
  for (int i = 0; i < 6; ++i) {
    EXPECT_LT(gravity_difference(found, right, i), 0.01 * right.usual_torque[i]) << i;
    EXPECT_LT(misses[i], 0.02 * right.usual_torque[i]) << i;
  }
}

TEST_F(Masses, ThatTheRecordingsDoNotShowAreDoubted) {
  const Model truth = simulated(load_mjcf(kArm6Known));
  const ArmTree right = tree_of(load_mjcf(kArm6Known));
  const std::string wrong = arm6_with_wrong_masses();
  const ArmTree file = tree_of(load_mjcf(wrong));
  const auto found = [&](const ArmTree& arm, const std::string& path, const Trace& log) {
    NewRobotFile robot{path, ""};
    return identify_masses(arm, {}, {log}, {}, robot);
  };
  // hardly any way, about one pose
  EXPECT_TRUE(doubts(found(file, wrong, recorded(truth, swing(20, 0.02, 1.5, kBent))),
                     "in other poses, and its usual torque"));
  Trace log = recorded(truth, swing(30, 0.9, 1, kBent));
  EXPECT_TRUE(doubts(found(right, kArm6Known, log), "keep these"));
  log.tau *= -1;
  EXPECT_TRUE(doubts(found(file, wrong, log), "are left over, which no masses"));
  log.tau *= -2;
  EXPECT_TRUE(doubts(found(file, wrong, log), "are torques in N m"));
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
// What is done to a simulated arm's recording is what is found; nothing is found where nothing is.
#include "bench/replay/torque_fit.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "mjcf/plant/simulated.h"
#include "mjcf/record.h"
#include "mjcf/scenarios/generic.h"
#include "mjcf/test/error_of.h"
#include "mjcf/trace/known.h"

namespace tauext::test {
namespace {

struct Robot {
  explicit Robot(const std::string& file)
      : model(simulated(load_mjcf(file))), arm(tree_of(model)) {}

  // without the truth, as a robot has it
  Trace run(const std::string& scenario, double velocity_noise = 1e-3) const {
    const std::vector<Scenario> all = generic_scenarios(model);
    const Scenario& s =
        find_known(all, "scenario", scenario, [](const Scenario& one) { return one.name; });
    Sensors sensors;
    sensors.velocity_noise = velocity_noise;
    Trace log = record(model, s, sensors);
    log.tau_ext.resize(0, 0);
    log.contact.clear();
    return log;
  }
  static TorqueFit fit_of(const ArmTree& arm, const Trace& log, bool gravity_added = false) {
    TorqueFit f(arm, log.torque_at_instants, gravity_added);
    f.take(log);
    return f;
  }
  static std::string words_of(const ArmTree& arm, const Trace& log) {
    const TorqueFit f = fit_of(arm, log);
    const std::string why = f.contradiction();
    return why.empty() ? f.doubt() : why;
  }
  std::string contradiction(const Trace& log) const { return fit_of(arm, log).contradiction(); }
  // of contradiction or of doubt
  std::string words(const Trace& log) const { return words_of(arm, log); }

  Model model;
  ArmTree arm;
};

class TorqueFits : public testing::Test {
 protected:
  static Robot arm6() { return Robot("bench/examples/arm6.json"); }

  // the same arm in motion where nothing weighs anything
  static std::pair<ArmTree, Trace> weightless(const Robot& robot) {
    const auto gravity = gravity_of(robot.arm);
    ArmTree arm = robot.arm;
    arm.gravity.setZero();
    Trace log = robot.run("in_motion");
    for (int k = 0; k < log.size(); ++k) log.tau.col(k) -= gravity(log.q.col(k));
    return {std::move(arm), std::move(log)};
  }

  static void expect(const std::string& why, const std::string& words) {
    EXPECT_NE(why.find(words), std::string::npos) << '"' << why << '"';
  }
};

TEST_F(TorqueFits, NothingIsWrongWithTheArmsOwn) {
  const Robot robot = arm6();
  for (const char* scenario : {"free", "in_motion", "push", "blow", "clamp", "sine", "ramp"})
    EXPECT_EQ(robot.words(robot.run(scenario)), "") << scenario;
}

// the arm leans against a pad, or carries a load, most of the time, and nobody says so
TEST_F(TorqueFits, ALoadContradictsNothing) {
  const Robot robot = arm6();
  for (const char* scenario : {"contact", "step"})
    EXPECT_EQ(robot.contradiction(robot.run(scenario)), "") << scenario;
}

// of a file that knows neither rotors nor friction
TEST_F(TorqueFits, NothingIsWrongWhereTheFileLacksFriction) {
  const Robot robot = arm6();
  ArmTree bare = robot.arm;
  for (TreeJoint& j : bare.joints) j.armature = j.viscous = j.dry = j.offset = j.viscous_skew = 0;
  for (const char* scenario : {"free", "in_motion", "push"})
    EXPECT_EQ(Robot::words_of(bare, robot.run(scenario)), "") << scenario;
}

TEST_F(TorqueFits, GravityThatIsMissingIsNamed) {
  const Robot robot = arm6();
  for (const char* scenario : {"free", "in_motion"}) {
    Trace log = robot.run(scenario);
    const auto gravity = gravity_of(robot.arm);
    for (int k = 0; k < log.size(); ++k) log.tau.col(k) -= gravity(log.q.col(k));
    expect(robot.words(log), "[tau_without_gravity]");
    log.tau_without_gravity = true;
    add_gravity(log, robot.arm);
    EXPECT_EQ(robot.contradiction(log), "");
  }
}

// the motor's side of a gear, a hundredth of the link's torque, lacks no gravity
TEST_F(TorqueFits, ASmallTorqueWithGravityIsNoneWithoutIt) {
  const Robot robot = arm6();
  for (const double factor : {1. / 136, 0.001, 0.1}) {
    Trace log = robot.run("in_motion");
    log.tau *= factor;
    expect(robot.words(log), "another unit");
    log.tau_without_gravity = true;  // as somebody might try
    add_gravity(log, robot.arm);
    expect(Robot::fit_of(robot.arm, log, true).doubt(), "is gravity in it, in another unit");
  }
  Trace right = robot.run("in_motion");
  const auto gravity = gravity_of(robot.arm);
  for (int k = 0; k < right.size(); ++k) right.tau.col(k) -= gravity(right.q.col(k));
  right.tau_without_gravity = true;
  add_gravity(right, robot.arm);
  const TorqueFit fit = Robot::fit_of(robot.arm, right, true);
  EXPECT_EQ(fit.contradiction() + fit.doubt(), "");
  right.tau_without_gravity = true;
  add_gravity(right, robot.arm);  // it is there twice
  expect(Robot::fit_of(robot.arm, right, true).doubt(), "use [tau] in the place of");
}

TEST_F(TorqueFits, CurrentsAndOtherUnitsAreNamedWithTheirFactors) {
  const Robot robot = arm6();
  for (const char* scenario : {"free", "in_motion"}) {
    const Trace log = robot.run(scenario);
    Trace other = log;
    other.tau = robot.arm.gain.cwiseInverse().asDiagonal() * log.tau;
    expect(robot.words(other), "is 0.0");
    expect(robot.words(other), "currents");
    for (const double factor : {1000., 0.0001, 4.448, -1.}) {
      other.tau = factor * log.tau;
      EXPECT_NE(robot.words(other), "") << factor;
    }
  }
}

TEST_F(TorqueFits, ASignThatIsTurnedIsNamedInEachJoint) {
  const Robot robot = arm6();
  const Trace log = robot.run("in_motion");
  for (int j = 0; j < 6; ++j) {
    Trace other = log;
    other.tau.row(j) *= -1;
    expect(robot.contradiction(other), fmt::format("of joint {} ", j + 1));
    expect(robot.contradiction(other), "sign");
  }
}

TEST_F(TorqueFits, JointsInEachOthersColumnsAreNamed) {
  const Robot robot = arm6();
  const Trace log = robot.run("in_motion");
  for (int a = 0; a < 6; ++a) {
    for (int b = a + 1; b < 6; ++b) {
      Trace other = log;
      other.tau.row(a).swap(other.tau.row(b));
      expect(robot.contradiction(other), fmt::format("of joints {} and {}", a + 1, b + 1));
      other.q.row(a).swap(other.q.row(b)), other.qd.row(a).swap(other.qd.row(b));
      EXPECT_NE(robot.words(other), "") << a + 1 << " " << b + 1;
    }
  }
}

// the order of another driver, in which more than two joints have moved
TEST_F(TorqueFits, AnyOrderIsNamed) {
  const Robot robot = arm6();
  const Trace log = robot.run("in_motion");
  Trace other = log;
  const int order[] = {2, 1, 0, 3, 5, 4};  // joint j of the recording is this one of the robot
  for (int j = 0; j < 6; ++j)
    other.q.row(j) = log.q.row(order[j]), other.qd.row(j) = log.qd.row(order[j]),
    other.tau.row(j) = log.tau.row(order[j]);
  expect(robot.words(other), "in the order [3, 2, 1, 4, 6, 5]");
  other = log;
  for (int j = 0; j < 3; ++j) other.tau.row(j + 1) = log.tau.row(1 + (j + 1) % 3);
  expect(robot.contradiction(other), "tau fit the model in the order [1, 4, 2, 3, 5, 6]");
}

TEST_F(TorqueFits, AMotionThatIsReversedIsNamed) {
  const Robot robot = arm6();
  const Trace log = robot.run("in_motion");
  for (const int j : {1, 2, 3, 4}) {  // the first axis is vertical, the last link a point on it
    Trace other = log;
    other.q.row(j) *= -1, other.qd.row(j) *= -1;
    expect(robot.contradiction(other),
           fmt::format("the sign of q and qd of joint {} is reversed", j + 1));
    other.tau.row(j) *= -1;
    expect(robot.contradiction(other),
           fmt::format("the signs of q, qd and tau of joint {} are reversed", j + 1));
  }
  Trace two = log;
  two.tau.row(1) *= -1, two.tau.row(3) *= -1;
  expect(robot.contradiction(two), "the sign of tau of joints 2, 4 is reversed");
}

TEST_F(TorqueFits, AnotherZeroIsNamed) {
  const Robot robot = arm6();
  const Trace log = robot.run("in_motion");
  for (const int j : {1, 2, 3}) {
    for (const double zero : {std::numbers::pi / 2, -std::numbers::pi / 2, std::numbers::pi}) {
      Trace other = log;
      other.q.row(j).array() -= zero;
      expect(robot.contradiction(other), fmt::format("q of joint {} has its zero", j + 1));
      expect(robot.contradiction(other), fmt::format("{:.3g} rad added", zero));
    }
  }
}

TEST_F(TorqueFits, ATorqueOfAnotherTimeIsADoubt) {
  const Robot robot = arm6();
  const Trace log = robot.run("in_motion");
  for (const int late : {50, -50, 150, 10}) {  // [ms]
    Trace other = log;
    for (int k = 0; k < log.size(); ++k)
      other.tau.col(k) = log.tau.col(std::clamp(k - late, 0, log.size() - 1));
    EXPECT_EQ(robot.contradiction(other), "");
    const std::string why = robot.words(other);
    if (std::abs(late) == 10)
      EXPECT_EQ(why, "");
    else
      expect(why, fmt::format("{} ms {}", std::abs(late), late > 0 ? "after" : "before"));
  }
}

// also where the file knows neither friction nor rotors; slow motions of a noisy speed show none
TEST_F(TorqueFits, AShortDelayIsADoubt) {
  const Robot robot = arm6();
  ArmTree plain = robot.arm;
  for (TreeJoint& j : plain.joints) j.armature = j.viscous = j.viscous_skew = j.dry = j.offset = 0;
  const auto delayed = [](const Trace& log, int late) {
    Trace other = log;
    for (int k = 0; k < log.size(); ++k)
      other.tau.col(k) = log.tau.col(std::clamp(k - late, 0, log.size() - 1));
    return other;
  };
  const Trace log = robot.run("in_motion");
  for (const int late : {20, -20}) {
    expect(robot.words(delayed(log, late)), late > 0 ? "20 ms after" : "20 ms before");
    expect(Robot::words_of(plain, delayed(log, 2 * late)),
           late > 0 ? "40 ms after" : "40 ms before");
  }
  EXPECT_EQ(robot.words(robot.run("free", 3e-3)), "");
}

// which no delay of those that are tried explains better than some longer one
TEST_F(TorqueFits, AFactorIsNoDelay) {
  const Robot robot = arm6();
  Trace log = robot.run("in_motion");
  log.tau.row(2) *= 0.7375621;
  EXPECT_EQ(robot.words(log).find("comes"), std::string::npos) << robot.words(log);
}

TEST_F(TorqueFits, GravityThatIsThereTwiceIsADoubt) {
  const Robot robot = arm6();
  const auto gravity = gravity_of(robot.arm);
  Trace log = robot.run("in_motion");
  for (int k = 0; k < log.size(); ++k) log.tau.col(k) += gravity(log.q.col(k));
  EXPECT_EQ(robot.contradiction(log), "");
  expect(robot.words(log), "the torque of gravity twice");
}

// more than a sensor's, as one that was set to 0 in the first pose
TEST_F(TorqueFits, ALargeOffsetIsADoubt) {
  const Robot robot = arm6();
  Trace log = robot.run("in_motion");
  log.tau.colwise() -= log.tau.col(0).eval();
  EXPECT_EQ(robot.contradiction(log), "");
  expect(robot.words(log), "was it set to 0");
  log = robot.run("in_motion");
  log.tau.row(1).array() += 2;
  EXPECT_EQ(robot.words(log), "") << "a sensor's";
}

TEST_F(TorqueFits, GravityThatOneJointLacksIsADoubt) {
  const Robot robot = arm6();
  const auto gravity = gravity_of(robot.arm);
  Trace log = robot.run("in_motion");
  for (int k = 0; k < log.size(); ++k) log.tau(3, k) -= gravity(log.q.col(k))[3];
  expect(robot.words(log), "tau of joint 4");
}

// a unit's factor that is too near to 1 for slow poses to tell it from masses
TEST_F(TorqueFits, ASmallFactorOfOneJointIsADoubt) {
  const Robot robot = arm6();
  for (const int j : {1, 2}) {
    Trace log = robot.run("in_motion");
    log.tau.row(j) /= 0.7375621;
    expect(robot.words(log), fmt::format("tau of joint {} is 1.36 times", j + 1));
  }
}

// of the base, which neither gravity nor its own motion tells
TEST_F(TorqueFits, AJointSeenInAMirrorIsADoubt) {
  const Robot robot = arm6();
  for (const auto& [noise, words] :
       {std::pair(1e-3, "the signs of q, qd and tau of joint 1 are reversed"),
        std::pair(2e-2, "q, qd and tau of joint 1 fit better with the other sign")}) {
    Trace log = robot.run("in_motion", noise);
    log.q.row(0) *= -1, log.qd.row(0) *= -1, log.tau.row(0) *= -1;
    expect(robot.words(log), words);
  }
}

// their q's are the same but for 0.3 rad; torques by the closed form of two links in a plane
TEST_F(TorqueFits, JointsThatMoveAlikeAndAreExchangedAreADoubt) {
  const std::string file = testing::TempDir() + "tauext_turntables.xml";
  std::ofstream(file) << "<mujoco><compiler angle='radian'/><worldbody>"
                         "<body name='one'><joint name='j1' axis='0 0 1'/>"
                         "<inertial pos='.2 0 0' mass='5' diaginertia='.05 .05 .07'/>"
                         "<body name='two' pos='.4 0 0'><joint name='j2' axis='0 0 1'/>"
                         "<inertial pos='.15 0 0' mass='2' diaginertia='.01 .01 .017'/>"
                         "</body></body></worldbody></mujoco>";
  const Model model = load_mjcf(file);
  const ArmTree arm = tree_of(model);
  std::mt19937_64 random(7);
  std::normal_distribution<> noise(0, 1e-3);
  Trace log;
  log.q.resize(2, 12000), log.qd = log.q, log.tau = log.q;
  log.torque_at_instants = true;
  for (int k = 0; k < 12000; ++k) {
    const double t = 1e-3 * k, w = 1.3, q1 = 0.3 + 0.4 * std::sin(w * t), q2 = q1 + 0.3;
    const double qd = 0.4 * w * std::cos(w * t), qdd = -0.4 * w * w * std::sin(w * t);
    const double coupled = 2 * 0.4 * 0.15 * std::cos(q2), turned = 2 * 0.4 * 0.15 * std::sin(q2);
    const double far = 0.017 + 2 * 0.15 * 0.15;  // [kg m^2] the second link about its joint
    const double tau1 = (0.07 + 5 * 0.2 * 0.2 + 2 * 0.4 * 0.4 + far + 2 * coupled) * qdd +
                        (far + coupled) * qdd - 3 * turned * qd * qd + 0.02 * qd;
    const double tau2 = (far + coupled) * qdd + far * qdd + turned * qd * qd + 0.01 * qd;
    log.t.push_back(t);
    log.q.col(k) << q1, q2;
    log.qd.col(k) << qd + noise(random), qd + noise(random);
    log.tau.col(k) << tau1, tau2;
  }
  EXPECT_EQ(Robot::words_of(arm, log), "");
  log.q.row(0).swap(log.q.row(1)), log.qd.row(0).swap(log.qd.row(1));
  expect(Robot::words_of(arm, log), "q and qd of joints 1 and 2 fit");
}

// no joint alone shows it beside a load, and no slow pose, where nothing weighs anything
TEST_F(TorqueFits, AUnitIsADoubtWhereNothingWeighs) {
  const Robot robot = arm6();
  auto [floating, log] = weightless(robot);
  EXPECT_EQ(Robot::words_of(floating, log), "");
  log.tau *= 0.7375621;
  expect(Robot::words_of(floating, log), "all torques are 0.73");
}

// so that friction may be all of it, and a current, too
TEST_F(TorqueFits, ATorqueOfWhichTheModelKnowsLittleIsADoubtWhereNothingWeighs) {
  const Robot robot = arm6();
  auto [floating, log] = weightless(robot);
  const auto with_friction = [recorded = log](double torque) {
    Trace other = recorded;
    other.tau.array() += torque * (50 * recorded.qd.array()).tanh();
    return other;
  };
  EXPECT_EQ(Robot::words_of(floating, with_friction(1)), "");
  expect(Robot::words_of(floating, with_friction(100)), "explains little of tau");
  EXPECT_EQ(robot.words(robot.run("in_motion")), "");
}

// whose rotor no gear makes
TEST_F(TorqueFits, ARotorLargerThanTheArmIsNone) {
  const Robot robot = arm6();
  Trace log = robot.run("in_motion", 0);
  for (int k = 0; k + 1 < log.size(); ++k)
    log.tau(0, k) += 500 * (log.qd(0, k + 1) - log.qd(0, k)) / 1e-3;
  expect(robot.words(log), "takes a rotor of");
}

TEST_F(TorqueFits, DegreesAndZerosBetweenAreNamed) {
  const Robot robot = arm6();
  const Trace log = robot.run("in_motion");
  Trace other = log;
  other.q *= 180 / std::numbers::pi, other.qd *= 180 / std::numbers::pi;
  expect(robot.contradiction(other), "q and qd fit as degrees");
  other = robot.run("free");
  other.q.row(1).array() -= std::numbers::pi / 3;
  expect(robot.contradiction(other), "it fits with 1.05 rad added");
  for (const double zero : {0.7, -0.35}) {  // [rad] which is no part of a turn
    other = robot.run("free");
    other.q.row(2).array() -= zero;
    const std::string why = robot.words(other), words = "it fits with ";
    ASSERT_NE(why.find(words), std::string::npos) << why;
    EXPECT_NEAR(std::stod(why.substr(why.find(words) + words.size())), zero, 5e-3) << why;
  }
}

// a load at the end acts on all joints before
TEST_F(TorqueFits, AFactorOfOneJointAloneIsNoLoads) {
  const Robot robot = arm6();
  for (const int j : {1, 2}) {
    Trace log = robot.run("in_motion");
    log.tau.row(j) *= 2;
    expect(robot.words(log), fmt::format("tau of joint {} is 2 times", j + 1));
    log = robot.run("in_motion");
    log.tau.row(3 * j - 3) *= 0.5;  // which carry little, or nothing
    expect(robot.words(log), fmt::format("tau of joint {} is 0.5", 3 * j - 2));
  }
}

// the first joint carries nothing, and what turns with it is another thing in each pose
TEST_F(TorqueFits, AFactorOfOneJointAloneIsNoRotor) {
  const Robot robot = arm6();
  for (const double factor : {2., 10.}) {
    Trace log = robot.run("in_motion");
    log.tau.row(0) *= factor;
    expect(robot.words(log), fmt::format("tau of joint 1 is {:g} times", factor));
  }
  Trace log = robot.run("in_motion", 0);  // with a rotor of 5 kg m^2 that the file lacks
  for (int k = 0; k + 1 < log.size(); ++k)
    log.tau(0, k) += 5 * (log.qd(0, k + 1) - log.qd(0, k)) / 1e-3;
  EXPECT_EQ(robot.words(log), "");
}

TEST_F(TorqueFits, GravityThatTheFileSwitchesOffIsNamed) {
  const Robot robot = arm6();
  ArmTree without = robot.arm;
  without.gravity.setZero();
  const Trace log = robot.run("in_motion");
  expect(Robot::fit_of(without, log).contradiction(), "which the robot's file switches off");
  Trace free = log;
  const auto gravity = gravity_of(robot.arm);
  for (int k = 0; k < free.size(); ++k) free.tau.col(k) -= gravity(free.q.col(k));
  EXPECT_EQ(Robot::words_of(without, free), "");
}

// whose windows have 5 to 10 steps, and recordings of other rates beside it
TEST_F(TorqueFits, JitterAndOtherRatesAreNothing) {
  const Robot robot = arm6();
  const Trace log = robot.run("in_motion");
  std::vector<int> some, few;
  for (int k = 0; k < log.size(); k += k / 3000 % 2 == 0 ? 10 : 17) some.push_back(k);
  for (int k = 0; k < log.size(); k += 40) few.push_back(k);
  TorqueFit fit(robot.arm, log.torque_at_instants, false);
  for (const Trace& part : {select_samples(log, some), log, select_samples(log, few)})
    fit.take(part);
  EXPECT_EQ(fit.contradiction() + fit.doubt(), "");
}

TEST_F(TorqueFits, TwoChannelsThatAreOneAreNamed) {
  const Robot robot = arm6();
  Trace log = robot.run("in_motion");
  log.tau.row(4) = log.tau.row(3);
  expect(robot.contradiction(log), "tau of joints 4 and 5 is the same");
}

// one of several recordings cannot hide among the others
TEST_F(TorqueFits, EachOfSeveralRecordingsIsJudged) {
  const Robot robot = arm6();
  const Trace log = robot.run("in_motion");
  Trace other = log;
  other.tau.row(1) *= -1;
  EXPECT_EQ(error_of([&] {
              torques_fit(robot.arm, {log, log, log, other}, false, {"a", "b", "c", "d"});
            }).substr(0, 3),
            "d: ");
}

// friction of nearly what the masses take, which the file does not know
TEST_F(TorqueFits, FrictionHidesNoCause) {
  const Robot robot = arm6();
  ArmTree bare = robot.arm;
  for (TreeJoint& j : bare.joints) j.armature = j.viscous = j.dry = j.offset = j.viscous_skew = 0;
  Trace log = robot.run("in_motion");
  for (int k = 0; k < log.size(); ++k)
    for (int j = 0; j < 6; ++j)
      log.tau(j, k) += 0.5 * robot.arm.usual_torque[j] * std::tanh(log.qd(j, k) / 0.01);
  EXPECT_EQ(Robot::words_of(bare, log), "");
  const auto contradiction = [&](const Trace& other) {
    return Robot::fit_of(bare, other).contradiction();
  };
  Trace other = log;
  other.tau *= -1;
  expect(contradiction(other), "sign");
  other = log;
  other.tau.row(1).swap(other.tau.row(2));
  expect(contradiction(other), "of joints 2 and 3");
  for (const double factor : {0.1, 2., 8.851}) {
    other.tau = factor * log.tau;
    expect(Robot::words_of(bare, other), "times the torque of the model");
  }
  other = log;
  const auto gravity = gravity_of(bare);
  for (int k = 0; k < log.size(); ++k) other.tau.col(k) -= gravity(log.q.col(k));
  expect(contradiction(other), "[tau_without_gravity]");
}

// so small a factor may be masses' in one joint, but not in all alike
TEST_F(TorqueFits, FeetAndPoundsAreADoubt) {
  const Robot robot = arm6();
  for (const double factor : {0.7376, 1.3558, 0.87}) {
    Trace log = robot.run("in_motion");
    log.tau *= factor;
    EXPECT_EQ(robot.contradiction(log), "") << factor;
    expect(robot.words(log), "another unit");
  }
  const Robot pendulum("bench/examples/own_robot.xml");
  Trace log = pendulum.run("in_motion");
  log.tau *= 0.85;
  EXPECT_EQ(pendulum.words(log), "") << "masses of one joint";
  log.tau *= 0.7376 / 0.85;
  expect(pendulum.words(log), "another unit");
}

TEST_F(TorqueFits, AnotherArmIsDoubted) {
  const Robot robot = arm6();
  ArmTree light = robot.arm;
  for (TreeJoint& j : light.joints) j.mass *= 2.5, j.inertia *= 2.5;
  expect(Robot::words_of(light, robot.run("free")), "times the torque of the model");
}

// as of two files side by side that are not of one recording; of an arm that hardly moves they may
// be loads
TEST_F(TorqueFits, TorquesOfAnotherMotionAreADoubt) {
  const Robot robot = arm6();
  for (const std::string own : {"free", "in_motion"}) {
    for (const std::string other : {"free", "in_motion", "chirp"}) {
      Trace log = robot.run(own);
      const Trace torques = robot.run(other);
      const int size = std::min(log.size(), torques.size());
      log.t.resize(static_cast<std::size_t>(size));
      log.q.conservativeResize(Eigen::NoChange, size);
      log.qd.conservativeResize(Eigen::NoChange, size);
      log.tau = torques.tau.leftCols(size);
      const std::string words = robot.words(log);
      EXPECT_EQ(words.empty(), own == other) << own << ", " << other << ": " << words;
      if (own == "in_motion" && own != other) expect(words, "of joints 1, 2, 3");
      if (own == "in_motion" && own != other) expect(words, "does not follow the motion");
      EXPECT_EQ(robot.contradiction(log), "");
    }
  }
}

TEST_F(TorqueFits, OutliersDecideNothing) {
  const Robot robot = arm6();
  Trace log = robot.run("in_motion");
  for (int k = 0; k < log.size(); k += 1000) log.tau.col(k).setConstant(1e5);
  EXPECT_EQ(robot.words(log), "");
  log.tau *= 0.1;
  expect(robot.words(log), "is 0.1");
}

// in one pose a load and another unit look the same: that is no reason to refuse it
TEST_F(TorqueFits, APoseAloneIsADoubtAtMost) {
  const Robot robot = arm6();
  Trace log = robot.run("free");
  for (int k = 1; k < log.size(); ++k)
    log.q.col(k) = log.q.col(0), log.qd.col(k).setZero(), log.tau.col(k) = log.tau.col(0);
  EXPECT_EQ(robot.words(log), "");
  log.tau *= 1.6;
  EXPECT_EQ(robot.contradiction(log), "");
  log.tau *= 0.1 / 1.6;
  EXPECT_EQ(robot.contradiction(log), "");
  expect(robot.words(log), "currents");
  // a sensor's offset on a joint that carries nothing
  for (const double offset : {-3., 0.5, 2.}) {
    Trace other = robot.run("free");
    other.tau.row(5).array() += offset;
    EXPECT_EQ(robot.words(other), "") << offset;
  }
}

TEST_F(TorqueFits, ATorqueThatNeverChangesIsNamed) {
  const Robot robot = arm6();
  for (const int j : {1, 2, 5}) {
    Trace log = robot.run("free");
    log.tau.row(j).setConstant(log.tau(j, 0));
    expect(robot.contradiction(log), fmt::format("of joint {} never changes", j + 1));
    log.tau.setZero();
    expect(robot.contradiction(log), "joints 1, 2, 3, 4, 5, 6 never changes");
  }
}

TEST_F(TorqueFits, OtherMassesThanTheFilesAreADoubt) {
  const Robot robot = arm6();
  ArmTree tool = robot.arm;  // the file has a tool of 3 kg at the wrist that the arm did not carry
  TreeJoint& wrist = tool.joints.back();
  wrist.center *= wrist.mass / (wrist.mass + 3);
  wrist.mass += 3;
  const TorqueFit f = Robot::fit_of(tool, robot.run("free"));
  EXPECT_EQ(f.contradiction(), "");
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
// Springs between motors and links, and friction: against closed forms, and against MuJoCo with
// another body for each motor.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "mjcf/plant/coordinates.h"
#include "mjcf/plant/plant.h"
#include "mjcf/plant/simulated.h"
#include "mjcf/plant/tree.h"
#include "mjcf/record.h"
#include "mjcf/record_plain.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

using Eigen::VectorXd;

Model model_of(const std::string& bodies, const std::string& motors) {
  const auto path =
      std::filesystem::temp_directory_path() / fmt::format("tauext_drives_{}.xml", ::getpid());
  std::ofstream(path) << "<mujoco><compiler angle='radian'/>"
                         "<option integrator='RK4' timestep='1e-4' gravity='0 0 -9.81'/>"
                         "<worldbody>"
                      << bodies << "</worldbody><actuator>" << motors << "</actuator></mujoco>";
  const Model model = load_mjcf(path.string());
  std::filesystem::remove(path);
  return model;
}

// 0.6 kg m^2 about its hinge, which gravity does not turn; it is used to 6 N m
Model turntable() {
  return simulated(
      model_of("<body><joint name='j' axis='0 0 1'/><inertial pos='0 0 -.5' mass='2' "
               "diaginertia='.6 .6 .6'/></body>",
               "<motor joint='j'/>"));
}

// it floats, and d [N m] acts from the begin
Scenario pushed(double d, double duration) {
  Scenario s = quiet();
  s.name = "pushed";
  s.duration = duration;
  s.floats = true;
  s.tau_ext = [d](double, int) { return d; };
  return s;
}

// two masses and a spring: with x = theta - q, x'' = -K (1/R + 1/B) x + d / B
TEST(Drives, ASpringBetweenTwoMassesIsThatOfTheBooks) {
  const double B = 0.6, u = 6, K = 100 * u, R = 0.02 * u, d = 3;
  const Recording r{.drives = {.stiffness = 100, .rotor = 0.02, .damping = 0}};
  const Trace t = simulate(turntable(), pushed(d, 1), r);
  ASSERT_EQ(t.motor_q.cols(), t.size());
  EXPECT_TRUE(t.torque_at_instants);
  const double w = std::sqrt(K * (1 / R + 1 / B)), most = 2 * d / (B * w * w);
  for (int k = 0; k < t.size(); ++k) {
    const double x = most / 2 * (1 - std::cos(w * t.t[k]));
    ASSERT_NEAR(t.motor_q(0, k) - t.q(0, k), x, 0.02 * most) << t.t[k];
    ASSERT_NEAR(t.tau(0, k), K * (t.motor_q(0, k) - t.q(0, k)), 1e-9 * K * most);
    // nothing else moves both
    ASSERT_NEAR(B * t.q(0, k) + R * t.motor_q(0, k), -d * t.t[k] * t.t[k] / 2, 1e-9);
  }
}

TEST(Drives, DampingIsAShareOfTheCriticalOne) {
  const double u = 6, K = 100 * u, R = 0.02 * u, B = 0.6, share = 0.3;
  const Trace t = simulate(turntable(), pushed(3, 1),
                           {.drives = {.stiffness = 100, .rotor = 0.02, .damping = share}});
  // x'' + D m x' + K m x = d / B, m = 1/R + 1/B, D = 2 share sqrt(K R)
  const double m = 1 / R + 1 / B, a = share * std::sqrt(K * R) * m, w0 = std::sqrt(K * m);
  const double w = std::sqrt(w0 * w0 - a * a), end = 3 / B / (w0 * w0);
  for (int k = 0; k < t.size(); ++k) {
    const double now = t.t[k];
    const double x =
        end * (1 - std::exp(-a * now) * (std::cos(w * now) + a / w * std::sin(w * now)));
    ASSERT_NEAR(t.motor_q(0, k) - t.q(0, k), x, 0.02 * end) << now;
  }
}

TEST(Drives, FrictionBrakesAsItSays) {
  const double B = 0.6, u = 6;
  const auto at_speed = [](const Drives& d, double qd, double duration) {
    Scenario s = pushed(0, duration);
    s.start_on_reference = true;
    s.reference = [qd](double t, int) { return Reference{qd * t, qd, 0}; };
    return simulate(turntable(), s, {.drives = d});
  };
  const Trace oil = at_speed({.viscous = 0.05}, 1, 2);
  for (int k = 0; k < oil.size(); k += 100)
    EXPECT_NEAR(oil.qd(0, k), std::exp(-0.05 * u / B * oil.t[k]), 1e-3);
  EXPECT_EQ(oil.motor_q.cols(), 0) << "drives are rigid";
  EXPECT_FALSE(oil.torque_at_instants);
  const Trace dry = at_speed({.coulomb = 0.02}, 1, 2);
  for (int k = 0; k < dry.size(); k += 100)
    EXPECT_NEAR(dry.qd(0, k), 1 - 0.02 * u / B * dry.t[k], 1e-6) << "far from rest";
  // at 50 mrad/s 1/e of what is more is left; at first drift adds to it
  const Trace slow = at_speed({.coulomb = 0.02, .stribeck = 0.5, .drift = 0.1}, 0.05, 2);
  const double sliding = std::tanh(0.05 / kFrictionTurns);
  EXPECT_NEAR(slow.friction(0, 0), 1.1 * 0.02 * u * (1 + 0.5 / std::exp(1)) * sliding, 1e-12);
  EXPECT_EQ(slow.tau(0, 0), 0) << "friction is none of the motor's torque";
  EXPECT_EQ(slow.tau_ext(0, 0), 0) << "nor from outside";
}

// a spatial arm of two hinges, its motors bodies of their own
struct TwoHinges {
  static std::string arm(bool with_motors, double K0, double K1, double R0, double R1) {
    const auto joint = [&](const char* name, const char* axis, double K, double R,
                           const std::string& inside) {
      if (!with_motors) return fmt::format("<joint name='{}' axis='{}'/>{}", name, axis, inside);
      return fmt::format(
          "<joint name='{0}' axis='{1}' armature='{2}'/><inertial pos='0 0 0' mass='1e-8' "
          "diaginertia='1e-12 1e-12 1e-12'/><body><joint name='{0}_spring' axis='{1}' "
          "stiffness='{3}'/>{4}</body>",
          name, axis, R, K, inside);
    };
    const std::string fore = joint("b", "0 1 0", K1, R1,
                                   "<inertial pos='.2 0 .05' mass='3' diaginertia='.02 .05 .04'/>");
    const std::string upper =
        joint("a", "0 .6 .8", K0, R0,
              "<inertial pos='.2 .1 0' mass='5' diaginertia='.05 .1 .08'/><body pos='.4 0 .1'>" +
                  fore + "</body>");
    return "<body>" + upper + "</body>";
  }
};

TEST(Drives, AreSharesOfWhatTheArmAloneIsUsedTo) {
  const std::pair<const char*, const char*> kScenes[] = {{"testbed1", "load"},
                                                         {"testbed1", "obstacle"},
                                                         {"wallmobot3", "load"},
                                                         {"wallmobot3", "panel_obstacle"}};
  for (const auto& [robot, scene] : kScenes) {
    const VectorXd alone = tree_of(load_robot(robot)).usual_torque;
    const VectorXd u = usual_torque_of(load_robot(robot, scene));
    EXPECT_TRUE(u.size() == alone.size() && u.isApprox(alone, 1e-12)) << robot << ' ' << scene;
  }
}

// the rotors turn about their joints alone: an armature of the motors' hinges, no body's inertia
TEST(Drives, AnArmWithSpringsIsMuJoCosWithABodyForEachMotor) {
  const Model arm = simulated(
      model_of(TwoHinges::arm(false, 0, 0, 0, 0), "<motor joint='a'/><motor joint='b'/>"));
  const VectorXd u = tree_of(arm).usual_torque;
  const Drives d{.stiffness = 60, .rotor = 0.01, .damping = 0};
  const Model twice = model_of(TwoHinges::arm(true, 60 * u[0], 60 * u[1], .01 * u[0], .01 * u[1]),
                               "<motor joint='a'/><motor joint='b'/>");
  ASSERT_EQ(twice->nv, 4);
  const auto load = [&](double t, int i) { return (i == 0 ? 0.2 : -0.1) * u[i] * std::sin(7 * t); };
  Scenario s = quiet();
  s.duration = 1;
  s.floats = true;
  s.tau_ext = load;
  const Trace ours = simulate(arm, s, {.drives = d});
  // MuJoCo's: weight is balanced at each sample by what the rigid arm says there
  Plant rigid(arm);
  const State data = initial_state(*twice);
  data->qpos[0] = ours.motor_q(0, 0), data->qpos[2] = ours.motor_q(1, 0);
  data->qpos[1] = -data->qpos[0], data->qpos[3] = -data->qpos[2];  // the links are at q = 0
  double largest = 0;
  for (int k = 0; k < ours.size(); ++k) {
    const Eigen::Vector2d q(data->qpos[0] + data->qpos[1], data->qpos[2] + data->qpos[3]),
        qd(data->qvel[0] + data->qvel[1], data->qvel[2] + data->qvel[3]),
        theta(data->qpos[0], data->qpos[2]);
    ASSERT_LT((ours.q.col(k) - q).norm(), 2e-5) << ours.t[k];
    ASSERT_LT((ours.motor_q.col(k) - theta).norm(), 2e-5) << ours.t[k];
    ASSERT_LT((ours.qd.col(k) - qd).norm(), 2e-3) << ours.t[k];
    largest = std::max(largest, (q - theta).cwiseAbs().maxCoeff());
    rigid.set_state(q, qd);
    const VectorXd motors = rigid.bias();
    for (int i = 0; i < 2; ++i) {
      // a torque about a link's hinge acts on both coordinates that turn it
      data->qfrc_applied[2 * i + 1] = -load(ours.t[k], i);
      data->qfrc_applied[2 * i] = motors[i] - load(ours.t[k], i);
    }
    for (int i = 0; i < 10; ++i) mj_step(twice.get(), data.get());
  }
  EXPECT_GT(largest, 0.01) << "[rad] that springs gave way";
}

// so many parts of a sample are enough
TEST(Drives, MoreStepsMakeNoOtherMotion) {
  const Model arm = simulated(
      model_of(TwoHinges::arm(false, 0, 0, 0, 0), "<motor joint='a'/><motor joint='b'/>"));
  Scenario s = quiet();
  s.duration = 2;
  s.reference = [](double t, int i) { return sine_motion(0.2, i == 0 ? 4 : 7, t); };
  for (const Drives& d : {Drives{.coulomb = 0.05, .stribeck = 0.5, .viscous = 0.05},
                          Drives{.stiffness = 60, .coulomb = 0.05, .stribeck = 0.5}}) {
    const Trace t = simulate(arm, s, {.drives = d}),
                finer = simulate(arm, s, {.substeps = 50, .drives = d});
    EXPECT_LT((t.q - finer.q).cwiseAbs().maxCoeff(), 2e-3 * 0.2);
    EXPECT_LT((t.qd - finer.qd).cwiseAbs().maxCoeff(), 2e-2 * 1.4);
  }
}

// (3) at each sample, with the acceleration of the arm's dynamics, while a controller moves it
TEST(Drives, TheTruthIsThatOfTheEquationAndTheSameWithoutMuJoCo) {
  const Model arm = load_robot("wallmobot3");
  Scenario s = quiet();
  s.duration = 4;
  s.reference = [](double t, int) { return sine_motion(0.3, 3, t); };
  s.start_on_reference = true;
  s.force = [](double t, const Point&) {
    return Eigen::Vector3d(t > 2 && t < 2.02 ? 200 : 0, 0, t > 3 ? 50 : 0);
  };
  s.regions = {{.region = &body_region("chest"), .speed = 0.25}};
  s.regions[0].begin = 1;
  const Recording r{
      .drives = {.stiffness = 60, .coulomb = 0.03, .stribeck = 0.3, .viscous = 0.05, .drift = 0.2}};
  const Trace t = simulate(arm, s, r);
  EXPECT_LT(difference(t, simulate_plain(arm, s, r)), 1e-9);
  Plant plant(arm);
  double wound = 0;
  for (int k = 0; k < t.size(); ++k) {
    plant.set_state(t.q.col(k), t.qd.col(k));
    const VectorXd left = plant.inertia() * t.qdd.col(k) + plant.bias() + t.friction.col(k) +
                          t.tau_ext.col(k) - t.tau.col(k);
    ASSERT_LT(left.norm(), 1e-8 * std::max(1., t.tau.col(k).norm())) << t.t[k];
    wound = std::max(wound, (t.motor_q.col(k) - t.q.col(k)).cwiseAbs().maxCoeff());
  }
  EXPECT_GT(wound, 0.005) << "[rad]";
  EXPECT_LT(wound, 0.1) << "the motors go where they are told to";
  for (int k = 2500; k < t.size(); ++k)
    ASSERT_LT(std::abs(t.motor_q(0, k) - s.reference(t.t[k], 0).q), 0.05) << t.t[k];
}

TEST(Drives, WhatIsMeasuredIsTheMotorsSide) {
  const Trace t = simulate(turntable(), pushed(3, 0.5), {.drives = {.stiffness = 100}});
  const Trace seen = measure(t, {});
  EXPECT_TRUE(seen.q == t.motor_q);
  EXPECT_TRUE(seen.qd == t.motor_qd);
  EXPECT_TRUE(seen.tau == t.tau);
  EXPECT_TRUE(seen.tau_ext == t.tau_ext) << "the truth stays the link's";
  EXPECT_EQ(seen.motor_q.cols(), 0);
}

TEST(Drives, OutOfRangeIsAnErrorThatNamesIt) {
  const auto error = [](const Drives& d) {
    return error_of([&] { simulate(turntable(), pushed(0, 0.1), {.drives = d}); });
  };
  EXPECT_NE(error({.coulomb = -1}).find("drives coulomb"), std::string::npos);
  EXPECT_NE(error({.stiffness = 2e6}).find("drives stiffness [u/rad] must be 0 to 1e+06"),
            std::string::npos);
  EXPECT_NE(error({.rotor = 1}).find("the others want stiffness, coulomb or viscous"),
            std::string::npos);
  EXPECT_NE(error({.stiffness = 1, .rotor = 0}).find("drives rotor"), std::string::npos);
  EXPECT_NE(error({.stiffness = 1e6, .rotor = 1e-6}).find("more than 1000 steps in a sample"),
            std::string::npos);
  EXPECT_NE(error({.viscous = 1, .drift = 2}).find("drives drift"), std::string::npos);
}

}  // namespace
}  // namespace tauext::test

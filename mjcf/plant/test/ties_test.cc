// SPDX-License-Identifier: Apache-2.0
#include "mjcf/mujoco/ties.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "estimators/runs/runs.h"
#include "mjcf/plant/any_tree.h"
#include "mjcf/plant/model_error.h"
#include "mjcf/plant/plant.h"
#include "mjcf/plant/simulated.h"
#include "mjcf/plant/test/arm_dynamics.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

using Eigen::VectorXd;

Model tied_model(const std::string& bodies, const std::string& equality = "") {
  const auto path =
      std::filesystem::temp_directory_path() / fmt::format("tauext_ties_{}.xml", ::getpid());
  std::ofstream(path) << fmt::format(
      "<mujoco><compiler angle='radian'/><worldbody>{}</worldbody><equality>{}</equality></mujoco>",
      bodies, equality);
  const Model m = load_mjcf(path.string());
  std::filesystem::remove(path);
  return m;
}

// an upper arm with a wheel or a second link at its end, and what hangs on that
std::string upper(const std::string& more, const std::string& joint = "") {
  return "<body><joint name='shoulder' axis='0 1 0' damping='.3' " + joint +
         "/><inertial pos='0 0 .2' mass='3' diaginertia='.05 .04 .02'/><body pos='0 0 .5'>" + more +
         "</body></body>";
}

// the same torques, for 2 s: where both arms are then
void expect_one_motion(const Model& tied, const Model& plain, int dof) {
  Plant a(simulated(tied)), b(simulated(plain));
  ASSERT_EQ(a.dof(), dof);
  ASSERT_EQ(b.dof(), dof);
  const VectorXd q = VectorXd::Constant(dof, 0.4), qd = VectorXd::Constant(dof, -0.7);
  a.set_state(q, qd);
  b.set_state(q, qd);
  EXPECT_LT((a.inertia() - b.inertia()).norm(), 1e-12);
  EXPECT_LT((a.bias() - b.bias()).norm(), 1e-11);
  for (int k = 0; k < 2000; ++k) {
    const VectorXd tau = VectorXd::Constant(dof, 12 * std::sin(0.01 * k)), zero = 0 * tau;
    a.set_input(tau, zero);
    b.set_input(tau, zero);
    ASSERT_LT((a.qdd() - b.qdd()).norm(), 1e-9);
    a.step(1e-3);
    b.step(1e-3);
  }
  EXPECT_GT((a.q() - q).norm(), 0.5) << "it has moved";
  EXPECT_LT((a.q() - b.q()).norm(), 1e-9);
  EXPECT_LT((a.qd() - b.qd()).norm(), 1e-9);
}

// a wheel that is geared to the shoulder is more inertia there: J ((1 + n)^2 - 1)
TEST(Ties, AGearedWheelIsItsArmature) {
  const std::string inertial = "<inertial pos='0 0 0' mass='.5' diaginertia='.002 .003 .002'/>";
  const double n = -7, J = 0.003;
  expect_one_motion(
      tied_model(upper("<joint name='wheel' axis='0 1 0' ref='.2'/>" + inertial),
                 "<joint joint1='wheel' joint2='shoulder' polycoef='.3 -7 0 0 0'/>"),
      tied_model(upper(inertial, fmt::format("armature='{}'", J * ((1 + n) * (1 + n) - 1)))), 1);
}

// a link that turns back as much as the arm turns only translates: a point mass at its pivot
TEST(Ties, AParallelogramIsAPointMass) {
  const std::string bar = "<inertial pos='.2 0 .1' mass='2' diaginertia='.1 .1 .1'/>";
  const std::string ball = "<inertial pos='0 0 0' mass='2' diaginertia='1e-15 1e-15 1e-15'/>";
  const Model parallelogram =
      tied_model(upper("<joint name='bar' axis='0 1 0'/>" + bar),
                 "<joint joint1='bar' joint2='shoulder' polycoef='0 -1 0 0 0'/>");
  expect_one_motion(parallelogram, tied_model(upper(ball)), 1);
  Plant plant(simulated(parallelogram));
  plant.set_state(VectorXd::Constant(1, 0.4), VectorXd::Zero(1));
  // .04 + 3 .2^2 of the upper arm, 2 kg at .5 m
  EXPECT_NEAR(plant.inertia()(0, 0), 0.04 + 3 * 0.04 + 2 * 0.25, 1e-12);
  EXPECT_NEAR(plant.bias()[0], -9.81 * (3 * 0.2 + 2 * 0.5) * std::sin(0.4), 1e-11);
}

TEST(Ties, FollowChainsWithTheirOffsetsAndReferences) {
  const std::string slide = "<inertial pos='0 0 0' mass='1' diaginertia='.1 .1 .1'/><joint type=";
  const Model m =
      tied_model("<body>" + slide + "'hinge' name='a' ref='.1'/><body>" + slide +
                     "'slide' name='b' ref='.2'/></body><body>" + slide +
                     "'slide' name='c' ref='.3'/></body></body><body>" + slide +
                     "'hinge' name='d'/></body><body>" + slide + "'hinge' name='e'/></body>",
                 // in MuJoCo's words: c - .3 = .01 + 2 (b - .2), b - .2 = .02 - 3 (a - .1), d = .5
                 "<joint joint1='c' joint2='b' polycoef='.01 2 0 0 0'/>"
                 "<joint joint1='b' joint2='a' polycoef='.02 -3 0 0 0'/>"
                 "<joint joint1='d' polycoef='.5 0 0 0 0'/>"
                 "<joint joint1='e' joint2='a' active='false'/>");
  const Ties t = ties_of(*m);
  ASSERT_EQ(t.free, (std::vector{0, 4})) << "an equality that is not active ties nothing";
  Eigen::MatrixXd T(5, 2);
  T << 1, 0, -3, 0, -6, 0, 0, 0, 0, 1;
  EXPECT_LT((t.T - T).norm(), 1e-15);
  const double b = 0.2 + 0.02 + 3 * 0.1, c = 0.3 + 0.01 + 2 * (b - 0.2);  // at a = 0
  EXPECT_LT((t.rho0 - (VectorXd(5) << 0, b, c, 0.5, 0).finished()).norm(), 1e-15);
  const AnyTree<2> arm = any_tree<2>(m);
  const MjcfArm<2> oracle(m);
  const Vec<2> q(0.4, -1.1), qd(0.7, -0.3), u(2, 3);
  const Mat<2> B = oracle.inertia(q);
  const Vec<2> bias = oracle.bias(q, qd);
  EXPECT_LT((arm.inertia(q) - B).norm(), 1e-12);
  EXPECT_LT((arm.bias(q, qd) - bias).norm(), 1e-12);
  EXPECT_LT((arm.gravity(q) - oracle.gravity(q)).norm(), 1e-12);
  EXPECT_LT((arm.momentum_bias(q, qd) - oracle.momentum_bias(q, qd)).norm(), 1e-6);
  EXPECT_LT((arm.dynamics(q, qd).bias - bias).norm() + (arm.dynamics(q, qd).B - B).norm(), 1e-12);
  const Dynamics<2> momentum = arm.momentum_dynamics(q, qd);
  EXPECT_LT((momentum.bias - arm.momentum_bias(q, qd)).norm() + (momentum.B - B).norm(), 1e-12);
  const ForwardDynamics<2> f = arm.forward_dynamics(q, qd, u);
  ASSERT_TRUE(f.ok);
  EXPECT_LT((B * f.qdd + bias + oracle.friction(qd) - u).norm(), 1e-11);
  EXPECT_LT((B * f.dqdd_dtau_ext + Mat<2>::Identity()).norm(), 1e-12);
  detail::Block<2> lanes_of_B;
  const auto lanes = arm.motion(q, qd, u - arm.dry_friction(qd), &lanes_of_B);
  EXPECT_LT((lanes.by_q.matrix() + B * f.dqdd_dq).norm(), 1e-12);
  EXPECT_LT((lanes_of_B.matrix() - B).norm(), 1e-12);
}

TEST(Ties, OfSeveralRunsAreThoseOfEachRun) {
  const AnyTree<2> arm = any_tree<2>(
      tied_model("<body><joint name='a' axis='0 1 0' damping='1' frictionloss='1'/>"
                 "<inertial pos='.1 0 .2' mass='2' diaginertia='.1 .2 .3'/>"
                 "<body pos='0 0 .3'><joint name='b' axis='0 1 0'/><inertial pos='0 0 .2' mass='1' "
                 "diaginertia='.1 .1 .1'/></body></body><body><joint name='c' axis='1 0 0'/>"
                 "<inertial pos='0 .1 .2' mass='1' diaginertia='.1 .1 .1'/></body>",
                 "<joint joint1='b' joint2='a' polycoef='0 2 0 0 0'/>"));
  constexpr int kWidth = 4;
  using Lanes = Pack<kWidth>;
  Measurement<2, Lanes> y;
  for (int i = 0; i < kWidth; ++i)
    put<2, kWidth>({.q = Vec<2>(0.4 * i, -1.1), .qd = Vec<2>(0.7, 0.3 - i)}, i, y);
  RunTerms<2, Lanes> terms({.joints = 2, .size = 1, .q = y.q.data(), .qd = y.qd.data()});
  for (const auto& runs : {arm.with<Lanes>(), arm.with<Lanes>().within(terms)}) {
    for (int asked = 1; asked <= 2; ++asked) {  // the second time from memory
      const auto both = runs.dynamics(y.q, y.qd), momentum = runs.momentum_dynamics(y.q, y.qd);
      const Vec<2, Lanes> friction = runs.friction(y.qd), gravity = runs.gravity(y.q);
      for (int i = 0; i < kWidth; ++i) {
        const auto of = [i](const Lanes& x) { return x[i]; };
        const Vec<2> q = y.q.unaryExpr(of), qd = y.qd.unaryExpr(of);
        EXPECT_EQ(both.B.unaryExpr(of), arm.dynamics(q, qd).B);
        EXPECT_EQ(both.bias.unaryExpr(of), arm.dynamics(q, qd).bias);
        EXPECT_EQ(momentum.B.unaryExpr(of), arm.momentum_dynamics(q, qd).B);
        EXPECT_EQ(momentum.bias.unaryExpr(of), arm.momentum_dynamics(q, qd).bias);
        EXPECT_EQ(friction.unaryExpr(of), arm.friction(qd));
        EXPECT_EQ(gravity.unaryExpr(of), arm.gravity(q));
        EXPECT_EQ(runs.inertia(y.q).unaryExpr(of), arm.inertia(q));
        EXPECT_EQ(runs.bias(y.q, y.qd).unaryExpr(of), arm.bias(q, qd));
        EXPECT_EQ(runs.momentum_bias(y.q, y.qd).unaryExpr(of), arm.momentum_bias(q, qd));
      }
    }
  }
}

// two wheels that brake one joint brake it twice as fast, and one rotor's inertia mends both
TEST(Ties, FrictionOfFollowersAddsUp) {
  const std::string wheel = "<inertial pos='0 0 0' mass='.5' diaginertia='.002 .003 .002'/>";
  const auto wheels = [&](const char* damping) {
    return tied_model(
        fmt::format("<body><joint name='a' axis='0 1 0' damping='{0}' frictionloss='1'/>{1}</body>"
                    "<body><joint name='b' axis='0 1 0' damping='{0}' frictionloss='1'/>{1}</body>",
                    damping, wheel),
        "<joint joint1='b' joint2='a'/>");
  };
  const ArmTree arm = tree_of(wheels("1"));
  EXPECT_NEAR(arm.friction_rate[0], 2 / 0.006, 1e-9);
  EXPECT_NEAR(arm.joints[1].v_s, 2 / 0.006 / 500, 1e-12) << "as smooth as both allow";
  EXPECT_EQ(too_stiff(wheels("1.4")), "");
  EXPECT_NE(too_stiff(wheels("1.6")).find("armature"), std::string::npos);
}

TEST(Ties, ErrorsOfTheModelAreOfJointsThatFollowNoOther) {
  const Model m =
      tied_model(upper("<joint name='wheel' axis='0 1 0'/><inertial pos='0 0 0' mass='.5' "
                       "diaginertia='.002 .003 .002'/>"),
                 "<joint joint1='wheel' joint2='shoulder' polycoef='0 -7 0 0 0'/>");
  const Model wrong = with_errors(simulated(m), {.friction = 3, .armature = 0.2});
  Plant plant(wrong), right(simulated(m));
  for (Plant* p : {&plant, &right})
    p->set_state(VectorXd::Constant(1, 0.4), VectorXd::Constant(1, 1));
  EXPECT_NEAR((plant.inertia() - right.inertia())(0, 0), 0.2, 1e-12);
  EXPECT_NEAR((plant.friction() - right.friction())[0], 3, 1e-9);
}

TEST(Ties, ATiedArmMustStayOffItsLimits) {
  const Model m = simulated(tied_model(
      upper("<joint name='bar' axis='0 1 0'/><inertial pos='.1 0 0' mass='1' diaginertia='.1 .1 "
            ".1'/>",
            "limited='true' range='-.5 .5'"),
      "<joint joint1='bar' joint2='shoulder' polycoef='0 -1 0 0 0'/>"));
  Plant plant(m);
  plant.set_state(VectorXd::Constant(1, 0.6), VectorXd::Zero(1));
  EXPECT_TRUE(plant.is_tied());
  EXPECT_EQ(plant.joints_at_limits(), std::vector{0});
}

// held by a number, off its reference: a link that is bent, once and for all
TEST(Ties, AJointThatIsHeldIsABentLink) {
  const std::string hand =
      "<body pos='0 0 .3'><joint name='wrist' axis='0 1 0'/><inertial pos='.1 0 "
      ".1' mass='1' diaginertia='.1 .1 .1'/></body>";
  const std::string bar = "<inertial pos='.2 0 .1' mass='2' diaginertia='.1 .1 .1'/>";
  const std::string held = upper("<joint name='held' axis='0 1 0'/>" + bar + hand);
  std::string bent = upper(bar + hand);
  const std::string place = "<body pos='0 0 .5'>";
  bent.replace(bent.find(place), place.size(), "<body pos='0 0 .5' euler='0 .5 0'>");
  expect_one_motion(tied_model(held, "<joint joint1='held' polycoef='.5 0 0 0 0'/>"),
                    tied_model(bent), 2);
}

// a blow is for the hand, not for a finger of it
TEST(Ties, TheEndEffectorIsNoFinger) {
  const std::string finger =
      "<inertial pos='0 0 .1' mass='.1' diaginertia='.01 .01 .01'/><joint type='slide' ";
  const std::string hand =
      "<body name='hand' pos='0 0 .3'><joint name='wrist' axis='1 0 0'/><inertial pos='0 .1 "
      "0' mass='1' diaginertia='.1 .1 .1'/><body>" +
      finger + "name='l'/></body><body>" + finger + "name='r'/></body></body>";
  const Model m =
      tied_model(upper("<inertial pos='0 0 0' mass='1' diaginertia='.1 .1 .1'/>" + hand),
                 "<joint joint1='l' joint2='r'/>");
  const ArmTree arm = tree_of(m);
  EXPECT_NE(arm.end_effector.find("body 'hand'"), std::string::npos) << arm.end_effector;
  EXPECT_EQ(arm.point("end_effector").joint, 1);
  Plant plant(simulated(m));
  plant.set_state(VectorXd::Zero(3), VectorXd::Zero(3));
  EXPECT_LT((plant.end_effector().position - Vec<3>(0, .1, .8)).norm(), 1e-12);
}

TEST(Ties, RangesOfFollowersAreRangesOfTheirLeader) {
  const std::string body = "<inertial pos='0 0 0' mass='1' diaginertia='.1 .1 .1'/><joint ";
  const std::string bodies = "<body>" + body + "name='a' limited='true' range='-1 2'/><body>" +
                             body + "name='b' limited='true' range='-1 1'/></body></body>";
  const std::string tie = "<joint joint1='b' joint2='a' polycoef='.2 -.8 0 0 0'/>";
  const ArmTree arm = tree_of(tied_model(bodies, tie));
  EXPECT_EQ(arm.dof(), 1);
  EXPECT_NEAR(arm.lower[0], -1, 1e-12);
  EXPECT_NEAR(arm.upper[0], 1.5, 1e-12) << "where b comes to -1";
}

TEST(Ties, AtMostEightFollow) {
  std::string bodies = "<body><joint name='j0'/><geom size='.1'/></body>", ties;
  for (int i = 1; i < 10; ++i) {
    bodies += fmt::format("<body><joint name='j{}'/><geom size='.1'/></body>", i);
    ties += fmt::format("<joint joint1='j{}' joint2='j0'/>", i);
  }
  const Model m = tied_model(bodies, ties);
  EXPECT_EQ(error_of([&] { any_tree<1>(m); }),
            "9 joints follow others, and at most 8 may; --lock REGEX fixes them");
  EXPECT_NE(error_of([&] { tree_model<1>(m); }), "no error");
}

TEST(Ties, ThatCannotBeKeptAreNamed) {
  const auto error = [](const std::string& equality) {
    const std::string body = "<inertial pos='0 0 0' mass='1' diaginertia='.1 .1 .1'/><joint name=";
    return error_of([&] {
      tree_of(tied_model("<body name='one'>" + body + "'a' limited='true' range='-1 1'/><body>" +
                             body + "'b' limited='true' range='-1 1'/></body></body><body>" + body +
                             "'c'/></body>",
                         equality));
    });
  };
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  EXPECT_EQ(error("<joint joint1='a' joint2='b'/>"), "no error");
  has(error("<joint joint1='a' joint2='b'/><joint joint1='b' joint2='a'/>"),
      "follows itself; --lock REGEX");
  has(error("<joint joint1='a' joint2='b'/><joint joint1='a' joint2='c'/>"),
      "joint 'a' follows two others");
  has(error("<joint joint1='a' joint2='b' polycoef='0 1 .1 0 0'/>"),
      "'a' follows another by a pol");
  has(error("<joint joint1='a' joint2='b' polycoef='9 1 0 0 0'/>"),
      "joint 2 'b': its range and those of the joints that follow it");
  has(error("<joint joint1='a' polycoef='2 0 0 0 0'/>"), "joint 1 'a' is held at 2, outside its r");
  has(error("<joint joint1='a' joint2='b' polycoef='1e9 1 0 0 0'/>"), "polycoef is 1e+09");
  has(error("<connect body1='one' anchor='0 0 0'/>"), "body 'one' is tied to");
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
// The testbed's MJCF against (35)-(37), the load against the laws of a pendulum, the obstacle
// against its own spring.
#include "estimators/testbed1.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <numbers>

#include "mjcf/record.h"
#include "mjcf/trace/random.h"

namespace tauext::test {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

VectorXd vec(double x) {
  return VectorXd::Constant(1, x);
}

void expect_agreement(const Model& model, const Testbed1::Parameters& p) {
  Plant plant(model);
  const Testbed1 arm(p);
  Random random(1);
  double B = 0, bias = 0, friction = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec<1> q(random.uniform(-1.5, 1.5));
    // full slip: below 0.005 rad/s MuJoCo's dry friction is a steep ramp
    const Vec<1> qd((i % 2 ? 1 : -1) * random.uniform(0.01, 3));
    plant.set_state(q, qd);
    plant.set_input(plant.bias(), vec(0));  // free of gravity; MuJoCo's friction looks 1 ms ahead
    B = std::max(B, std::abs(plant.inertia()(0, 0) - p.theta1));
    bias = std::max(bias, std::abs(plant.bias()[0] - arm.bias(q, qd)[0]));
    friction = std::max(friction, std::abs(plant.friction()[0] - arm.friction(qd)[0]));
  }
  EXPECT_LT(B, 1e-9 * p.theta1);
  EXPECT_LT(bias, 1e-9 * p.theta2 * p.g);
  EXPECT_LT(friction, 1e-9 * p.theta4);
}

TEST(Testbed1Mjcf, AgreesWithEquation36InInertiaGravityAndFriction) {
  expect_agreement(load_robot("testbed1"), Testbed1::Parameters::raw_sign());
}

// with g inside theta_2 and theta_3, as Testbed1::Parameters::absorbed() has it: first moments are
// divided by 9.81, inertia and friction as they are
Model testbed1_absorbed() {
  return changed(load_robot("testbed1"), [](mjModel& m) {
    const int arm = mj_name2id(&m, mjOBJ_BODY, "arm");
    const double g = -m.opt.gravity[2];
    const double mass = m.body_mass[arm] / g;
    // theta_1 = I + m r^2: the first moment shrinks with the mass, and I takes what m r^2 loses
    const double* const r = m.body_ipos + 3 * arm;
    m.body_inertia[3 * arm + 1] += (m.body_mass[arm] - mass) * (r[0] * r[0] + r[2] * r[2]);
    m.body_mass[arm] = mass;
  });
}

TEST(Testbed1Mjcf, AbsorbedAgreesWithEquation36WithoutG) {
  Testbed1::Parameters p = Testbed1::Parameters::absorbed();
  p.v_s = 0;
  expect_agreement(testbed1_absorbed(), p);
}

TEST(Testbed1Mjcf, AWeightAtItsTipIsEquation35) {
  Plant plant(load_robot("testbed1"));
  for (const double q : {-0.4, 0., 0.5}) {
    plant.set_state(vec(q), vec(0));
    const double expected = 3.3 * 9.81 * 0.70 * std::cos(q);
    EXPECT_NEAR(plant.tau_ext_of({0, 0, -3.3 * 9.81}, plant.place("end_effector"))[0], expected,
                1e-12);
  }
}

TEST(Testbed1Mjcf, DryFrictionHoldsTheArmBelowItsLevelAndNotAbove) {
  Plant plant(load_robot("testbed1"));
  for (const double excess : {-0.1, 0.1}) {  // [N m] beyond theta_4
    plant.set_state(vec(0.5), vec(0));
    for (int k = 0; k < 500; ++k) {
      plant.set_input(plant.bias() + vec(2.163 + excess), vec(0));
      plant.step(1e-3);
    }
    // stuck it creeps at most at the speed of the ramp; free, 0.1 N m / theta_1 drive it for 0.5 s
    if (excess < 0) {
      EXPECT_LT(plant.qd()[0], 0.005);
    } else {
      EXPECT_NEAR(plant.qd()[0], 0.1 / 0.41937 * 0.5, 0.02);
    }
  }
}

// the arm with a load of 1 kg, held at q = 0.5 rad by a torque that never lets it move
struct Hung {
  explicit Hung(const Vector3d& kick) {
    plant.set_state(vec(0.5), vec(0));
    plant.hang_load();
    plant.push_load(kick);
  }
  // one millisecond; position of the load relative to the tip
  Vector3d step() {
    const Point tip = plant.site("end_effector");
    const double e = 0.5 - plant.q()[0];
    plant.set_input(plant.bias() + plant.tau_ext() + vec(0.42 * (4e4 * e - 400 * plant.qd()[0])),
                    vec(0));
    plant.step(1e-3);
    return Eigen::Map<const Vector3d>(plant.data().qpos + 1) - tip.position;
  }
  Plant plant{load_robot("testbed1", "load")};
};

TEST(Load, HungOnItPullsWithItsWeightAtOnceAndStaysThere) {
  Hung hung(Vector3d::Zero());
  const double expected = 9.81 * 0.70 * std::cos(0.5);
  EXPECT_NEAR(hung.plant.tau_ext()[0], expected, 1e-9);
  for (int k = 0; k < 3000; ++k) hung.step();
  EXPECT_NEAR(hung.plant.tau_ext()[0], expected, 0.01);
}

TEST(Load, SwingsWithThePeriodOfItsPendulum) {
  Hung hung({0.2, 0, 0});  // a push for 0.1 s, then left alone
  std::vector<double> crossings;
  double before = 0;
  for (int k = 0; k < 15000; ++k) {
    if (k == 100) hung.plant.push_load(Vector3d::Zero());
    const double x = hung.step().x();
    if (before < 0 && x >= 0) crossings.push_back(1e-3 * (k + x / (before - x)));
    before = x;
  }
  ASSERT_GT(crossings.size(), 5u);
  const double period =
      (crossings.back() - crossings[0]) / static_cast<double>(crossings.size() - 1);
  const double length = 0.4 + 9.81 / 4000;  // the tether, stretched
  EXPECT_NEAR(period, 2 * std::numbers::pi * std::sqrt(length / 9.81), 0.002) << "s";
}

TEST(Load, DroppedItFallsFreelyAndLeavesTheArmAlone) {
  Hung hung(Vector3d::Zero());
  for (int k = 0; k < 100; ++k) hung.step();
  hung.plant.drop_load();
  hung.step();
  const Eigen::Map<const Vector3d> load(hung.plant.data().qpos + 1);
  const double start = load.z();
  EXPECT_EQ(hung.plant.tau_ext()[0], 0);
  for (int k = 0; k < 200; ++k) hung.step();
  // from a speed of one step, with 0.05 N s/m of damping
  EXPECT_NEAR(start - load.z(), 9.81 * (0.2 * 0.2 / 2 + 0.2e-3), 0.002) << "m";
}

TEST(Load, WhereItSwingsTheTetherPullsWithGravityAndCentripetalForce) {
  // tension = m (g cos a + v^2 / L) for a rigid tether; ours stretches by 2.5 mm
  Hung hung({1.5, 0, 0});
  const auto speed = [&] { return Eigen::Map<const Vector3d>(hung.plant.data().qvel + 1).norm(); };
  double worst = 0, swing = 0;
  for (int k = 0; k < 5000; ++k) {
    if (k == 300) hung.plant.push_load(Vector3d::Zero());
    const Vector3d r = hung.step();
    if (k < 1000) continue;
    const double expected = 9.81 * -r.z() / r.norm() + speed() * speed() / r.norm();
    const double tension = -hung.plant.data().actuator_force[2];
    worst = std::max(worst, std::abs(tension - expected));
    swing = std::max(swing, std::abs(r.x()) / r.norm());
  }
  EXPECT_GT(swing, 0.1) << "rad, or this shows nothing";
  EXPECT_LT(worst, 0.15) << "N of 9.81";
}

TEST(Obstacle, PushesBackWithTheForceOfItsSpring) {
  Plant plant(load_robot("testbed1", "obstacle"));
  plant.set_state(vec(0.498), vec(0));
  EXPECT_EQ(plant.contact_force(), 0);
  for (int k = 0; k < 2000; ++k) {  // pushed against it until all is at rest
    plant.set_input(plant.bias() + vec(120 - 4 * plant.qd()[0]), vec(0));
    plant.step(1e-3);
  }
  const double force = plant.contact_force(), compression = plant.data().qpos[1];
  EXPECT_NEAR(force, 75000 * compression + 0.6 * 9.81, 1e-3 * force) << "N";
  EXPECT_GT(force, 150);
  // vertical and without friction, so only its lever r cos q counts (35)
  EXPECT_NEAR(plant.tau_ext()[0], force * 0.7 * std::cos(plant.q()[0]), 1e-9);
}

TEST(Obstacle, HitsWithAForceThatDoesNotDependOnTheStep) {
  const Scenario& s = scenario("testbed1", "collision");
  const auto peak = [&](int substeps) {
    const Trace t = record(load_for("testbed1", s), s, {}, {.substeps = substeps});
    return *std::max_element(t.contact_force.begin(), t.contact_force.end());
  };
  EXPECT_NEAR(peak(1), peak(4), 1e-3 * peak(4));
}

// section 6.1: "the robot end-effector moves upward until it reaches the upper limit position and
// stops"
TEST(Buttons, DriveTheArmToItsLimitWhereItStops) {
  const Scenario& s = scenario("testbed1", "button");
  const Trace t = record(load_for("testbed1", s), s);
  constexpr double kUpper = 0.6, kLower = -0.4;  // [rad]
  const auto q = [&](double at) { return t.q(0, std::lround(at * 1000)); };
  const auto qd = [&](double at) { return t.qd(0, std::lround(at * 1000)); };
  // pressed at 1, 6, 11, 16, 21 s; 1 rad at 0.25 rad/s takes 4.1 s; 8 N m hang on some 17 kN m/rad
  EXPECT_NEAR(q(0.9), kLower, 1e-3);
  EXPECT_NEAR(qd(3), 0.25, 1e-3);
  for (const double at : {5.5, 15.5, 29.}) EXPECT_NEAR(q(at), kUpper, 2e-3) << at;
  for (const double at : {10.5, 20.5}) EXPECT_NEAR(q(at), kLower, 2e-3) << at;
  for (const double at : {5.5, 10.5, 15.5, 20.5, 29.}) EXPECT_NEAR(qd(at), 0, 2e-3) << at;
  EXPECT_LT(t.q.maxCoeff(), kUpper + 2e-3);
  EXPECT_GT(t.q.minCoeff(), kLower - 2e-3);
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
// (33)-(34) against MuJoCo's tendon between the same two points.
#include "mjcf/trace/screw.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>

#include "mjcf/plant/plant.h"

namespace tauext::test {
namespace {

using Eigen::VectorXd;

VectorXd vec(double x) {
  return VectorXd::Constant(1, x);
}

TEST(Screw, OfTheTestbedIsTheTriangle345WithTheArmLevel) {
  const Plant plant(load_robot("testbed1"));
  ASSERT_EQ(plant.screws().size(), 1u);
  const Screw& s = plant.screws()[0];
  EXPECT_NEAR(s.a, 0.3, 1e-15);
  EXPECT_NEAR(s.c, 0.4, 1e-15);
  EXPECT_NEAR(s.length(0), 0.5, 1e-15);
  EXPECT_NEAR(s.lever(0), 0.24, 1e-15) << "m: a sin Theta = 0.3 * 4/5";
}

TEST(Screw, LengthAndLeverAreTheTendonsAndThoseOf33And34) {
  Plant plant(load_robot("testbed1"));
  const Screw& s = plant.screws()[0];
  for (double q = -0.9; q < 1.2; q += 0.05) {
    plant.set_state(vec(q), vec(0));
    EXPECT_NEAR(plant.data().actuator_length[1], s.length(q), 1e-14);
    EXPECT_NEAR(plant.data().actuator_moment[1], s.lever(q), 1e-14);
    EXPECT_NEAR(s.a * std::sin(s.angle(q)), s.lever(q), 1e-13);
  }
}

TEST(Screw, DrivesTheArmAsTheTorqueOfEquation33Does) {
  Plant plant(load_robot("testbed1"));
  constexpr double kForce = 450;  // [N]
  for (const double q : {-0.4, 0., 0.6}) {
    plant.set_state(vec(q), vec(0.2));
    plant.set_input(vec(kForce * plant.screws()[0].lever(q)), vec(0));
    const double by_torque = plant.qdd()[0];
    mjData* const d = const_cast<mjData*>(&plant.data());
    d->ctrl[0] = 0;
    d->ctrl[1] = kForce;
    mj_forward(&plant.model(), d);
    EXPECT_NEAR(plant.qdd()[0], by_torque, 1e-10);
  }
}

TEST(Screw, IsFoundWhateverWayTheJointTurns) {
  // the same arm with its hinge about +y: q changes its sign, and the lever with it
  const Model plain = load_robot("testbed1");
  Plant turned(changed(plain, [](mjModel& m) { m.jnt_axis[1] = 1; }));
  const Screw s = Plant(plain).screws()[0], t = turned.screws()[0];
  EXPECT_EQ(t.sense, -s.sense);
  for (const double q : {-0.4, 0., 0.6}) {
    EXPECT_NEAR(t.length(-q), s.length(q), 1e-14);
    EXPECT_NEAR(t.lever(-q), -s.lever(q), 1e-14);
  }
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/plant.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <limits>

#include "mjcf/plant/mjcf_file.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

// the robot with one field changed
template <class Change>
Model changed_robot(Change&& change) {
  mjModel* const m = mj_copyModel(nullptr, load_robot("wallmobot3").get());
  change(m);
  return Model(m, [](const mjModel* p) { mj_deleteModel(const_cast<mjModel*>(p)); });
}

TEST(Plant, GivesBackTheStateItWasPutIn) {
  Plant plant(load_robot("wallmobot3"));
  const VectorXd q = Eigen::Vector3d(0.1, -0.2, 0.3), qd = Eigen::Vector3d(1, 2, -3);
  plant.set_state(q, qd);
  EXPECT_LT((plant.q() - q).norm(), 1e-15);
  EXPECT_LT((plant.qd() - qd).norm(), 1e-15);
}

TEST(Plant, EquationThreeHoldsAtOnceAfterAnInput) {
  Plant plant(load_robot("wallmobot3"));
  plant.set_state(Eigen::Vector3d(0.1, -0.2, 0.3), Eigen::Vector3d(1, 2, -3));
  const VectorXd tau = Eigen::Vector3d(10, 20, 30), tau_ext = Eigen::Vector3d(5, -7, 9);
  plant.set_input(tau, tau_ext);
  const VectorXd residual =
      plant.inertia() * plant.qdd() + plant.bias() + plant.friction() + tau_ext - tau;
  EXPECT_LT(residual.norm(), 1e-10);
}

TEST(Plant, APositiveTauExtPushesTheJointBack) {
  // the sign of (3): tau_ext stands on the side of B qdd
  Plant plant(load_robot("wallmobot3"));
  const VectorXd zero = VectorXd::Zero(3);
  plant.set_state(zero, zero);
  plant.set_input(plant.bias(), zero);
  EXPECT_LT(plant.qdd().norm(), 1e-12);
  plant.set_input(plant.bias(), Eigen::Vector3d(0, 0, 1));
  EXPECT_LT(plant.qdd()[2], 0);
}

TEST(Plant, RefusesModelsWithoutJointCoordinatesAndSaysWhy) {
  const auto expect = [](auto change, const char* why) {
    const std::string error = error_of([&] { Plant(changed_robot(change)); });
    EXPECT_NE(error.find(why), std::string::npos) << error;
  };
  expect([](mjModel* m) { m->nu = 2; }, "no motor of its own");
  expect([](mjModel* m) { m->actuator_gainprm[0] = 2; }, "tau2");
  expect([](mjModel* m) { m->opt.integrator = mjINT_EULER; }, "RK4");
  // two actuators on one joint: lengths that say the same
  expect([](mjModel* m) { m->actuator_trnid[4] = 0; }, "move 2 degrees of freedom");
}

TEST(Plant, TurnsAMuJoCoWarningIntoAnError) {
  Plant plant(load_robot("wallmobot3"));
  const VectorXd zero = VectorXd::Zero(3);
  plant.set_state(zero, zero);
  plant.set_input(VectorXd::Constant(3, 1e15), zero);
  const std::string error = error_of([&] {
    for (int i = 0; i < 10; ++i) plant.step(1e-3);
  });
  EXPECT_NE(error.find("MuJoCo warned at t = "), std::string::npos) << error;
}

TEST(Plant, UnknownSiteIsNamed) {
  Plant plant(load_robot("wallmobot3"));
  EXPECT_EQ(error_of([&] {
              plant.tau_ext_of({1, 0, 0}, plant.place("elbow"));
            }),
            "the robot has no site or body 'elbow'");
}

// two arms that an equality constraint couples, with dry friction; the tip of one rests on the
// floor
constexpr const char* kCoupled = R"(<mujoco>
  <option timestep="0.001" integrator="RK4"/>
  <default><geom contype="0" conaffinity="0"/></default>
  <worldbody>
    <geom name="floor" type="plane" size="2 2 0.1" contype="1" conaffinity="1" condim="1"/>
    <body name="a" pos="0 0 0.5">
      <joint name="a" type="hinge" axis="0 1 0" frictionloss="1"/>
      <inertial pos="0.5 0 0" mass="2" diaginertia="0.1 0.1 0.1"/>
      <geom type="sphere" size="0.05" pos="1 0 0" contype="1" conaffinity="1" condim="1"/>
      <site name="end_effector" pos="1 0 0"/>
    </body>
    <body name="b" pos="0 1 0.5">
      <joint name="b" type="hinge" axis="0 1 0" frictionloss="1"/>
      <inertial pos="0.5 0 0" mass="1" diaginertia="0.1 0.1 0.1"/>
    </body>
  </worldbody>
  <equality><joint joint1="a" joint2="b"/></equality>
  <actuator><motor joint="a"/><motor joint="b"/></actuator>
</mujoco>)";

TEST(Plant, TheTruthOfAContactHoldsNeitherFrictionNorEqualityConstraints) {
  Plant plant(load_files({{"coupled.xml", kCoupled}}));
  const double down = std::asin(0.455);  // the tip's sphere is 5 mm in the floor
  plant.set_state(Vector2d(down, down), Vector2d(0.1, 0.1));
  plant.set_input(Vector2d(0, 30), Vector2d::Zero());  // the coupling carries the difference
  const double force = plant.contact_force();
  ASSERT_GT(force, 10) << "N";
  // the floor pushes up with that force at 1 m cos q from the hinge, which turns x to -z
  EXPECT_NEAR(plant.tau_ext()[0], force * std::cos(down), 1e-9 * force);
  EXPECT_EQ(plant.tau_ext()[1], 0) << "nothing touches the other arm";
  const VectorXd rest = plant.tau() - plant.inertia() * plant.qdd() - plant.bias() -
                        plant.friction() - plant.tau_ext();
  EXPECT_GT(rest.norm(), 1) << "N m, which is the equality constraint's";
  EXPECT_NEAR(rest[0], -rest[1], 1e-9) << "and acts on both alike";
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant.h"

#include <gtest/gtest.h>

#include <limits>

#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

using Eigen::VectorXd;

// the robot with one field changed
template <class Change>
Model changed(Change&& change) {
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
  EXPECT_NE(
      error_of([] { Plant(changed([](mjModel* m) { m->nu = 2; })); }).find("no motor of its own"),
      std::string::npos);
  EXPECT_NE(
      error_of([] { Plant(changed([](mjModel* m) { m->actuator_gainprm[0] = 2; })); }).find("tau2"),
      std::string::npos);
  EXPECT_NE(error_of([] {
              Plant(changed([](mjModel* m) { m->opt.integrator = mjINT_EULER; }));
            }).find("RK4"),
            std::string::npos);
  // two actuators on one joint: lengths that say the same
  EXPECT_NE(error_of([] {
              Plant(changed([](mjModel* m) { m->actuator_trnid[4] = 0; }));
            }).find("move 2 degrees of freedom"),
            std::string::npos);
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
              plant.tau_ext_of({1, 0, 0}, "elbow");
            }),
            "the robot has no site 'elbow'");
}

}  // namespace
}  // namespace tauext::test

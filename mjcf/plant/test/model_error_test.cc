// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/model_error.h"

#include <gtest/gtest.h>

#include "estimators/testbed1.h"
#include "estimators/wallmobot3.h"
#include "mjcf/plant/plant.h"
#include "mjcf/test/error_of.h"

namespace tauext::test {
namespace {

const Vec<3> kQ{0.3, -0.4, 0.7}, kQd{0.5, -1, 0.8};

Plant plant(const ModelError& e) {
  Plant p(with_errors(load_robot("wallmobot3"), e));
  p.set_state(kQ, kQd);
  p.set_input(Vec<3>(10, 20, 30), Vec<3>::Zero());
  return p;
}

// B and C qd + g of the plant against a closed form
void expect_dynamics(const Plant& p, const WallMoBot3& arm) {
  EXPECT_LT((p.inertia() - arm.inertia(kQ)).norm(), 1e-9 * arm.inertia(kQ).norm());
  EXPECT_LT((p.bias() - arm.bias(kQ, kQd)).norm(), 1e-9 * arm.bias(kQ, kQd).norm());
}

TEST(ModelError, NoneChangesNothing) {
  const Model m = load_robot("wallmobot3");
  EXPECT_EQ(with_errors(m, {}), m);
}

TEST(ModelError, MassScalesTheLastLinkAndItsInertia) {
  WallMoBot3::Parameters p;
  p.m5 *= 1.05;
  p.Izz5 *= 1.05;
  expect_dynamics(plant({.mass = 1.05}), WallMoBot3(p));
}

TEST(ModelError, ComMovesTheLastLinksCentreOfMassAwayFromItsJoint) {
  WallMoBot3::Parameters p;
  const double r = std::hypot(p.com5_x, p.com5_y), far = (r + 0.02) / r;
  p.com5_x *= far;
  p.com5_y *= far;
  p.Izz5 += p.m5 * ((r + 0.02) * (r + 0.02) - r * r);  // about the joint
  expect_dynamics(plant({.com = 0.02}), WallMoBot3(p));
}

// hinges turn by S^-1 qd = (qd1, qd2 - qd1, qd3); a torque f on them is S^-T f on the joints
Vec<3> on_joints(const Vec<3>& f) {
  return {f[0] - f[1], f[1], f[2]};
}
const Vec<3> kHinges{kQd[0], kQd[1] - kQd[0], kQd[2]};

TEST(ModelError, ViscousFrictionIsOnEveryHinge) {
  const Plant p = plant({.viscous = 3});
  EXPECT_LT((p.friction() - on_joints(3 * kHinges)).norm(), 1e-9);
}

TEST(ModelError, DryFrictionIsFullOnEveryHingeThatSlips) {
  const Plant p = plant({.friction = 5});
  EXPECT_LT((p.friction() - on_joints(5 * kHinges.cwiseSign())).norm(), 1e-3 * 5);
}

TEST(ModelError, DryFrictionIsNoExternalTorque) {
  EXPECT_EQ(plant({.friction = 5}).tau_ext().norm(), 0);
}

TEST(ModelError, ArmatureAddsToTheInertiaOfEveryHinge) {
  Mat<3> on_hinges = Mat<3>::Identity();
  on_hinges(1, 0) = -1;  // d hinge / d q
  const Mat<3> expected = WallMoBot3().inertia(kQ) + 0.5 * on_hinges.transpose() * on_hinges;
  EXPECT_LT((plant({.armature = 0.5}).inertia() - expected).norm(), 1e-9 * expected.norm());
}

TEST(ModelError, AddsToTheFrictionThatARobotHas) {
  Plant p(with_errors(load_robot("testbed1"), {.friction = 1}));
  p.set_state(Vec<1>(0.1), Vec<1>(0.2));
  p.set_input(Vec<1>(110), Vec<1>(0));
  EXPECT_NEAR(p.friction()[0], Testbed1::Parameters().theta4 + 1, 1e-3);
}

TEST(ModelError, RefusesWhatNoRobotHas) {
  EXPECT_EQ(error_of([] { with_errors(load_robot("testbed1"), {.mass = 0}); }),
            "model error mass [1] must be 0.01 to 100, not 0");
  EXPECT_EQ(error_of([] { with_errors(load_robot("testbed1"), {.armature = -1}); }),
            "model error armature [kg m^2] must be 0 to 10000, not -1");
}

}  // namespace
}  // namespace tauext::test

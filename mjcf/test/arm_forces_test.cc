// SPDX-License-Identifier: Apache-2.0
#include "mjcf/arm_forces.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "estimators/higher_order_momentum_observer.h"
#include "mjcf/plant/plant.h"
#include "mjcf/plant/simulated.h"
#include "mjcf/plant/tree.h"
#include "mjcf/record.h"
#include "mjcf/scenarios/generic.h"
#include "mjcf/trace/random.h"

namespace tauext::test {
namespace {

using Eigen::Vector3d, Eigen::VectorXd;

const std::string kExamples = "bench/examples";

Model arm7() {
  return simulated(load_mjcf(kExamples + "/arm7.xml", {"finger.*"}));
}

// of a trace with a force: what is found makes the truth's torques, by MuJoCo's Jacobian, and is
// the scenario's where the joints see all of it
void expect_exact(const Model& model, const Trace& t, bool all_is_seen) {
  ASSERT_EQ(t.force.cols(), t.size());
  Plant plant(model);
  const auto forces = arm_forces(model);
  const double most = t.tau_ext.cwiseAbs().maxCoeff();
  int seen = 0, acts = 0;
  for (int k = 0; k < t.size(); ++k) {
    if (t.force.col(k).isZero(0)) continue;
    ++acts;
    const VectorXd q = t.q.col(k), tau_ext = t.tau_ext.col(k);
    const SiteForce s = forces->at_site(q.data(), tau_ext.data());
    ASSERT_LT((forces->torque(q, t.force.col(k)) - tau_ext).norm(), 1e-10 * most) << t.t[k];
    plant.set_state(q, VectorXd::Zero(q.size()));
    ASSERT_LT((plant.tau_ext_of(s.force) - tau_ext).norm(), 1e-9 * most) << t.t[k];
    if (s.seen.head<3>().minCoeff() < 1 - 1e-9) continue;
    ++seen;
    ASSERT_LT((s.force - t.force.col(k)).norm(), 1e-9) << t.t[k];
    ASSERT_LT(s.left_over, 1e-9) << t.t[k];
  }
  EXPECT_GT(acts, 20);
  EXPECT_EQ(seen > 0, all_is_seen);
}

TEST(ArmForces, OfTheTruthAreTheScenarios) {
  for (const char* name : {"blow", "contact", "clamp"}) {
    SCOPED_TRACE(name);
    const Model model = arm7();
    for (const Scenario& s : generic_scenarios(model)) {
      if (s.name == name) expect_exact(model, record(model, s), true);
    }
  }
  const Scenario& s = scenario("wallmobot3", "push");
  expect_exact(load_for("wallmobot3", s), record(load_for("wallmobot3", s), s), false);
}

TEST(ArmForces, AreNotToldWhereSomethingElseActs) {
  const auto force_of = [](const char* robot, const char* name) {
    const Scenario& s = scenario(robot, name);
    return record(load_for(robot, s), s).force.cols();
  };
  EXPECT_EQ(force_of("wallmobot3", "step"), 0) << "torques of joints";
  EXPECT_EQ(force_of("wallmobot3", "free"), 0);
  EXPECT_EQ(force_of("testbed1", "collision"), 0) << "MuJoCo's contact";
}

TEST(ArmForces, OfAPointAreWhatActsThere) {
  const Model model = arm7();
  const auto at_hand = arm_forces(model, {.site = "hand", .moment = true});
  const auto at_end = arm_forces(model, {.moment = true});
  const VectorXd q = scale_of(model).home;
  const Vector3d f(10, -20, 5);
  const VectorXd tau = at_end->torque(q, f);
  const SiteForce hand = at_hand->at_site(q.data(), tau.data());
  const SiteForce end = at_end->at_site(q.data(), tau.data());
  ASSERT_GT(hand.seen.minCoeff(), 1 - 1e-9);
  EXPECT_LT((hand.force - f).norm(), 1e-9);
  EXPECT_LT((end.force - f).norm(), 1e-9);
  EXPECT_LT(end.moment.norm(), 1e-9);
  // the site is 9 cm beyond the hand, along the last joint's axis
  EXPECT_NEAR(hand.moment.norm() / f.norm(), 0.09, 0.09);
  EXPECT_NEAR(hand.moment.dot(f), 0, 1e-9);
  EXPECT_GT(hand.moment.norm(), 0.1);
}

// the torques of a touch of one finger are those of another touch of the other one
TEST(ArmForces, OfAFingerThatAnotherOneFollowsHaveNoLine) {
  const Model model = simulated(load_mjcf(kExamples + "/arm7.xml"));
  const VectorXd q = scale_of(model).home;
  const VectorXd limits = VectorXd::Constant(8, 0.01);
  for (const char* finger : {"left", "right"}) {
    const auto at = arm_forces(model, {.site = finger, .moment = true, .limits = limits});
    const VectorXd tau = at->torque(q, {10, -20, 5});
    const TouchPlace place = at->touch(q.data(), tau.data());
    EXPECT_EQ(place.link, 7) << finger;
    EXPECT_FALSE(place.has_line) << finger;
  }
}

TEST(ArmForces, OfAnUnknownPointAreRefusedWithTheKnownOnes) {
  try {
    arm_forces(arm7(), {.site = "gripper"});
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_EQ(std::string(e.what()),
              "unknown site 'gripper'; known: attachment_site, end_effector, hand, left, link1, "
              "link2, link3, link4, link5, link6, link7, right");
  }
}

// A touch of 50 N on a link, 5 to 15 cm from where its joint is, while the arm holds its pose.
struct Push {
  int link;
  Vector3d at, force;
};

// what an estimator says 0.5 s later, behind a velocity with that noise [rad/s]
Vec<7> estimate(const Model& model, const VectorXd& home, const Push& push, double noise,
                unsigned seed) {
  Plant plant(model);
  plant.set_state(home, VectorXd::Zero(7));
  Random random(seed);
  const TreeModel<7> arm = tree_model<7>(model);
  using Mo2 = HigherOrderMomentumObserver<TreeModel<7>, 2>;
  Mo2 mo2(arm, Mo2::Parameters::for_bandwidth(arm, 30));
  Vec<7> said = Vec<7>::Zero();
  for (int k = 0; k < 500; ++k) {
    const mjModel& m = plant.model();
    Eigen::Matrix<double, 3, 7, Eigen::RowMajor> J;
    const Vector3d at = Vector3d::Map(plant.data().xanchor + 3 * push.link) + push.at;
    mj_jac(&m, &plant.data(), J.data(), nullptr, at.data(), m.jnt_bodyid[push.link]);
    const VectorXd a = 400 * (home - plant.q()) - 40 * plant.qd();
    plant.set_input(plant.inertia() * a + plant.bias() + plant.damping(),
                    k < 100 ? VectorXd(VectorXd::Zero(7)) : VectorXd(-J.transpose() * push.force));
    Measurement<7> y{1e-3 * k, plant.q(), plant.qd(), plant.tau()};
    for (int j = 0; j < 7; ++j) y.qd[j] += noise * random.normal();
    said = mo2.update(y).tau_ext;
    plant.step(1e-3);
  }
  return said;
}

// Where the force turns the joint of its own link by less than 1 cm of lever, nobody can tell it
// from one on the link before.
TEST(ArmForces, FindTheLinkThatIsTouched) {
  const Model model = arm7();
  const ArmScale scale = scale_of(model);
  const auto forces = arm_forces(model, {.limits = scale.usual_torque / 240});
  Random random(3);
  int right = 0, touches = 0;
  while (touches < 200) {
    Push p{std::min(6, static_cast<int>(random.uniform(0, 7))), {}, {}};
    for (int i = 0; i < 3; ++i) {
      p.at[i] = random.normal();
      p.force[i] = random.normal();
    }
    p.at *= random.uniform(0.05, 0.15) / p.at.norm();
    p.force *= 50 / p.force.norm();
    Plant plant(model);
    plant.set_state(scale.home, VectorXd::Zero(7));
    const Vector3d axis = Vector3d::Map(plant.data().xaxis + 3 * p.link);
    if (std::abs(axis.dot(p.at.cross(p.force))) < 0.01 * p.force.norm()) continue;
    ++touches;
    const Vec<7> tau_ext = estimate(model, scale.home, p, 1e-4, static_cast<unsigned>(touches));
    right += forces->touch(scale.home.data(), tau_ext.data()).link == p.link;
  }
  std::printf("%d of %d links\n", right, touches);
  EXPECT_GE(right, 0.98 * touches);
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
// The MJCF against the closed form of estimators/wallmobot3.h, which was derived by hand from the
// true geometry with its parallelogram: what differs is the error that our realisation leaves.
#include "estimators/wallmobot3.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "estimators/test/random_states.h"
#include "mjcf/plant/plant.h"

namespace tauext::test {
namespace {

using WallMoBot3Mjcf = RandomStates;

// largest difference over 1,000 random states, relative to the largest term of its kind
struct Difference {
  double B = 0, bias = 0, g = 0;
};

Difference compare(const Model& model, const WallMoBot3& arm,
                   const std::function<Vec<3>(double)>& random) {
  Plant plant(model);
  Difference d;
  for (int i = 0; i < 1000; ++i) {
    const Vec<3> q = random(3), qd = random(2);
    plant.set_state(q, qd);
    d.B = std::max(d.B, (plant.inertia() - arm.inertia(q)).norm() / arm.inertia(q).norm());
    const Vec<3> coriolis = arm.bias(q, qd) - arm.gravity(q);
    const double scale = coriolis.norm() + arm.gravity(q).norm();
    d.bias = std::max(d.bias, (plant.bias() - arm.bias(q, qd)).norm() / scale);
    plant.set_state(q, Vec<3>::Zero());
    d.g = std::max(d.g, (plant.bias() - arm.gravity(q)).norm() / arm.gravity(q).norm());
  }
  return d;
}

TEST_F(WallMoBot3Mjcf, AgreesWithTheClosedFormInBAndCqdAndG) {
  for (const double panel : {0., 50., 150.}) {
    const Difference d =
        compare(wallmobot3_with_panel(panel), WallMoBot3(WallMoBot3::Parameters::with_panel(panel)),
                [this](double scale) { return vector(scale); });
    EXPECT_LT(d.B, 1e-9) << "panel " << panel;
    EXPECT_LT(d.bias, 1e-9) << "panel " << panel;
    EXPECT_LT(d.g, 1e-9) << "panel " << panel;
  }
}

TEST_F(WallMoBot3Mjcf, TheParallelogramIsExactToRoundOff) {
  // no constraint rows, and seven orders below the tolerance above
  Plant plant(load_robot("wallmobot3"));
  EXPECT_EQ(plant.model().neq, 0);
  const Difference d = compare(load_robot("wallmobot3"), WallMoBot3(),
                               [this](double scale) { return vector(scale); });
  EXPECT_LT(d.B, 1e-12);
  EXPECT_LT(d.bias, 1e-12);
}

TEST_F(WallMoBot3Mjcf, FrictionOfATendonIsFrictionOfItsJointCoordinate) {
  const Model damped = changed(load_robot("wallmobot3"), [](mjModel& m) {
    m.dof_damping[0] = 3;     // on q2
    m.tendon_damping[0] = 5;  // on q3 = q2 + (q3 - q2)
    m.dof_damping[2] = 7;     // on q4
  });
  WallMoBot3::Parameters p;
  p.viscous << 3, 5, 7;
  const WallMoBot3 arm(p);
  Plant plant(damped);
  const Vec<3> qd = vector(1);
  plant.set_state(vector(1), qd);
  EXPECT_LT((plant.friction() - arm.friction(qd)).norm(), 1e-12 * arm.friction(qd).norm());
}

// modified Denavit-Hartenberg transform of Table I, in the plane: along x by a, then about y by
// theta
struct Pose {
  double x = 0, z = 0, phi = 0;
  void next(double a, double theta) {
    x += a * std::cos(phi);
    z -= a * std::sin(phi);
    phi += theta;
  }
};

TEST_F(WallMoBot3Mjcf, TheEndEffectorStandsWhereTableISays) {
  constexpr double kPi = std::numbers::pi, kGamma = 0.3458, kBaseHeight = 0.9;
  Plant plant(load_robot("wallmobot3"));
  const int site = mj_name2id(&plant.model(), mjOBJ_SITE, "end_effector");
  const State d = initial_state(plant.model());
  for (int i = 0; i < 100; ++i) {
    const Vec<3> q = vector(2);
    Pose p;
    p.next(0.06, q[0] - kPi / 2);
    p.next(0.5, -q[0] + kGamma);
    p.next(0.195, q[1] + kPi / 2 - kGamma);
    p.next(0.85, q[2] + kPi / 2);
    // frame 6: a_5 along x_5, then d_6 and the panel's distance along z_6 = -y_5
    const double forward = 0.109 + 0.2025;
    const double x = p.x + 0.93 * std::cos(p.phi) + forward * std::sin(p.phi);
    const double z = p.z - 0.93 * std::sin(p.phi) + forward * std::cos(p.phi) + kBaseHeight;
    d->qpos[0] = q[0];
    d->qpos[1] = q[1] - q[0];
    d->qpos[2] = q[2];
    mj_kinematics(&plant.model(), d.get());
    EXPECT_NEAR(d->site_xpos[3 * site], x, 1e-12);
    EXPECT_NEAR(d->site_xpos[3 * site + 2], z, 1e-12);
  }
}

TEST_F(WallMoBot3Mjcf, AForceOnTheArmIsMinusJTransposeF) {
  const WallMoBot3 arm;
  Plant plant(load_robot("wallmobot3"));
  for (int i = 0; i < 100; ++i) {
    const Vec<3> q = vector(2), f(vector(100));
    plant.set_state(q, Vec<3>::Zero());
    const Vec<3> expected = -arm.jacobian(q).transpose() * Vec<3>(f[0], f[2], 0);
    EXPECT_LT((plant.tau_ext_of(f, plant.place("end_effector")) - expected).norm(), 1e-10);
  }
}

}  // namespace
}  // namespace tauext::test

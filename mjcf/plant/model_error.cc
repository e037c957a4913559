// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/model_error.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>

#include "mjcf/mujoco/layout.h"
#include "mjcf/mujoco/mujoco_functions.h"
#include "mjcf/mujoco/ties.h"
#include "mjcf/plant/coordinates.h"

namespace tauext {
namespace {

using Eigen::Vector3d;

void check(const char* name, double value, double least, double most) {
  if (value >= least && value <= most) return;
  throw std::invalid_argument(
      fmt::format("model error {} must be {:g} to {:g}, not {}", name, least, most, value));
}

void check(const ModelError& e) {
  check("mass [1]", e.mass, 0.01, 100);
  check("com [m]", e.com, -10, 10);
  check("friction [N m]", e.friction, 0, 1e4);
  check("friction_share [1]", e.friction_share, 0, 10);
  check("viscous [N m s/rad]", e.viscous, 0, 1e4);
  check("armature [kg m^2]", e.armature, 0, 1e4);
}

// the degrees of freedom of the arm that follow no other, from the base to the tip
std::vector<int> arm_of(const Model& m) {
  return layout_of(*m, *initial_state(*m)).leaders;
}

// along the line from the last joint to the centre of mass of what it moves; that line has to lie
// in the plane in which the joint turns
void move_com(mjModel& m, int dof, double by) {
  const int body = m.dof_bodyid[dof], joint = m.dof_jntid[dof];
  Eigen::Map<Vector3d> com(m.body_ipos + 3 * body);
  const Eigen::Map<const Vector3d> axis(m.jnt_axis + 3 * joint), anchor(m.jnt_pos + 3 * joint);
  const Vector3d way = com - anchor, in_plane = way - way.dot(axis) * axis;
  if (!(in_plane.norm() > 1e-9)) {
    throw std::invalid_argument("model error com: the last link's centre of mass lies on its axis");
  }
  com += by * in_plane.normalized();
}

}  // namespace

Model with_errors(const Model& robot, const ModelError& e) {
  if (e.none()) return robot;
  check(e);
  const std::vector<int> arm = arm_of(robot);
  const int last = robot->dof_bodyid[arm.back()];
  const Eigen::VectorXd usual = e.friction_share > 0
                                    ? usual_torque_of(robot)
                                    : Eigen::VectorXd::Zero(static_cast<Eigen::Index>(arm.size()));
  return changed(robot, [&](mjModel& m) {
    m.body_mass[last] *= e.mass;
    for (int i = 0; i < 3; ++i) m.body_inertia[3 * last + i] *= e.mass;
    if (e.com != 0) move_com(m, arm.back(), e.com);
    for (std::size_t i = 0; i < arm.size(); ++i) {
      const int dof = arm[i];
      m.dof_damping[dof] += e.viscous;
      m.dof_armature[dof] += e.armature;
      const double dry = e.friction + e.friction_share * usual[static_cast<Eigen::Index>(i)];
      if (dry == 0) continue;
      m.dof_frictionloss[dof] += dry;
      if ((m.opt.disableflags & kSimulated) != 0) continue;  // these say something else there
      // as stiff as the testbed's: full friction above some mrad/s
      m.dof_solref[mjNREF * dof] = 0.002;
      m.dof_solimp[mjNIMP * dof] = m.dof_solimp[mjNIMP * dof + 1] = 0.9999;
      m.opt.tolerance = 1e-17;  // at the usual 1e-8 friction is up to 2 % off
    }
  });
}

}  // namespace tauext

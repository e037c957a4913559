// SPDX-License-Identifier: Apache-2.0
#include "mjcf/mujoco/layout.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "mjcf/mujoco/mujoco_functions.h"
#include "mjcf/mujoco/ties.h"

namespace tauext {
namespace {

using Eigen::Vector3d;

bool is_motor(const mjModel& m, int i) {
  return m.actuator_dyntype[i] == mjDYN_NONE && m.actuator_gaintype[i] == mjGAIN_FIXED &&
         m.actuator_biastype[i] == mjBIAS_NONE && m.actuator_gainprm[i * mjNGAIN] == 1;
}

bool on_spatial_tendon(const mjModel& m, int i) {
  return m.actuator_trntype[i] == mjTRN_TENDON &&
         m.wrap_type[m.tendon_adr[m.actuator_trnid[2 * i]]] != mjWRAP_JOINT;
}

bool is_coordinate(const mjModel& m, int i) {
  const bool on_joint = m.actuator_trntype[i] == mjTRN_JOINT;
  const bool on_fixed_tendon = m.actuator_trntype[i] == mjTRN_TENDON && !on_spatial_tendon(m, i);
  return (on_joint || on_fixed_tendon) && is_motor(m, i);
}

bool is_screw(const mjModel& m, int i) {
  return on_spatial_tendon(m, i) && is_motor(m, i);
}

// the triangle of a spatial tendon between two sites that spans one hinge
Screw triangle(const mjModel& m, const mjData& d, int actuator, int dof) {
  const int tendon = m.actuator_trnid[2 * actuator], first = m.tendon_adr[tendon];
  const int joint = m.dof_jntid[dof];
  if (m.tendon_num[tendon] != 2 || m.wrap_type[first] != mjWRAP_SITE ||
      m.wrap_type[first + 1] != mjWRAP_SITE || m.jnt_type[joint] != mjJNT_HINGE) {
    throw std::invalid_argument(
        fmt::format("tendon '{}': a screw runs between two sites across one hinge",
                    element_name(m, mjOBJ_TENDON, tendon)));
  }
  const Vector3d hinge = Vector3d::Map(d.xanchor + 3 * joint),
                 axis = Vector3d::Map(d.xaxis + 3 * joint);
  const auto in_plane = [&](int wrap) -> Vector3d {
    const Vector3d r = Vector3d::Map(d.site_xpos + 3 * m.wrap_objid[wrap]) - hinge;
    return r - r.dot(axis) * axis;
  };
  const Vector3d base = in_plane(first), arm = in_plane(first + 1);
  Screw s;
  s.c = base.norm();
  s.a = arm.norm();
  s.sense = axis.dot(base.cross(arm)) >= 0 ? 1 : -1;
  s.gamma0 = std::atan2(base.cross(arm).norm(), base.dot(arm)) - s.sense * d.qpos[joint];
  return s;
}

// those that MuJoCo does not hold itself
Ties rigid_ties(const mjModel& m) {
  if (has_rigid_ties(m)) return ties_of(m);
  Ties none{{}, Eigen::MatrixXd::Identity(m.nv, m.nv), Eigen::VectorXd::Zero(m.nv)};
  for (int i = 0; i < m.nv; ++i) none.free.push_back(i);
  return none;
}

// the joint coordinates, from the actuators at the head of the list
void find_coordinates(const mjModel& m, const mjData& d, Layout& l) {
  while (l.dof < m.nu && is_coordinate(m, l.dof)) ++l.dof;
  Eigen::MatrixXd moment(l.dof, m.nv);
  for (int i = 0; i < l.dof; ++i) moment.row(i) = levers(m, d, i);
  const Ties ties = rigid_ties(m);
  const Eigen::MatrixXd by_free = moment * ties.T;
  std::vector<Eigen::Index> free;  // of ties.free, those that motors move
  for (Eigen::Index k = 0; k < by_free.cols(); ++k) {
    if (by_free.col(k).isZero(0)) continue;
    free.push_back(k);
    l.leaders.push_back(ties.free[static_cast<std::size_t>(k)]);
  }
  for (int j = 0; j < m.nv; ++j) {
    const Eigen::RowVectorXd row = ties.T.row(j)(free);
    if (!row.isZero(0) || ties.T.row(j).isZero(0)) l.arm.push_back(j);  // or tied to a number
  }
  if (l.dof == 0 || static_cast<int>(free.size()) != l.dof) {
    throw std::invalid_argument(fmt::format(
        "the first {} actuators move {} degrees of freedom; every joint coordinate needs its own "
        "<motor> of gain 1 on a joint or a fixed tendon{}",
        l.dof, free.size(),
        l.dof < m.nu ? fmt::format(", and '{}' is none", element_name(m, mjOBJ_ACTUATOR, l.dof))
                     : ""));
  }
  l.S = moment(Eigen::indexing::all, l.arm);
  const Eigen::MatrixXd T = ties.T(l.arm, free);
  const Eigen::FullPivLU<Eigen::MatrixXd> q_to_free((l.S * T).transpose());
  if (q_to_free.rank() < l.dof) {
    throw std::invalid_argument("the actuators' lengths do not determine every joint's position");
  }
  const Eigen::VectorXd rho = Eigen::VectorXd::Map(d.qpos, m.nq)(l.arm);
  l.q0 = Eigen::VectorXd::Map(d.actuator_length, l.dof) - l.S * rho;
  l.T = q_to_free.solve(T.transpose()).transpose();
  l.rho0 = ties.rho0(l.arm) - l.T * (l.q0 + l.S * ties.rho0(l.arm));
}

// what follows them
void find_scene(const mjModel& m, const mjData& d, Layout& l) {
  int i = l.dof;
  for (; i < m.nu && is_screw(m, i); ++i) {
    if (i >= 2 * l.dof) break;
    l.screws.push_back(triangle(m, d, i, l.arm[i - l.dof]));
  }
  if (!l.screws.empty() && static_cast<int>(l.screws.size()) != l.dof) {
    throw std::invalid_argument(fmt::format(
        "{} screws for {} joints: every joint needs one, or none", l.screws.size(), l.dof));
  }
  const int load = mj_name2id(&m, mjOBJ_BODY, "load");
  if (load >= 0) {
    l.tether = mj_name2id(&m, mjOBJ_ACTUATOR, "tether");
    l.load_dof = m.body_dofadr[load];
    if (l.tether != i || m.body_dofnum[load] != 3) {
      throw std::invalid_argument("a load needs three slides and the actuator 'tether'");
    }
    ++i;
  }
  if (i < m.nu) {
    throw std::invalid_argument(fmt::format(
        "actuator {} ('{}') must be a <motor> of gain 1 on a joint or a fixed tendon: its "
        "length is a joint coordinate and its force that joint's torque",
        i, element_name(m, mjOBJ_ACTUATOR, i)));
  }
  // bodies of the scene must not hang in the arm's tree: B is the arm's alone
  for (int j = 0; j < m.nv; ++j) {
    for (int parent = m.dof_parentid[j]; parent >= 0; parent = m.dof_parentid[parent]) {
      if (std::count(l.arm.begin(), l.arm.end(), j) ==
          std::count(l.arm.begin(), l.arm.end(), parent))
        continue;
      throw std::invalid_argument(
          fmt::format("joint '{}' has no motor of its own, or hangs on one that has none",
                      element_name(m, mjOBJ_JOINT, m.dof_jntid[j])));
    }
  }
}

// the last one up to `last` that neither follows nor is followed; `last` if there is none
int last_alone(const mjModel& m, int last) {
  if (!has_ties(m)) return last;
  const Ties ties = ties_of(m);
  for (int dof = last; dof >= 0; --dof) {
    const auto at = std::find(ties.free.begin(), ties.free.end(), dof);
    if (at == ties.free.end()) continue;
    const auto moved = ties.T.col(at - ties.free.begin());
    if ((moved.array() != 0).count() == 1) return dof;
  }
  return last;
}

}  // namespace

Layout layout_of(const mjModel& m, const mjData& d) {
  if (m.nq != m.nv || m.nv == 0) {
    throw std::invalid_argument("the model has free or ball joints, which are not supported");
  }
  Layout l;
  find_coordinates(m, d, l);
  find_scene(m, d, l);
  return l;
}

BodyPoint end_effector_of(const mjModel& m, int last) {
  const auto site = [&](const char* name) -> std::optional<BodyPoint> {
    const int id = mj_name2id(&m, mjOBJ_SITE, name);
    if (id < 0) return {};
    return BodyPoint{m.site_bodyid[id], Eigen::Vector3d::Map(m.site_pos + 3 * id),
                     fmt::format("the site '{}'", name)};
  };
  if (auto found = site(kEndEffector)) return *found;
  if (const int id = mj_name2id(&m, mjOBJ_BODY, kEndEffector); id >= 0)
    return {id, Eigen::Vector3d::Zero(), fmt::format("the origin of the body '{}'", kEndEffector)};
  if (auto found = site("attachment_site")) return *found;
  const int body = m.dof_bodyid[last_alone(m, last)];
  return {body, Eigen::Vector3d::Map(m.body_ipos + 3 * body),
          fmt::format("the centre of mass of the body '{}', as no site or body (of a URDF: no "
                      "link) is called 'end_effector'",
                      element_name(m, mjOBJ_BODY, body))};
}

}  // namespace tauext

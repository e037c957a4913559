// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/tree.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <string>

#include "estimators/friction.h"
#include "mjcf/plant/layout.h"
#include "mjcf/trace/known.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kQuickest = 500;         // [1/s] of friction: 40 % of a speed are gone in a sample
constexpr int kSmoothFriction = 1 << 30;  // of disableflags: a bit that MuJoCo does not know

// to MuJoCo's passive forces; v_s stands where its own friction, switched off, has a constant
void add_smooth_friction(const mjModel* m, mjData* d) {
  if ((m->opt.disableflags & kSmoothFriction) == 0) return;
  for (int i = 0; i < m->nv; ++i) {
    const CoulombFriction dry{m->dof_frictionloss[i], m->dof_solref[mjNREF * i]};
    d->qfrc_passive[i] -= dry.torque(d->qvel[i]);
  }
}

std::string named_joint(const mjModel& m, int i) {
  const char* const name = mj_id2name(&m, mjOBJ_JOINT, i);
  const bool named = name != nullptr && *name != '\0';
  return fmt::format("joint {}{}", i + 1, named ? " '" + printable_name(name) + "'" : "");
}

void check(const mjModel& m) {
  const auto refuse = [](bool present, const char* what) {
    if (present)
      throw std::invalid_argument(std::string("the model has ") + what + ": not supported");
  };
  for (int i = 0; i < m.njnt; ++i) {
    if (m.jnt_type[i] == mjJNT_HINGE || m.jnt_type[i] == mjJNT_SLIDE) continue;
    throw std::invalid_argument(
        fmt::format("{} is {}: an arm of hinges and slides on a fixed base is wanted; take it out",
                    named_joint(m, i), m.jnt_type[i] == mjJNT_FREE ? "free" : "a ball"));
  }
  if (m.nv == 0) {
    throw std::invalid_argument(
        "no joint is left that moves: an arm of hinges and slides is wanted");
  }
  if (m.neq > 0) throw std::invalid_argument(first_tie(m));
  refuse(!VectorXd::Map(m.jnt_stiffness, m.njnt).isZero(0), "springs in joints");
  for (const mjtNum* forces : {m.tendon_stiffness, m.tendon_damping, m.tendon_frictionloss}) {
    refuse(!VectorXd::Map(forces, m.ntendon).isZero(0), "tendons with springs or friction");
  }
  refuse(m.opt.density != 0 || m.opt.viscosity != 0, "air or water around it");
}

// whether some actuator's coordinate is a fixed tendon: then the actuators say what a joint is
bool has_tendon_coordinates(const mjModel& m) {
  for (int i = 0; i < m.nu; ++i) {
    if (m.actuator_trntype[i] == mjTRN_TENDON &&
        m.wrap_type[m.tendon_adr[m.actuator_trnid[2 * i]]] == mjWRAP_JOINT) {
      return true;
    }
  }
  return false;
}

// the actuators' coordinates, or MuJoCo's
void set_coordinates(const mjModel& m, ArmTree& tree) {
  tree.coordinates = MatrixXd::Identity(m.nv, m.nv);
  tree.offset = VectorXd::Zero(m.nv);
  if (!has_tendon_coordinates(m)) return;
  const State d = initial_state(m);
  const Layout l = layout_of(m, *d);
  for (int i = 0; i < l.dof; ++i) {
    if (m.actuator_gear[6 * i] == 1) continue;
    throw std::invalid_argument(
        fmt::format("motor {} has a gear of {}: where motors on tendons say what the joint "
                    "coordinates are, their gears must be 1",
                    i, m.actuator_gear[6 * i]));
  }
  if (l.dof != m.nv) throw std::invalid_argument("the motors do not move every joint of the model");
  tree.coordinates = l.S;
  tree.offset = VectorXd::Map(d->actuator_length, m.nv) - l.S * VectorXd::Map(d->qpos, m.nv);
}

void set_ranges(const mjModel& m, ArmTree& tree) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  tree.lower = VectorXd::Constant(m.nv, -kNone);
  tree.upper = VectorXd::Constant(m.nv, kNone);
  if (!tree.coordinates.isIdentity(0)) return;
  for (int i = 0; i < m.njnt; ++i) {
    if (!m.jnt_limited[i]) continue;
    tree.lower[i] = m.jnt_range[2 * i];
    tree.upper[i] = m.jnt_range[2 * i + 1];
  }
}

// over poses that fill the range evenly: multiples of square roots of primes, modulo 1
void set_usual(const mjModel& m, ArmTree& tree) {
  constexpr int kPoses = 200;
  constexpr double kAcceleration = 10;  // [rad/s^2] or [m/s^2]
  constexpr double kPrimes[] = {2, 3, 5, 7, 11, 13, 17, 19};
  const State d = initial_state(m);
  MatrixXd M(m.nv, m.nv);
  tree.usual_torque = tree.mobility = VectorXd::Zero(m.nv);
  const auto to_q = tree.coordinates.transpose().partialPivLu();
  for (int k = 0; k < kPoses; ++k) {
    for (int i = 0; i < m.nv; ++i) {
      const double most = m.jnt_type[i] == mjJNT_SLIDE ? 0.5 : 3.14159;
      const double* const range = m.jnt_range + 2 * i;
      const double from = m.jnt_limited[i] ? range[0] : -most;
      const double to = m.jnt_limited[i] ? range[1] : most;
      const double turns = k * std::sqrt(kPrimes[i % 8]);
      d->qpos[i] = from + (to - from) * (turns - std::floor(turns));
    }
    mj_fwdPosition(&m, d.get());
    mj_fwdVelocity(&m, d.get());
    mj_fullM(&m, M.data(), d->qM);
    const VectorXd gravity = to_q.solve(VectorXd::Map(d->qfrc_bias, m.nv));
    const MatrixXd half = to_q.solve(M);
    const VectorXd inertia = to_q.solve(half.transpose()).diagonal();
    tree.usual_torque = tree.usual_torque.cwiseMax(gravity.cwiseAbs());
    tree.usual_torque = tree.usual_torque.cwiseMax(kAcceleration * inertia);
    tree.mobility = tree.mobility.cwiseMax(M.inverse().diagonal());
  }
}

Vec<3> vector(const mjtNum* v) {
  return Vec<3>::Map(v);
}

Mat<3> rotation(const mjtNum* q) {
  return Eigen::Quaternion<double>(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
}

// where a MuJoCo body is: in the frame of the joint that carries it, -1 being the base
struct Place {
  int joint = -1;
  Mat<3> R = Mat<3>::Identity();
  Vec<3> p = Vec<3>::Zero();  // [m]
};

// mass and first and second moment about a joint's origin
struct Mass {
  double m = 0;                     // [kg]
  Vec<3> h = Vec<3>::Zero();        // [kg m]
  Mat<3> inertia = Mat<3>::Zero();  // [kg m^2]
};

// of a unit mass at r
Mat<3> inertia_at(const Vec<3>& r) {
  return r.squaredNorm() * Mat<3>::Identity() - r * r.transpose();
}

// the joints of a body, one behind the other; moves its place behind the last of them
void add_joints(const mjModel& m, int body, Place& at, ArmTree& tree) {
  for (int k = 0; k < m.body_jntnum[body]; ++k) {
    const int i = m.body_jntadr[body] + k, dof = m.jnt_dofadr[i];
    const Vec<3> anchor = vector(m.jnt_pos + 3 * i);
    TreeJoint j;
    j.parent = at.joint;
    j.kind = m.jnt_type[i] == mjJNT_SLIDE ? TreeJoint::Kind::kSlide : TreeJoint::Kind::kHinge;
    j.axis = vector(m.jnt_axis + 3 * i);
    j.rotation = at.R;
    j.position = at.p + at.R * anchor;
    j.zero = m.qpos0[m.jnt_qposadr[i]];
    j.armature = m.dof_armature[dof];
    j.viscous = m.dof_damping[dof];
    j.dry = m.dof_frictionloss[dof];
    j.v_s = std::max(j.v_s, j.dry * tree.mobility[dof] / kQuickest);
    tree.joints.push_back(j);
    at = {i, Mat<3>::Identity(), -anchor};
  }
}

// in the frames of their joints
void set_points(const mjModel& m, const std::vector<Place>& places, ArmTree& tree) {
  const auto add = [&](mjtObj type, int id, int body, const Vec<3>& at) {
    const Place& place = places[static_cast<std::size_t>(body)];
    const char* const name = mj_id2name(&m, type, id);
    if (place.joint < 0 || name == nullptr || *name == '\0') return;
    tree.points.insert({name, {place.joint, place.p + place.R * at}});
  };
  for (int i = 0; i < m.nsite; ++i)
    add(mjOBJ_SITE, i, m.site_bodyid[i], vector(m.site_pos + 3 * i));
  for (int i = 1; i < m.nbody; ++i) add(mjOBJ_BODY, i, i, Vec<3>::Zero());
  const BodyPoint end = end_effector_of(m, m.nv - 1);
  tree.end_effector = end.what;
  const Place& place = places[static_cast<std::size_t>(end.body)];
  tree.points.insert({kEndEffector, {place.joint, place.p + place.R * end.at}});
}

}  // namespace

const ArmPoint& ArmTree::point(const std::string& name) const {
  return find_known(points, "site", name, [](const auto& p) { return p.first; }).second;
}

void detail::require_equal_joints(std::size_t have, int want) {
  if (have == static_cast<std::size_t>(want)) return;
  throw std::invalid_argument(fmt::format("the model has {} joints, not {}", have, want));
}

Model simulated(const Model& model) {
  static std::once_flag once;
  std::call_once(once, [] { mjcb_passive = add_smooth_friction; });
  const ArmTree tree = tree_of(model);
  return changed(model, [&](mjModel& m) {
    for (int i = 0; i < m.nv; ++i)
      m.dof_solref[mjNREF * i] = tree.joints[static_cast<std::size_t>(i)].v_s;
    m.opt.integrator = mjINT_RK4;
    m.opt.disableflags |= mjDSBL_CONTACT | mjDSBL_FRICTIONLOSS | kSmoothFriction;
    const bool on_joints = std::all_of(m.actuator_trntype, m.actuator_trntype + m.nu,
                                       [](int type) { return type == mjTRN_JOINT; });
    if (m.nu != m.nv || !on_joints) return;
    for (int i = 0; i < m.nu; ++i) {
      m.actuator_trnid[2 * i] = i;
      m.actuator_gear[6 * i] = m.actuator_gainprm[i * mjNGAIN] = 1;
      m.actuator_ctrllimited[i] = m.actuator_forcelimited[i] = 0;
    }
  });
}

std::string too_stiff(const Model& model) {
  const ArmTree tree = tree_of(model);
  for (int i = 0; i < model->nv; ++i) {
    const double damping = tree.joints[static_cast<std::size_t>(i)].viscous;
    const double rate = damping * tree.mobility[i];  // [1/s]
    if (rate <= kQuickest) continue;
    return fmt::format(
        "{}: a damping of {:.3g} stops its inertia of {:.2g} within {:.2g} ms, faster than samples "
        "of 1 ms show; add its motor's inertia behind the gear, armature=\"{:.2g}\" or more, to "
        "its <joint> in MJCF, to its <dynamics> in URDF",
        named_joint(*model, i), damping, 1 / tree.mobility[i], 1000 / rate,
        1.05 * (damping / kQuickest - 1 / tree.mobility[i]));
  }
  return "";
}

ArmTree tree_of(const Model& model) {
  const mjModel& m = *model;
  check(m);
  ArmTree tree;
  tree.gravity = vector(m.opt.gravity);
  set_coordinates(m, tree);
  set_ranges(m, tree);
  set_usual(m, tree);
  std::vector<Place> places(static_cast<std::size_t>(m.nbody));
  std::vector<Mass> masses(static_cast<std::size_t>(m.nv));
  for (int body = 1; body < m.nbody; ++body) {
    const Place& parent = places[static_cast<std::size_t>(m.body_parentid[body])];
    Place at{parent.joint, parent.R * rotation(m.body_quat + 4 * body),
             parent.p + parent.R * vector(m.body_pos + 3 * body)};
    add_joints(m, body, at, tree);
    places[static_cast<std::size_t>(body)] = at;
    if (at.joint < 0) continue;  // it never moves
    const double mass = m.body_mass[body];
    const Vec<3> center = at.p + at.R * vector(m.body_ipos + 3 * body);
    const Mat<3> axes = at.R * rotation(m.body_iquat + 4 * body);
    Mass& all = masses[static_cast<std::size_t>(at.joint)];
    all.m += mass;
    all.h += mass * center;
    all.inertia += axes * vector(m.body_inertia + 3 * body).asDiagonal() * axes.transpose() +
                   mass * inertia_at(center);
  }
  tree.base = tree.joints.front().position;  // sums about a point nearby lose no digits
  for (std::size_t i = 0; i < masses.size(); ++i) {
    TreeJoint& j = tree.joints[i];
    if (j.parent < 0) j.position -= tree.base;
    j.mass = masses[i].m;
    if (j.mass > 0) j.center = masses[i].h / j.mass;
    const Mat<3> inertia = masses[i].inertia - j.mass * inertia_at(j.center);
    j.inertia = 0.5 * (inertia + inertia.transpose());
  }
  set_points(m, places, tree);
  return tree;
}

}  // namespace tauext

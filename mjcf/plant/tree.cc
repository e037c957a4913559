// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/tree.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <stdexcept>

#include "mjcf/mujoco/layout.h"
#include "mjcf/mujoco/measured.h"
#include "mjcf/mujoco/misfits.h"
#include "mjcf/mujoco/mujoco_functions.h"
#include "mjcf/mujoco/ties.h"
#include "mjcf/plant/coordinates.h"
#include "mjcf/plant/remedy/remedy.h"
#include "mjcf/trace/known.h"
#include "mjcf/trace/printable.h"

namespace tauext {

static_assert(kMostCoordinates == kMostLeaders && kMostFollowers == kMostTied);

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// of each joint, over all that move with it
VectorXd together(const Ties& ties, const VectorXd& of_joint) {
  const MatrixXd moves = (ties.T.array() != 0).cast<double>();
  return moves * (moves.transpose() * of_joint);
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

std::string plain_name(const mjModel& m, mjtObj kind, int id) {
  const char* const name = mj_id2name(&m, kind, id);
  return name == nullptr ? "" : name;
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
    const Measured also = measured(m, i);
    j.offset = also.offset, j.viscous_skew = also.viscous_skew;
    tree.joints.push_back(j);
    tree.names.push_back(plain_name(m, mjOBJ_JOINT, i));
    tree.bodies.push_back(plain_name(m, mjOBJ_BODY, body));
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

bool ArmTree::slides(int i) const {
  const int leader = leaders[static_cast<std::size_t>(i)];
  return joints[static_cast<std::size_t>(leader)].kind == TreeJoint::Kind::kSlide;
}

std::vector<std::string> ArmTree::joint_names() const {
  std::vector<std::string> all;
  for (int i = 0; i < dof(); ++i) {
    const int leader = leaders[static_cast<std::size_t>(i)];
    if (drho.row(leader) != Eigen::RowVectorXd::Unit(dof(), i) || rho0[leader] != 0) return {};
    all.push_back(names[static_cast<std::size_t>(leader)]);
  }
  return std::count(all.begin(), all.end(), "") == 0 ? all : std::vector<std::string>();
}

const ArmPoint& ArmTree::point(const std::string& name) const {
  return find_known(points, "site", name, [](const auto& p) { return p.first; }).second;
}

void detail::require_size(const ArmTree& tree, int coordinates) {
  if (tree.dof() != coordinates)
    throw std::invalid_argument(
        fmt::format("the model has {} joints, not {}", tree.dof(), coordinates));
  const int followers = static_cast<int>(tree.joints.size()) - tree.dof();
  if (followers <= kMostFollowers) return;
  throw std::invalid_argument(
      fmt::format("{} joints follow others, and at most {} may; --lock REGEX fixes them", followers,
                  kMostFollowers));
}

ArmTree tree_of(const Model& model) {
  const mjModel& m = *model;
  if (const std::vector<Misfit> misfits = misfits_of(m); !misfits.empty())
    throw std::invalid_argument(in_words(misfits));
  ArmTree tree;
  if ((m.opt.disableflags & mjDSBL_GRAVITY) == 0) tree.gravity = vector(m.opt.gravity);
  const ArmCoordinates c = coordinates_of(m);
  tree.drho = c.drho, tree.rho0 = c.rho0, tree.leaders = c.leaders;
  tree.lower = c.lower, tree.upper = c.upper;
  tree.usual_torque = c.usual_torque, tree.mobility = c.mobility;
  tree.friction_rate =
      together(ties_of(m), VectorXd::Map(m.dof_damping, m.nv).cwiseProduct(tree.mobility));
  for (VectorXd* v : {&tree.gain, &tree.rated_torque, &tree.rated_speed}) v->resize(tree.dof());
  for (int i = 0; i < tree.dof(); ++i) {
    const int leader = tree.leaders[static_cast<std::size_t>(i)];
    tree.gain[i] = measured(m, leader).gain;
    const Rated rated = rated_of(m, leader);
    tree.rated_torque[i] = rated.torque, tree.rated_speed[i] = rated.speed;
  }
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
  const VectorXd slips =
      together(ties_of(m), VectorXd::Map(m.dof_frictionloss, m.nv).cwiseProduct(tree.mobility)) /
      kQuickestFriction;
  tree.base = tree.joints.front().position;  // sums about a point nearby lose no digits
  for (std::size_t i = 0; i < masses.size(); ++i) {
    TreeJoint& j = tree.joints[i];
    if (j.parent < 0) j.position -= tree.base;
    j.v_s = std::max(j.v_s, slips[static_cast<Eigen::Index>(i)]);
    j.mass = masses[i].m;
    if (j.mass > 0) j.center = masses[i].h / j.mass;
    const Mat<3> inertia = masses[i].inertia - j.mass * inertia_at(j.center);
    j.inertia = 0.5 * (inertia + inertia.transpose());
  }
  set_points(m, places, tree);
  return tree;
}

}  // namespace tauext

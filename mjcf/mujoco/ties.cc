// SPDX-License-Identifier: Apache-2.0
#include "mjcf/mujoco/ties.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <stdexcept>
#include <string>

#include "mjcf/mujoco/mujoco_functions.h"

namespace tauext {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

[[noreturn]] void refuse_joint(const mjModel& m, int joint, const char* why) {
  throw std::invalid_argument(fmt::format("joint '{}' {}; --lock REGEX fixes it",
                                          element_name(m, mjOBJ_JOINT, joint), why));
}

bool one_number(const mjModel& m, int joint) {
  return m.jnt_type[joint] == mjJNT_HINGE || m.jnt_type[joint] == mjJNT_SLIDE;
}

void check(const mjModel& m, int e) {
  const int type = m.eq_type[e];
  if (type == mjEQ_CONNECT || type == mjEQ_WELD) {
    throw std::invalid_argument(fmt::format(
        "body '{}' is tied to '{}' by <equality>: not supported; open the ring",
        element_name(m, mjOBJ_BODY, m.eq_obj1id[e]), element_name(m, mjOBJ_BODY, m.eq_obj2id[e])));
  }
  if (type != mjEQ_JOINT)
    throw std::invalid_argument("an <equality> ties tendons: not supported; take it out");
  const int one = m.eq_obj1id[e], two = m.eq_obj2id[e];
  if (!one_number(m, one) || (two >= 0 && !one_number(m, two)))
    refuse_joint(m, one, "is tied, and it or what it follows is no hinge or slide");
  for (int i = 2; i < 5; ++i) {
    if (m.eq_data[mjNEQDATA * e + i] != 0)
      refuse_joint(m, one,
                   "follows another by a polynomial, and only a straight line is supported");
  }
}

// the equality by which each degree of freedom follows another; -1: none
std::vector<int> followers(const mjModel& m) {
  std::vector<int> by(static_cast<std::size_t>(m.nv), -1);
  std::vector<std::string> problems;
  for (int e = 0; has_ties(m) && e < m.neq; ++e) {
    if (!is_active(m, e)) continue;
    try {
      check(m, e);
      int& own = by[static_cast<std::size_t>(m.jnt_dofadr[m.eq_obj1id[e]])];
      if (own >= 0) refuse_joint(m, m.eq_obj1id[e], "follows two others");
      own = e;
    } catch (const std::invalid_argument& problem) {
      problems.emplace_back(problem.what());
    }
  }
  if (!problems.empty()) throw std::invalid_argument(fmt::format("{}", fmt::join(problems, "; ")));
  return by;
}

}  // namespace

bool has_ties(const mjModel& m) {
  const int flags = m.opt.disableflags;
  if ((flags & mjDSBL_EQUALITY) != 0 && (flags & kSimulated) == 0) return false;
  for (int e = 0; e < m.neq; ++e) {
    if (is_active(m, e)) return true;
  }
  return false;
}

bool has_rigid_ties(const mjModel& m) {
  return (m.opt.disableflags & kSimulated) != 0 && has_ties(m);
}

Ties ties_of(const mjModel& m) {
  const std::vector<int> by = followers(m);
  Ties ties;
  for (int i = 0; i < m.nv; ++i) {
    if (by[static_cast<std::size_t>(i)] < 0) ties.free.push_back(i);
  }
  ties.T = MatrixXd::Zero(m.nv, static_cast<Eigen::Index>(ties.free.size()));
  ties.rho0 = VectorXd::Zero(m.nv);
  for (std::size_t k = 0; k < ties.free.size(); ++k)
    ties.T(ties.free[k], static_cast<Eigen::Index>(k)) = 1;
  // rho1 - ref1 = c0 + c1 (rho2 - ref2), along each chain from its end
  for (int i = 0; i < m.nv; ++i) {
    double factor = 1, rho0 = 0;
    int dof = i;
    for (int steps = 0; by[static_cast<std::size_t>(dof)] >= 0; ++steps) {
      const int e = by[static_cast<std::size_t>(dof)], two = m.eq_obj2id[e];
      if (steps > m.neq) refuse_joint(m, m.dof_jntid[dof], "follows itself");
      const double* const c = m.eq_data + mjNEQDATA * e;
      rho0 += factor * (m.qpos0[m.jnt_qposadr[m.dof_jntid[dof]]] + c[0]);
      factor *= two < 0 ? 0 : c[1];
      if (two < 0) break;
      rho0 -= factor * m.qpos0[m.jnt_qposadr[two]];
      dof = m.jnt_dofadr[two];
    }
    if (dof == i && by[static_cast<std::size_t>(i)] < 0) continue;
    ties.rho0[i] = rho0;
    if (factor != 0) ties.T.row(i) = factor * ties.T.row(dof);
  }
  return ties;
}

void keep_ties(const mjModel& m, mjData& d) {
  const MatrixXd T = ties_of(m).T;
  mj_fwdActuation(&m, &d);
  const VectorXd force = VectorXd::Map(d.qfrc_passive, m.nv) - VectorXd::Map(d.qfrc_bias, m.nv) +
                         VectorXd::Map(d.qfrc_applied, m.nv) + VectorXd::Map(d.qfrc_actuator, m.nv);
  const MatrixXd MT = mass_matrix(m, d) * T;
  // the forces of the ties have no part along T, so adding them twice changes nothing
  VectorXd::Map(d.qfrc_passive, m.nv) +=
      MT * (T.transpose() * MT).ldlt().solve(T.transpose() * force) - force;
}

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/simulated.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <mutex>
#include <stdexcept>

#include "estimators/math/friction.h"
#include "mjcf/mujoco/layout.h"
#include "mjcf/mujoco/mujoco_functions.h"
#include "mjcf/mujoco/ties.h"

namespace tauext {
namespace {

// where MuJoCo's own dry friction, switched off, has its constants
double& v_s_of(const mjModel& m, int dof) {
  return m.dof_solref[mjNREF * dof];
}
double& offset_of(const mjModel& m, int dof) {
  return m.dof_solimp[mjNIMP * dof];
}
double& viscous_skew_of(const mjModel& m, int dof) {
  return m.dof_solimp[mjNIMP * dof + 1];
}

// to MuJoCo's passive forces
void add_smooth_friction(const mjModel* m, mjData* d) {
  if ((m->opt.disableflags & kSimulated) == 0) return;
  for (int i = 0; i < m->nv; ++i) {
    const double qd = d->qvel[i];
    const CoulombFriction dry{m->dof_frictionloss[i] + viscous_skew_of(*m, i) * qd, v_s_of(*m, i)};
    d->qfrc_passive[i] -= dry.torque(qd) + offset_of(*m, i);
  }
}

// when MuJoCo asks for the motors' torques, all else is known
void hold_ties(const mjModel* m, mjData* d) {
  if (has_rigid_ties(*m)) keep_ties(*m, *d);
}

bool may_touch(const mjModel& m) {
  if ((m.opt.disableflags & mjDSBL_CONTACT) != 0) return false;
  for (int i = 0; i < m.ngeom; ++i) {
    if (m.geom_contype[i] != 0 || m.geom_conaffinity[i] != 0) return true;
  }
  return m.npair > 0;
}

constexpr double kExactTolerance = 1e-15;  // of the solver, for rounding to be all that is left

bool needs_mujoco(const mjModel& m) {
  const int known = mjDSBL_CONTACT | mjDSBL_FRICTIONLOSS | mjDSBL_EQUALITY | kSimulated;
  const bool solver_friction = (m.opt.disableflags & mjDSBL_FRICTIONLOSS) == 0 &&
                               !Eigen::VectorXd::Map(m.dof_frictionloss, m.nv).isZero(0);
  // at the usual tolerance of 1e-8 it gives friction to 2 % only
  const bool other_solver = m.opt.solver != mjSOL_NEWTON || m.opt.noslip_iterations > 0 ||
                            m.opt.tolerance > kExactTolerance;
  return (m.opt.disableflags & ~known) != 0 || m.opt.integrator != mjINT_RK4 || may_touch(m) ||
         (solver_friction && other_solver) || has_ties(m) || any(m.tendon_limited, m.ntendon) ||
         any(m.actuator_forcelimited, m.nu);
}

// as the solver has it; d is the model's state
SolverFriction solver_friction(const mjModel& m, const mjData& d) {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(m.nv);
  SolverFriction f{none, none, none};
  for (int r = 0; r < d.nefc; ++r) {
    if (d.efc_type[r] != mjCNSTR_FRICTION_DOF) continue;
    const int i = d.efc_id[r];
    f.most[i] = d.efc_frictionloss[r];
    f.D[i] = d.efc_D[r];
    f.rate[i] = d.efc_KBIP[4 * r + 1];
  }
  return f;
}

}  // namespace

Model simulated(const Model& model) {
  static std::once_flag once;
  std::call_once(once, [] {
    *detail::mujoco().mjcb_passive = add_smooth_friction;
    *detail::mujoco().mjcb_control = hold_ties;
  });
  const ArmTree tree = tree_of(model);
  return changed(model, [&](mjModel& m) {
    for (int i = 0; i < m.nv; ++i) {
      const TreeJoint& j = tree.joints[static_cast<std::size_t>(i)];
      v_s_of(m, i) = j.v_s, offset_of(m, i) = j.offset, viscous_skew_of(m, i) = j.viscous_skew;
    }
    m.opt.integrator = mjINT_RK4;
    m.opt.disableflags |= mjDSBL_CONTACT | mjDSBL_FRICTIONLOSS | mjDSBL_EQUALITY | kSimulated;
    const bool on_joints = std::all_of(m.actuator_trntype, m.actuator_trntype + m.nu,
                                       [](int type) { return type == mjTRN_JOINT; });
    if (m.nu != tree.dof() || !on_joints) return;
    for (int i = 0; i < m.nu; ++i) {
      m.actuator_trnid[2 * i] = tree.leaders[static_cast<std::size_t>(i)];
      m.actuator_gear[6 * i] = m.actuator_gainprm[i * mjNGAIN] = 1;
      m.actuator_ctrllimited[i] = m.actuator_forcelimited[i] = 0;
    }
  });
}

std::string too_stiff(const Model& model) {
  const ArmTree tree = tree_of(model);
  for (int i = 0; i < model->nv; ++i) {
    const double damping = tree.joints[static_cast<std::size_t>(i)].viscous;
    const double rate = tree.friction_rate[i];  // [1/s]
    if (rate <= kQuickestFriction || damping == 0) continue;
    return fmt::format(
        "{}: a damping of {:.3g} stops its inertia of {:.2g} within {:.2g} ms, faster than samples "
        "of 1 ms show; add its motor's inertia behind the gear, armature=\"{:.2g}\" or more, to "
        "its <joint> in MJCF, to its <dynamics> in URDF",
        joint_name(*model, i), damping, 1 / tree.mobility[i], 1000 / rate,
        1.05 * (rate / kQuickestFriction - 1) / tree.mobility[i]);
  }
  return "";
}

std::optional<PlainArm> plain_arm(const Model& model) {
  const mjModel& m = *model;
  if (needs_mujoco(m)) return std::nullopt;
  PlainArm arm;
  try {
    arm.tree = tree_of(model);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
  const State d = initial_state(m);
  const Layout layout = layout_of(m, *d);
  if (layout.dof != m.nv || layout.load_dof >= 0) return std::nullopt;
  arm.screws = layout.screws;
  arm.dry = solver_friction(m, *d);
  arm.timestep = m.opt.timestep;
  constexpr double kNone = std::numeric_limits<double>::infinity();
  arm.least = arm.lowest = Eigen::VectorXd::Constant(m.nv, -kNone);
  arm.most = arm.highest = Eigen::VectorXd::Constant(m.nv, kNone);
  for (int i = 0; i < m.nv; ++i) {
    TreeJoint& j = arm.tree.joints[static_cast<std::size_t>(i)];
    if ((m.opt.disableflags & kSimulated) != 0) {  // as it was before errors were added
      j.v_s = v_s_of(m, i), j.offset = offset_of(m, i), j.viscous_skew = viscous_skew_of(m, i);
    } else {
      j.dry = 0;  // that is the solver's
    }
    if (m.actuator_ctrllimited[i] != 0)
      arm.least[i] = m.actuator_ctrlrange[2 * i], arm.most[i] = m.actuator_ctrlrange[2 * i + 1];
    if (m.jnt_limited[i] == 0) continue;
    const double width = m.jnt_range[2 * i + 1] - m.jnt_range[2 * i];
    const double margin = m.jnt_margin[i] + 1e-3 * (width < 1e6 ? width : 1);  // or without an end
    arm.lowest[i] = m.jnt_range[2 * i] + margin;
    arm.highest[i] = m.jnt_range[2 * i + 1] - margin;
  }
  return arm;
}

}  // namespace tauext

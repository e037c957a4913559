// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant.h"

#include <fmt/format.h>

#include <stdexcept>

namespace tauext {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::Map<const VectorXd> view(const mjtNum* p, int n) {
  return {p, n};
}

void check_actuator(const mjModel& m, int i) {
  const char* name = mj_id2name(&m, mjOBJ_ACTUATOR, i);
  const bool on_joint = m.actuator_trntype[i] == mjTRN_JOINT;
  const bool on_fixed_tendon = m.actuator_trntype[i] == mjTRN_TENDON &&
                               m.wrap_type[m.tendon_adr[m.actuator_trnid[2 * i]]] == mjWRAP_JOINT;
  const bool motor = m.actuator_dyntype[i] == mjDYN_NONE &&
                     m.actuator_gaintype[i] == mjGAIN_FIXED &&
                     m.actuator_biastype[i] == mjBIAS_NONE && m.actuator_gainprm[i * mjNGAIN] == 1;
  if ((on_joint || on_fixed_tendon) && motor) return;
  throw std::invalid_argument(fmt::format(
      "actuator {} ('{}') must be a <motor> of gain 1 on a joint or a fixed tendon: its "
      "length is a joint coordinate and its force that joint's torque",
      i, name ? name : ""));
}

}  // namespace

Plant::Plant(Model model)
    : model_(std::move(model)), data_(mj_makeData(model_.get()), mj_deleteData) {
  const mjModel& m = *model_;
  if (m.nu != m.nv || m.nq != m.nv || m.nv == 0) {
    throw std::invalid_argument(
        fmt::format("the model has {} degrees of freedom and {} actuators; every joint coordinate "
                    "needs its own "
                    "motor, and free and ball joints are not supported",
                    m.nv, m.nu));
  }
  if (m.opt.integrator != mjINT_RK4) {
    throw std::invalid_argument(
        "the model must set <option integrator=\"RK4\"/>: Euler would equal "
        "the estimators' own model, and implicit gains energy");
  }
  for (int i = 0; i < m.nu; ++i) check_actuator(m, i);
  mj_forward(&m, data_.get());
  S_ = Eigen::Map<const RowMajor>(data_->actuator_moment, m.nu, m.nv);
  if (Eigen::FullPivLU<MatrixXd>(S_).rank() < m.nv) {
    throw std::invalid_argument("the actuators' lengths do not determine every joint's position");
  }
  S_lu_.compute(S_);
  St_lu_.compute(S_.transpose());
  q0_ = view(data_->actuator_length, m.nu) - S_ * view(data_->qpos, m.nv);
}

void Plant::set_state(const VectorXd& q, const VectorXd& qd) {
  mj_resetData(model_.get(), data_.get());
  Eigen::Map<VectorXd>(data_->qpos, dof()) = S_lu_.solve(q - q0_);
  Eigen::Map<VectorXd>(data_->qvel, dof()) = S_lu_.solve(qd);
  mj_forward(model_.get(), data_.get());
}

void Plant::set_input(const VectorXd& tau, const VectorXd& tau_ext) {
  Eigen::Map<VectorXd>(data_->ctrl, dof()) = tau;
  Eigen::Map<VectorXd>(data_->qfrc_applied, dof()) = -S_.transpose() * tau_ext;
  mj_forwardSkip(model_.get(), data_.get(), mjSTAGE_VEL, 1);
}

VectorXd Plant::q() const {
  return S_ * view(data_->qpos, dof()) + q0_;
}

VectorXd Plant::qd() const {
  return S_ * view(data_->qvel, dof());
}

MatrixXd Plant::inertia() const {
  RowMajor M(dof(), dof());
  mj_fullM(model_.get(), M.data(), data_->qM);
  // B = S^-T M S^-1
  const MatrixXd half = St_lu_.solve(M);
  return St_lu_.solve(half.transpose()).transpose();
}

VectorXd Plant::bias() const {
  return St_lu_.solve(view(data_->qfrc_bias, dof()));
}

VectorXd Plant::friction() const {
  // damping is passive; frictionloss is a constraint, and the only one counted here
  VectorXd dry = VectorXd::Zero(dof());
  for (int r = 0; r < data_->nefc; ++r) {
    const int type = data_->efc_type[r];
    if (type != mjCNSTR_FRICTION_DOF && type != mjCNSTR_FRICTION_TENDON) continue;
    if (mj_isSparse(model_.get())) throw std::runtime_error("dry friction needs a dense Jacobian");
    dry += data_->efc_force[r] * view(data_->efc_J + r * dof(), dof());
  }
  return -St_lu_.solve(view(data_->qfrc_passive, dof()) + dry);
}

VectorXd Plant::qdd() const {
  return S_ * view(data_->qacc, dof());
}

VectorXd Plant::tau_ext_of(const Eigen::Vector3d& f, const std::string& site) const {
  const int id = mj_name2id(model_.get(), mjOBJ_SITE, site.c_str());
  if (id < 0) throw std::invalid_argument(fmt::format("the robot has no site '{}'", site));
  RowMajor J(3, dof());
  mj_jacSite(model_.get(), data_.get(), J.data(), nullptr, id);
  return -St_lu_.solve(J.transpose() * f);
}

void Plant::step(double h) {
  const double timestep = model_->opt.timestep;
  if (h == timestep) {
    mj_RungeKutta(model_.get(), data_.get(), 4);
  } else {
    // the step is a field of the model; a copy of the struct shares its arrays
    mjModel m = *model_;
    m.opt.timestep = h;
    mj_RungeKutta(&m, data_.get(), 4);
  }
  mj_forward(model_.get(), data_.get());
  for (int w = 0; w < mjNWARNING; ++w) {
    if (data_->warning[w].number == 0) continue;
    throw std::runtime_error(fmt::format("MuJoCo warned at t = {} s: {}", data_->time,
                                         mju_warningText(w, data_->warning[w].lastinfo)));
  }
}

}  // namespace tauext

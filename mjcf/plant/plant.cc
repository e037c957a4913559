// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/plant.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "mjcf/mujoco/mujoco_functions.h"
#include "mjcf/mujoco/ties.h"

namespace tauext {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::Map<const VectorXd> view(const mjtNum* p, int n) {
  return {p, n};
}

bool is_limit(int type) {
  return type == mjCNSTR_LIMIT_JOINT || type == mjCNSTR_LIMIT_TENDON;
}

}  // namespace

Plant::Plant(Model model)
    : model_(std::move(model)), data_(initial_state(*model_)), is_tied_(has_rigid_ties(*model_)) {
  const mjModel& m = *model_;
  if (m.opt.integrator != mjINT_RK4) {
    throw std::invalid_argument(
        "the model must set <option integrator=\"RK4\"/>: Euler would equal "
        "the estimators' own model, and implicit gains energy");
  }
  layout_ = layout_of(m, *data_);
  if (layout_.load_dof >= 0) load_ = LoadState::kHeld;
  end_effector_ = end_effector_of(m, layout_.arm.back());
  if (is_tied_) {  // the model's initial state may be off them
    put_arm(q(), qd());
    mj_forward(&m, data_.get());
  }
}

VectorXd Plant::of_arm(const double* force) const {
  const VectorXd f = view(force, model_->nv)(layout_.arm);
  return layout_.T.transpose() * f;
}

void Plant::set_state(const VectorXd& q, const VectorXd& qd) {
  mj_resetData(model_.get(), data_.get());
  put_arm(q, qd);
  tau_ext_ = VectorXd::Zero(dof());
  push_.setZero();
  if (load_ != LoadState::kNone) {
    load_ = LoadState::kHeld;
    Eigen::Map<Vector3d>(data_->qpos + layout_.load_dof) = Vector3d(1.2, 0, 0.5);  // beside the arm
    mj_forward(model_.get(), data_.get());
    apply_to_load();
  }
  mj_forward(model_.get(), data_.get());
}

void Plant::set_pose(const VectorXd& q) {
  put_arm(q, VectorXd::Zero(dof()));
  mj_fwdPosition(model_.get(), data_.get());
}

void Plant::put_arm(const VectorXd& q, const VectorXd& qd) {
  Eigen::Map<VectorXd>(data_->qpos, model_->nq)(layout_.arm) = layout_.T * q + layout_.rho0;
  Eigen::Map<VectorXd>(data_->qvel, model_->nv)(layout_.arm) = layout_.T * qd;
}

void Plant::set_input(const VectorXd& tau, const VectorXd& tau_ext) {
  const mjModel& m = *model_;
  for (int i = 0; i < dof(); ++i) {
    const double limit[] = {m.actuator_ctrlrange[2 * i], m.actuator_ctrlrange[2 * i + 1]};
    data_->ctrl[i] = m.actuator_ctrllimited[i] ? std::clamp(tau[i], limit[0], limit[1]) : tau[i];
  }
  Eigen::Map<VectorXd> applied(data_->qfrc_applied, m.nv);
  tau_ext_ = tau_ext;
  applied(layout_.arm) = -layout_.S.transpose() * tau_ext;
  apply_to_load();
  mj_forwardSkip(&m, data_.get(), mjSTAGE_VEL, 1);
}

void Plant::apply_to_load() {
  if (load_ == LoadState::kNone) return;
  data_->ctrl[layout_.tether] = load_ == LoadState::kHung;
  // held in a hand it does not move
  Eigen::Map<Vector3d>(data_->qfrc_applied + layout_.load_dof) =
      load_ == LoadState::kHeld ? Vector3d(Vector3d::Map(data_->qfrc_bias + layout_.load_dof))
                                : push_;
}

void Plant::hang_load() {
  if (load_ == LoadState::kNone) {
    throw std::invalid_argument("the model has no load: load it with the scene \"load\"");
  }
  const mjModel& m = *model_;
  load_ = LoadState::kHung;
  const double* const gain =
      m.actuator_gainprm + static_cast<std::ptrdiff_t>(layout_.tether) * mjNGAIN;
  const double stiffness = -gain[1], length = gain[0] / stiffness;
  const double weight = m.body_mass[m.dof_bodyid[layout_.load_dof]] * -m.opt.gravity[2];
  const Point end = site("end_effector");
  Eigen::Map<Vector3d>(data_->qpos + layout_.load_dof) =
      end.position - Vector3d(0, 0, length + weight / stiffness);
  Eigen::Map<Vector3d>(data_->qvel + layout_.load_dof) = end.velocity;
  apply_to_load();
  mj_forward(&m, data_.get());
}

void Plant::drop_load() {
  if (load_ != LoadState::kHung) return;
  load_ = LoadState::kDropped;
  push_.setZero();
  apply_to_load();
  mj_forward(model_.get(), data_.get());
}

VectorXd Plant::q() const {
  return layout_.S * view(data_->qpos, model_->nq)(layout_.arm) + layout_.q0;
}

VectorXd Plant::qd() const {
  return layout_.S * view(data_->qvel, model_->nv)(layout_.arm);
}

VectorXd Plant::tau() const {
  return view(data_->ctrl, dof());
}

MatrixXd Plant::inertia() const {
  const MatrixXd M = mass_matrix(*model_, *data_);
  return layout_.T.transpose() * M(layout_.arm, layout_.arm) * layout_.T;
}

VectorXd Plant::bias() const {
  return of_arm(data_->qfrc_bias);
}

VectorXd Plant::damping() const {
  return -of_arm(data_->qfrc_passive);
}

// sum of J^T f over the constraint rows of a type that counts
template <class Counts>
VectorXd Plant::constraint_force(Counts&& counts) const {
  VectorXd sum = VectorXd::Zero(model_->nv);
  for (int r = 0; r < data_->nefc; ++r) {
    if (!counts(data_->efc_type[r])) continue;
    if (mj_isSparse(model_.get())) throw std::runtime_error("constraints need a dense Jacobian");
    sum += data_->efc_force[r] * view(data_->efc_J + r * model_->nv, model_->nv);
  }
  return of_arm(sum.data());
}

VectorXd Plant::friction() const {
  return damping() - constraint_force([](int type) {
           return type == mjCNSTR_FRICTION_DOF || type == mjCNSTR_FRICTION_TENDON;
         });
}

VectorXd Plant::qdd() const {
  return layout_.S * view(data_->qacc, model_->nv)(layout_.arm);
}

VectorXd Plant::limit_torque() const {
  return -constraint_force([](int type) { return is_limit(type); });
}

std::vector<int> Plant::joints_at_limits() const {
  std::vector<int> joints;
  const VectorXd torque = limit_torque();
  for (int i = 0; i < dof(); ++i) {
    if (torque[i] != 0) joints.push_back(i);
  }
  return joints;
}

VectorXd Plant::tau_ext() const {
  VectorXd sum = constraint_force([](int type) {
    return type == mjCNSTR_CONTACT_FRICTIONLESS || type == mjCNSTR_CONTACT_PYRAMIDAL ||
           type == mjCNSTR_CONTACT_ELLIPTIC;
  });
  if (layout_.tether >= 0) {
    const VectorXd pull =
        data_->actuator_force[layout_.tether] * levers(*model_, *data_, layout_.tether);
    sum += of_arm(pull.data());
  }
  return tau_ext_ - sum;
}

double Plant::contact_force() const {
  double sum = 0;
  for (int c = 0; c < data_->ncon; ++c) {
    const int row = data_->contact[c].efc_address;
    if (row < 0 || view(data_->efc_J + row * model_->nv, model_->nv)(layout_.arm).isZero(0))
      continue;
    mjtNum wrench[6];
    mj_contactForce(model_.get(), data_.get(), c, wrench);
    sum += wrench[0];
  }
  return sum;
}

BodyPoint Plant::place(const std::string& name) const {
  if (name == kEndEffector) return end_effector_;
  if (const int id = mj_name2id(model_.get(), mjOBJ_SITE, name.c_str()); id >= 0)
    return {model_->site_bodyid[id], Vector3d::Map(model_->site_pos + 3 * id), name};
  if (const int id = mj_name2id(model_.get(), mjOBJ_BODY, name.c_str()); id >= 0)
    return {id, Vector3d::Zero(), name};
  throw std::invalid_argument(fmt::format("the robot has no site or body '{}'", name));
}

Vector3d Plant::position(const BodyPoint& c) const {
  return Vector3d::Map(data_->xpos + 3 * c.body) +
         Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(data_->xmat + 9 * c.body) *
             c.at;
}

MatrixXd Plant::jacobian(const BodyPoint& c) const {
  RowMajor J(3, model_->nv);
  mj_jac(model_.get(), data_.get(), J.data(), nullptr, position(c).data(), c.body);
  return J;
}

Point Plant::point(const BodyPoint& c) const {
  return {position(c), jacobian(c) * view(data_->qvel, model_->nv)};
}

VectorXd Plant::tau_ext_of(const Vector3d& f, const BodyPoint& c) const {
  const VectorXd force = jacobian(c).transpose() * f;
  return -of_arm(force.data());
}

MatrixXd Plant::end_effector_jacobian() const {
  return jacobian(end_effector_)(Eigen::indexing::all, layout_.arm) * layout_.T;
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
  if (is_tied_) put_arm(q(), qd());  // else rounding would move the joints off their ties
  mj_forward(model_.get(), data_.get());
  for (int w = 0; w < mjNWARNING; ++w) {
    if (data_->warning[w].number == 0) continue;
    throw std::runtime_error(fmt::format("MuJoCo warned at t = {} s: {}", data_->time,
                                         mju_warningText(w, data_->warning[w].lastinfo)));
  }
}

}  // namespace tauext

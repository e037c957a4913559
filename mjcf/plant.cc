// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <stdexcept>

namespace tauext {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::Map<const VectorXd> view(const mjtNum* p, int n) {
  return {p, n};
}

Eigen::Map<const Vector3d> view3(const mjtNum* p) {
  return Eigen::Map<const Vector3d>(p);
}

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

std::string name_of(const mjModel& m, mjtObj type, int id) {
  const char* const name = mj_id2name(&m, type, id);
  return name == nullptr ? "" : name;
}

// the triangle of a spatial tendon between two sites that spans one hinge
Screw triangle(const mjModel& m, const mjData& d, int actuator, int dof) {
  const int tendon = m.actuator_trnid[2 * actuator], first = m.tendon_adr[tendon];
  const int joint = m.dof_jntid[dof];
  if (m.tendon_num[tendon] != 2 || m.wrap_type[first] != mjWRAP_SITE ||
      m.wrap_type[first + 1] != mjWRAP_SITE || m.jnt_type[joint] != mjJNT_HINGE) {
    throw std::invalid_argument(
        fmt::format("tendon '{}': a screw runs between two sites across one hinge",
                    name_of(m, mjOBJ_TENDON, tendon)));
  }
  const Vector3d hinge = view3(d.xanchor + 3 * joint), axis = view3(d.xaxis + 3 * joint);
  const auto in_plane = [&](int wrap) -> Vector3d {
    const Vector3d r = view3(d.site_xpos + 3 * m.wrap_objid[wrap]) - hinge;
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

}  // namespace

Plant::Plant(Model model)
    : model_(std::move(model)), data_(mj_makeData(model_.get()), mj_deleteData) {
  const mjModel& m = *model_;
  if (m.nq != m.nv || m.nv == 0) {
    throw std::invalid_argument("the model has free or ball joints, which are not supported");
  }
  if (m.opt.integrator != mjINT_RK4) {
    throw std::invalid_argument(
        "the model must set <option integrator=\"RK4\"/>: Euler would equal "
        "the estimators' own model, and implicit gains energy");
  }
  mj_forward(&m, data_.get());
  find_coordinates();
  find_scene();
}

void Plant::find_coordinates() {
  const mjModel& m = *model_;
  while (dof_ < m.nu && is_coordinate(m, dof_)) ++dof_;
  const Eigen::Map<const RowMajor> moment(data_->actuator_moment, m.nu, m.nv);
  for (int j = 0; j < m.nv; ++j) {
    if (!moment.topRows(dof_).col(j).isZero(0)) arm_.push_back(j);
  }
  if (dof_ == 0 || static_cast<int>(arm_.size()) != dof_) {
    throw std::invalid_argument(fmt::format(
        "the first {} actuators move {} degrees of freedom; every joint coordinate needs its own "
        "<motor> of gain 1 on a joint or a fixed tendon{}",
        dof_, arm_.size(),
        dof_ < m.nu ? fmt::format(", and '{}' is none", name_of(m, mjOBJ_ACTUATOR, dof_)) : ""));
  }
  S_ = moment.topRows(dof_)(Eigen::all, arm_);
  if (Eigen::FullPivLU<MatrixXd>(S_).rank() < dof_) {
    throw std::invalid_argument("the actuators' lengths do not determine every joint's position");
  }
  S_lu_.compute(S_);
  St_lu_.compute(S_.transpose());
  q0_ = view(data_->actuator_length, dof_) - S_ * view(data_->qpos, m.nv)(arm_);
}

void Plant::find_scene() {
  const mjModel& m = *model_;
  int i = dof_;
  for (; i < m.nu && is_screw(m, i); ++i) {
    if (i >= 2 * dof_) break;
    screws_.push_back(triangle(m, *data_, i, arm_[i - dof_]));
  }
  if (!screws_.empty() && static_cast<int>(screws_.size()) != dof_) {
    throw std::invalid_argument(fmt::format(
        "{} screws for {} joints: every joint needs one, or none", screws_.size(), dof_));
  }
  const int load = mj_name2id(&m, mjOBJ_BODY, "load");
  if (load >= 0) {
    tether_ = mj_name2id(&m, mjOBJ_ACTUATOR, "tether");
    load_dof_ = m.body_dofadr[load];
    if (tether_ != i || m.body_dofnum[load] != 3) {
      throw std::invalid_argument("a load needs three slides and the actuator 'tether'");
    }
    ++i;
    load_ = LoadState::kHeld;
  }
  if (i < m.nu) {
    throw std::invalid_argument(fmt::format(
        "actuator {} ('{}') must be a <motor> of gain 1 on a joint or a fixed tendon: its "
        "length is a joint coordinate and its force that joint's torque",
        i, name_of(m, mjOBJ_ACTUATOR, i)));
  }
  // bodies of the scene must not hang in the arm's tree: B is the arm's alone
  for (int j = 0; j < m.nv; ++j) {
    for (int parent = m.dof_parentid[j]; parent >= 0; parent = m.dof_parentid[parent]) {
      if (std::count(arm_.begin(), arm_.end(), j) == std::count(arm_.begin(), arm_.end(), parent))
        continue;
      throw std::invalid_argument(
          fmt::format("joint '{}' has no motor of its own, or hangs on one that has none",
                      name_of(m, mjOBJ_JOINT, m.dof_jntid[j])));
    }
  }
}

VectorXd Plant::of_arm(const double* force) const {
  const VectorXd f = view(force, model_->nv)(arm_);
  return St_lu_.solve(f);
}

void Plant::set_state(const VectorXd& q, const VectorXd& qd) {
  mj_resetData(model_.get(), data_.get());
  const VectorXd rho = S_lu_.solve(q - q0_), rho_dot = S_lu_.solve(qd);
  Eigen::Map<VectorXd>(data_->qpos, model_->nq)(arm_) = rho;
  Eigen::Map<VectorXd>(data_->qvel, model_->nv)(arm_) = rho_dot;
  tau_ext_ = VectorXd::Zero(dof_);
  push_.setZero();
  if (load_ != LoadState::kNone) {
    load_ = LoadState::kHeld;
    Eigen::Map<Vector3d>(data_->qpos + load_dof_) = Vector3d(1.2, 0, 0.5);  // beside the arm
  }
  mj_forward(model_.get(), data_.get());
}

void Plant::set_input(const VectorXd& tau, const VectorXd& tau_ext) {
  const mjModel& m = *model_;
  for (int i = 0; i < dof_; ++i) {
    const double limit[] = {m.actuator_ctrlrange[2 * i], m.actuator_ctrlrange[2 * i + 1]};
    data_->ctrl[i] = m.actuator_ctrllimited[i] ? std::clamp(tau[i], limit[0], limit[1]) : tau[i];
  }
  Eigen::Map<VectorXd> applied(data_->qfrc_applied, m.nv);
  tau_ext_ = tau_ext;
  applied(arm_) = -S_.transpose() * tau_ext;
  apply_to_load();
  mj_forwardSkip(&m, data_.get(), mjSTAGE_VEL, 1);
}

void Plant::apply_to_load() {
  if (load_ == LoadState::kNone) return;
  data_->ctrl[tether_] = load_ == LoadState::kHung;
  // held in a hand it does not move
  Eigen::Map<Vector3d>(data_->qfrc_applied + load_dof_) =
      load_ == LoadState::kHeld ? Vector3d(view3(data_->qfrc_bias + load_dof_)) : push_;
}

void Plant::hang_load() {
  if (load_ == LoadState::kNone) {
    throw std::invalid_argument("the model has no load: load it with the scene \"load\"");
  }
  const mjModel& m = *model_;
  load_ = LoadState::kHung;
  const double* const gain = m.actuator_gainprm + static_cast<std::ptrdiff_t>(tether_) * mjNGAIN;
  const double stiffness = -gain[1], length = gain[0] / stiffness;
  const double weight = m.body_mass[m.dof_bodyid[load_dof_]] * -m.opt.gravity[2];
  const Point end = site("end_effector");
  Eigen::Map<Vector3d>(data_->qpos + load_dof_) =
      end.position - Vector3d(0, 0, length + weight / stiffness);
  Eigen::Map<Vector3d>(data_->qvel + load_dof_) = end.velocity;
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
  return S_ * view(data_->qpos, model_->nq)(arm_) + q0_;
}

VectorXd Plant::qd() const {
  return S_ * view(data_->qvel, model_->nv)(arm_);
}

VectorXd Plant::tau() const {
  return view(data_->ctrl, dof_);
}

MatrixXd Plant::inertia() const {
  RowMajor M(model_->nv, model_->nv);
  mj_fullM(model_.get(), M.data(), data_->qM);
  // B = S^-T M S^-1
  const MatrixXd half = St_lu_.solve(MatrixXd(M(arm_, arm_)));
  return St_lu_.solve(half.transpose()).transpose();
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
  return S_ * view(data_->qacc, model_->nv)(arm_);
}

VectorXd Plant::tau_ext() const {
  VectorXd sum = constraint_force([](int type) {
    return type == mjCNSTR_CONTACT_FRICTIONLESS || type == mjCNSTR_CONTACT_PYRAMIDAL ||
           type == mjCNSTR_CONTACT_ELLIPTIC;
  });
  if (tether_ >= 0) {
    const VectorXd pull = data_->actuator_force[tether_] *
                          view(data_->actuator_moment + tether_ * model_->nv, model_->nv);
    sum += of_arm(pull.data());
  }
  return tau_ext_ - sum;
}

double Plant::contact_force() const {
  double sum = 0;
  for (int c = 0; c < data_->ncon; ++c) {
    const int row = data_->contact[c].efc_address;
    if (row < 0 || view(data_->efc_J + row * model_->nv, model_->nv)(arm_).isZero(0)) continue;
    mjtNum wrench[6];
    mj_contactForce(model_.get(), data_.get(), c, wrench);
    sum += wrench[0];
  }
  return sum;
}

int Plant::site_id(const std::string& name) const {
  const int id = mj_name2id(model_.get(), mjOBJ_SITE, name.c_str());
  if (id < 0) throw std::invalid_argument(fmt::format("the robot has no site '{}'", name));
  return id;
}

Point Plant::site(const std::string& name) const {
  const int id = site_id(name);
  RowMajor J(3, model_->nv);
  mj_jacSite(model_.get(), data_.get(), J.data(), nullptr, id);
  return {view3(data_->site_xpos + 3 * id), J * view(data_->qvel, model_->nv)};
}

VectorXd Plant::tau_ext_of(const Vector3d& f, const std::string& site) const {
  RowMajor J(3, model_->nv);
  mj_jacSite(model_.get(), data_.get(), J.data(), nullptr, site_id(site));
  const VectorXd force = J.transpose() * f;
  return -of_arm(force.data());
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

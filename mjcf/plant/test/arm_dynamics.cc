// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/arm_dynamics.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "mjcf/plant/layout.h"

namespace tauext {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kSlip = 0.01;  // [rad/s] of CoulombFriction's tanh

void check(const mjModel& m) {
  const auto refuse = [](bool present, const char* what) {
    if (present)
      throw std::invalid_argument(std::string("the model has ") + what + ": not supported");
  };
  if (m.nq != m.nv || m.nv == 0) {
    throw std::invalid_argument(
        "an arm of hinges and slides is wanted: the model has free or ball joints, or none");
  }
  refuse(m.neq > 0, "joints tied together by <equality>");
  refuse(!Eigen::VectorXd::Map(m.jnt_stiffness, m.njnt).isZero(0), "springs in joints");
  for (const mjtNum* forces : {m.tendon_stiffness, m.tendon_damping, m.tendon_frictionloss}) {
    refuse(!Eigen::VectorXd::Map(forces, m.ntendon).isZero(0), "tendons with springs or friction");
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
Layout coordinates(const mjModel& m, const mjData& d) {
  if (!has_tendon_coordinates(m)) {
    Layout l;
    l.dof = m.nv;
    l.S = MatrixXd::Identity(m.nv, m.nv);
    return l;
  }
  Layout l = layout_of(m, d);
  for (int i = 0; i < l.dof; ++i) {
    if (m.actuator_gear[6 * i] == 1) continue;
    throw std::invalid_argument(
        fmt::format("motor {} has a gear of {}: where motors on tendons say what the joint "
                    "coordinates are, their gears must be 1",
                    i, m.actuator_gear[6 * i]));
  }
  if (l.dof != m.nv) throw std::invalid_argument("the motors do not move every joint of the model");
  return l;
}

}  // namespace

void detail::require_equal_joints(int have, int want) {
  if (have == want) return;
  throw std::invalid_argument(fmt::format("the model has {} joints, not {}", have, want));
}

// rho are MuJoCo's coordinates, q = S rho + q0; forces of q are S^-T those of rho
struct ArmDynamics::Workspace {
  explicit Workspace(Model m) : model(std::move(m)), data(initial_state(*model)) {
    check(*model);
    const int n = model->nv;
    S = coordinates(*model, *data).S;
    S_inv = S.inverse();  // once: steps below multiply, which allocates nothing
    q0 = VectorXd::Zero(n);
    if (!S.isIdentity(0)) {
      q0 = VectorXd::Map(data->actuator_length, n) - S * VectorXd::Map(data->qpos, n);
    }
    damping = VectorXd::Map(model->dof_damping, n);
    dry = VectorXd::Map(model->dof_frictionloss, n);
    for (VectorXd* v : {&rho, &force, &at, &moved}) *v = VectorXd::Zero(n);
    M = B_ahead = RowMajor::Zero(n, n);
    half = MatrixXd::Zero(n, n);
  }

  void move_to(const double* q, const double* qd) {
    const int n = model->nv;
    moved = VectorXd::Map(q, n) - q0;
    rho.noalias() = S_inv * moved;
    VectorXd::Map(data->qpos, n) = rho;
    if (qd == nullptr) {
      VectorXd::Map(data->qvel, n).setZero();
    } else {
      VectorXd::Map(data->qvel, n).noalias() = S_inv * VectorXd::Map(qd, n);
    }
    mj_kinematics(model.get(), data.get());
    mj_comPos(model.get(), data.get());
  }

  // B = S^-T M S^-1
  void inertia(const double* q, double* B) {
    const int n = model->nv;
    move_to(q, nullptr);
    mj_crb(model.get(), data.get());
    mj_fullM(model.get(), M.data(), data->qM);
    half.noalias() = M * S_inv;
    MatrixXd::Map(B, n, n).noalias() = S_inv.transpose() * half;
  }

  void bias(const double* q, const double* qd, double* out) {
    const int n = model->nv;
    move_to(q, qd);
    mj_comVel(model.get(), data.get());
    mj_rne(model.get(), data.get(), 0, force.data());
    VectorXd::Map(out, n).noalias() = S_inv.transpose() * force;
  }

  Model model;
  State data;
  MatrixXd S, S_inv, half;
  RowMajor M, B_ahead;
  VectorXd q0, damping, dry, rho, force, at, moved;
};

ArmDynamics::ArmDynamics(Model model) : work_(std::make_unique<Workspace>(std::move(model))) {}
ArmDynamics::ArmDynamics(const ArmDynamics& other) : ArmDynamics(other.work_->model) {}
ArmDynamics::~ArmDynamics() = default;

int ArmDynamics::dof() const noexcept {
  return work_->model->nv;
}

void ArmDynamics::inertia(const double* q, double* B) const noexcept {
  work_->inertia(q, B);
}

void ArmDynamics::bias(const double* q, const double* qd, double* out) const noexcept {
  work_->bias(q, qd, out);
}

void ArmDynamics::gravity(const double* q, double* out) const noexcept {
  work_->bias(q, nullptr, out);
}

void ArmDynamics::momentum_bias(const double* q, const double* qd, double* out) const noexcept {
  Workspace& s = *work_;
  const int n = dof();
  auto result = VectorXd::Map(out, n);
  const auto speed = VectorXd::Map(qd, n);
  // C^T qd - g = dB/dt qd - (C qd + g), g being in both
  s.bias(q, qd, out);
  result = -result;
  const double norm = speed.norm();
  if (norm == 0) return;
  // (8 (B(+e) - B(-e)) - (B(+2e) - B(-2e))) / 12e along the motion
  const double step = 1e-2 / norm;
  constexpr double kWeights[][2] = {{1, 8}, {-1, -8}, {2, -1}, {-2, 1}};
  for (const auto& [ahead, weight] : kWeights) {
    s.at = VectorXd::Map(q, n) + ahead * step * speed;
    s.inertia(s.at.data(), s.B_ahead.data());  // symmetric: its order of storage does not matter
    s.moved.noalias() = s.B_ahead * speed;
    result += weight / (12 * step) * s.moved;
  }
}

void ArmDynamics::friction(const double* qd, double* out) const noexcept {
  Workspace& s = *work_;
  const int n = dof();
  s.rho.noalias() = s.S_inv * VectorXd::Map(qd, n);
  for (int j = 0; j < n; ++j) {
    s.force[j] = s.damping[j] * s.rho[j] + s.dry[j] * std::tanh(s.rho[j] / kSlip);
  }
  VectorXd::Map(out, n).noalias() = s.S_inv.transpose() * s.force;
}

}  // namespace tauext

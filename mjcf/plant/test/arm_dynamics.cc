// SPDX-License-Identifier: Apache-2.0
#include "mjcf/plant/test/arm_dynamics.h"

#include <mujoco/mujoco.h>

#include <Eigen/LU>
#include <cmath>
#include <utility>

#include "mjcf/plant/tree.h"

namespace tauext {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

// rho are MuJoCo's coordinates, q = S rho + q0; forces of q are S^-T those of rho
struct ArmDynamics::Workspace {
  explicit Workspace(Model m) : model(std::move(m)), data(initial_state(*model)) {
    const ArmTree tree = tree_of(model);  // of which it takes the coordinates and v_s alone
    const int n = model->nv;
    S = tree.coordinates;
    S_inv = S.inverse();  // once: steps below multiply, which allocates nothing
    q0 = tree.offset;
    damping = VectorXd::Map(model->dof_damping, n);
    dry = VectorXd::Map(model->dof_frictionloss, n);
    v_s = VectorXd::NullaryExpr(
        n, [&](auto i) { return tree.joints[static_cast<std::size_t>(i)].v_s; });
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
  VectorXd q0, v_s, damping, dry, rho, force, at, moved;
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
    s.force[j] = s.damping[j] * s.rho[j] + s.dry[j] * std::tanh(s.rho[j] / s.v_s[j]);
  }
  VectorXd::Map(out, n).noalias() = s.S_inv.transpose() * s.force;
}

}  // namespace tauext

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

// rho = drho q + rho0 are MuJoCo's coordinates; forces of q are drho^T those of rho
struct ArmDynamics::Workspace {
  explicit Workspace(Model m) : model(std::move(m)), data(initial_state(*model)) {
    const ArmTree tree = tree_of(model);  // of which it takes the coordinates and v_s alone
    const int n = model->nv;
    drho = tree.drho;
    rho0 = tree.rho0;
    damping = VectorXd::Map(model->dof_damping, n);
    dry = VectorXd::Map(model->dof_frictionloss, n);
    v_s = VectorXd::NullaryExpr(
        n, [&](auto i) { return tree.joints[static_cast<std::size_t>(i)].v_s; });
    for (VectorXd* v : {&rho, &force}) *v = VectorXd::Zero(n);
    for (VectorXd* v : {&at, &moved}) *v = VectorXd::Zero(dof());
    M = RowMajor::Zero(n, n);
    B_ahead = RowMajor::Zero(dof(), dof());
    half = MatrixXd::Zero(n, dof());
  }
  int dof() const { return static_cast<int>(drho.cols()); }

  void move_to(const double* q, const double* qd) {
    const int n = model->nv;
    rho = rho0;
    rho.noalias() += drho * VectorXd::Map(q, dof());
    VectorXd::Map(data->qpos, n) = rho;
    if (qd == nullptr) {
      VectorXd::Map(data->qvel, n).setZero();
    } else {
      VectorXd::Map(data->qvel, n).noalias() = drho * VectorXd::Map(qd, dof());
    }
    mj_kinematics(model.get(), data.get());
    mj_comPos(model.get(), data.get());
  }

  void inertia(const double* q, double* B) {
    move_to(q, nullptr);
    mj_fwdPosition(model.get(), data.get());
    M = mass_matrix(*model, *data);
    half.noalias() = M * drho;
    MatrixXd::Map(B, dof(), dof()).noalias() = drho.transpose() * half;
  }

  void bias(const double* q, const double* qd, double* out) {
    move_to(q, qd);
    mj_comVel(model.get(), data.get());
    mj_rne(model.get(), data.get(), 0, force.data());
    VectorXd::Map(out, dof()).noalias() = drho.transpose() * force;
  }

  Model model;
  State data;
  MatrixXd drho, half;
  RowMajor M, B_ahead;
  VectorXd rho0, v_s, damping, dry, rho, force, at, moved;
};

ArmDynamics::ArmDynamics(Model model) : work_(std::make_unique<Workspace>(std::move(model))) {}
ArmDynamics::ArmDynamics(const ArmDynamics& other) : ArmDynamics(other.work_->model) {}
ArmDynamics::~ArmDynamics() = default;

int ArmDynamics::dof() const noexcept {
  return work_->dof();
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
  s.rho.noalias() = s.drho * VectorXd::Map(qd, dof());
  for (int j = 0; j < s.model->nv; ++j) {
    s.force[j] = s.damping[j] * s.rho[j] + s.dry[j] * std::tanh(s.rho[j] / s.v_s[j]);
  }
  VectorXd::Map(out, dof()).noalias() = s.drho.transpose() * s.force;
}

}  // namespace tauext

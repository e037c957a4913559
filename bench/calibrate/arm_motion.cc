// SPDX-License-Identifier: Apache-2.0
#include "bench/calibrate/arm_motion.h"

namespace tauext {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// its integral up to each sample; `instant`: by the trapezium rule, else as it holds
MatrixXd integral(const Trace& log, const MatrixXd& f, bool instant) {
  MatrixXd I = MatrixXd::Zero(f.rows(), f.cols());
  for (int k = 0; k + 1 < log.size(); ++k) {
    const VectorXd mean = instant ? VectorXd((f.col(k) + f.col(k + 1)) / 2) : VectorXd(f.col(k));
    I.col(k + 1) = I.col(k) + (log.t[k + 1] - log.t[k]) * mean;
  }
  return I;
}

VectorXd mean(const Trace& log, const MatrixXd& integral, const Window& w) {
  return (integral.col(w.second) - integral.col(w.first)) / (log.t[w.second] - log.t[w.first]);
}

}  // namespace

ArmMotion::ArmMotion(const ArmTree& arm, const Trace& log) : log_(log) {
  const int n = arm.dof(), samples = log.size();
  detail::require_size(arm, log.dof());
  const auto model = detail::filled<TiedTree>(arm);
  momentum_.resize(n, samples);
  MatrixXd rest(n, samples);
  for (int k = 0; k < samples; ++k) {
    Vec<kMostCoordinates> q = Vec<kMostCoordinates>::Zero(), qd = q;
    q.head(n) = log.q.col(k), qd.head(n) = log.qd.col(k);
    const auto d = model.momentum_dynamics(q, qd);
    momentum_.col(k) = (d.B * qd).head(n);
    rest.col(k) = (model.friction(qd) - d.bias).head(n);
  }
  rest_ = integral(log, rest, true);
  impulse_ = integral(log, log.tau, log.torque_at_instants);
}

VectorXd ArmMotion::expected(const Window& w) const {
  const double T = log_.t[w.second] - log_.t[w.first];
  return (momentum_.col(w.second) - momentum_.col(w.first)) / T + mean(log_, rest_, w);
}

VectorXd ArmMotion::measured(const Window& w) const {
  return mean(log_, impulse_, w);
}

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
// The paper's EKF as (10)-(16) print it: dense 9 x 9 matrices and a factorisation of the 6 x 6
// innovation covariance, in any scalar. The oracle of Ekf, and what its speed is compared with.
#pragma once

#include <Eigen/Cholesky>

#include "estimators/ekf.h"
#include "estimators/wallmobot3.h"

namespace tauext::test {

template <class S>
class TextbookEkf {
 public:
  static constexpr const char* kName = "textbook_ekf";
  static constexpr int kDof = 3;
  using Arm = BasicWallMoBot3<S>;

  explicit TextbookEkf(const Ekf<WallMoBot3>::Parameters& p) {
    P0_ = p.P0.cast<S>().asDiagonal();
    Q_ = p.Q.cast<S>().asDiagonal();
    R_ = p.R.cast<S>().asDiagonal();
    H_.setZero();
    H_.template leftCols<6>().setIdentity();
  }

  void reset() noexcept { started_ = false; }

  Estimate<3> update(const Measurement<3>& m) noexcept {
    Vec<6, S> y;
    y << m.q.cast<S>(), m.qd.cast<S>();
    if (!started_) {
      started_ = true;
      x << y, Vec<3, S>::Zero();
      P = P0_;
    } else {
      step(S(m.t) - t_, y);
    }
    t_ = S(m.t);
    tau_ = m.tau.cast<S>();
    return {x.template tail<3>().template cast<double>(), Status::kOk};
  }

  Vec<9, S> x = Vec<9, S>::Zero();
  Mat<9, S> P = Mat<9, S>::Zero();

 private:
  void step(const S& h, const Vec<6, S>& y) {
    const Vec<3, S> q = x.template head<3>(), qd = x.template segment<3>(3),
                    d = x.template tail<3>();
    const auto f = arm_.forward_dynamics(q, qd, Vec<3, S>(tau_ - d));
    Vec<9, S> xdot;
    xdot << qd, f.qdd, Vec<3, S>::Zero();
    Mat<9, S> F = Mat<9, S>::Identity();  // (15)
    F.template block<3, 3>(0, 3) += h * Mat<3, S>::Identity();
    F.template block<3, 3>(3, 0) += h * f.dqdd_dq;
    F.template block<3, 3>(3, 3) += h * f.dqdd_dqd;
    F.template block<3, 3>(3, 6) += h * f.dqdd_dtau_ext;
    x += h * xdot;  // (10)
    P = Mat<9, S>(F * P * F.transpose()) + Q_;

    const Mat<6, S> innovation = H_ * P * H_.transpose() + R_;  // (14)
    const Eigen::LLT<Mat<6, S>> factor(innovation);
    const Eigen::Matrix<S, 9, 6> K = factor.solve(H_ * P).transpose();
    x += K * (y - H_ * x);
    P = Mat<9, S>((Mat<9, S>::Identity() - K * H_) * P);
    P = Mat<9, S>(S(0.5) * (P + P.transpose()));  // without this it overflows within 30 s
  }

  Arm arm_;
  Mat<9, S> P0_, Q_;
  Mat<6, S> R_;
  Eigen::Matrix<S, 6, 9> H_;
  Vec<3, S> tau_ = Vec<3, S>::Zero();
  S t_{};
  bool started_ = false;
};

}  // namespace tauext::test

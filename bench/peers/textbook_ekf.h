// SPDX-License-Identifier: Apache-2.0
/// @file
/// The paper's EKF as (10)-(16) print it: dense 3N x 3N matrices and a factorisation of the 2N x 2N
/// innovation covariance, in any scalar. The oracle of Ekf, and what its speed is compared with.
#pragma once

#include <Eigen/Cholesky>
#include <stdexcept>

#include "estimators/ekf.h"
#include "estimators/wallmobot3.h"

namespace tauext::peers {

template <class S, class Arm = BasicWallMoBot3<S>>
class TextbookEkf {
 public:
  static constexpr const char* kName = "textbook_ekf";
  static constexpr int N = Arm::kDof, kDof = N;

  template <class Parameters>
  explicit TextbookEkf(const Parameters& p, const Arm& arm = Arm())
      : second_order_(p.integration == Integration::kSecondOrder),
        Ts_(p.Ts),
        Q_load_(p.Q_load),
        arm_(arm) {
    P0_ = p.P0.template cast<S>().asDiagonal();
    Q_ = p.Q.template cast<S>().asDiagonal();
    R_ = p.R.template cast<S>().asDiagonal();
    H_.setZero();
    H_.template leftCols<2 * N>().setIdentity();
  }

  void reset() noexcept { started_ = false; }

  Estimate<N> update(const Measurement<N>& m) noexcept {
    Vec<2 * N, S> y;
    y << m.q.template cast<S>(), m.qd.template cast<S>();
    if (!started_) {
      started_ = true;
      x << y, Vec<N, S>::Zero();
      P = P0_;
      P.template bottomRightCorner<N, N>() += S(10) * load(x.template head<N>());
    } else {
      step(S(m.t) - t_, y);
    }
    t_ = S(m.t);
    tau_ = m.tau.template cast<S>();
    return {x.template tail<N>().template cast<double>(), Status::kOk};
  }

  Vec<3 * N, S> x = Vec<3 * N, S>::Zero();
  Mat<3 * N, S> P = Mat<3 * N, S>::Zero();

 private:
  // what Q_load adds to Q of tau_ext
  Mat<N, S> load(const Vec<N, S>& q) const {
    if constexpr (requires { arm_.inertia(q); }) {
      const Mat<N, S> B = arm_.inertia(q);
      return S(Q_load_) * B * B.transpose();
    } else if (Q_load_ != 0) {
      throw std::invalid_argument("Q_load wants an arm that knows its inertia");
    }
    return Mat<N, S>::Zero();
  }

  void step(const S& h, const Vec<2 * N, S>& y) {
    const Vec<N, S> q = x.template head<N>(), qd = x.template segment<N>(N),
                    d = x.template tail<N>();
    const auto f = arm_.forward_dynamics(q, qd, Vec<N, S>(tau_ - d));
    Vec<3 * N, S> xdot;
    xdot << qd, f.qdd, Vec<N, S>::Zero();
    Mat<3 * N, S> F = Mat<3 * N, S>::Identity();  // (15)
    F.template block<N, N>(0, N) += h * Mat<N, S>::Identity();
    F.template block<N, N>(N, 0) += h * f.dqdd_dq;
    F.template block<N, N>(N, N) += h * f.dqdd_dqd;
    F.template block<N, N>(N, 2 * N) += h * f.dqdd_dtau_ext;
    const S steps = Ts_ > 0 ? S(h / Ts_) : S(1);
    x += h * xdot;        // (10)
    if (second_order_) {  // F - I is h times the Jacobian of xdot
      x += S(0.5) * h * ((F - Mat<3 * N, S>::Identity()) * xdot);
    }
    P = Mat<3 * N, S>(F * P * F.transpose()) + steps * Q_;
    P.template bottomRightCorner<N, N>() += steps * load(q);

    const Mat<2 * N, S> innovation = H_ * P * H_.transpose() + R_ / steps;  // (14)
    const Eigen::LLT<Mat<2 * N, S>> factor(innovation);
    const Eigen::Matrix<S, 3 * N, 2 * N> K = factor.solve(H_ * P).transpose();
    x += K * (y - H_ * x);
    P = Mat<3 * N, S>((Mat<3 * N, S>::Identity() - K * H_) * P);
    P = Mat<3 * N, S>(S(0.5) * (P + P.transpose()));  // without this it overflows within 30 s
  }

  bool second_order_;
  double Ts_, Q_load_;
  Arm arm_;
  Mat<3 * N, S> P0_, Q_;
  Mat<2 * N, S> R_;
  Eigen::Matrix<S, 2 * N, 3 * N> H_;
  Vec<N, S> tau_ = Vec<N, S>::Zero();
  S t_{};
  bool started_ = false;
};

}  // namespace tauext::peers

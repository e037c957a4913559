// SPDX-License-Identifier: Apache-2.0
/// @file
/// Estimators as an engineer writes them with KDL in an afternoon, by the textbook and
/// Euler steps, and KDL's own; and nothing that judges samples.
#pragma once

#include <kdl/chainexternalwrenchestimator.hpp>
#include <kdl/frames.hpp>
#include <kdl/jntarray.hpp>
#include <memory>

#include "bench/peers/kdl_arm.h"

namespace tauext::peers {

/// The momentum observer r = K (p - integral of tau + C^T qd - g - F + r) of momentum_observer.h's
/// sources, tau_ext = -r. C^T qd is Bdot qd - C qd, Bdot by a difference.
template <int N>
class KdlMomentumObserver {
 public:
  static constexpr const char* kName = "kdl_momentum";
  static constexpr int kDof = N;

  /// @param K [rad/s] bandwidth of every joint
  KdlMomentumObserver(const KdlArm<N>& arm, double K) : arm_(arm), K_(K) {}

  void reset() noexcept { started_ = false; }
  Estimate<N> update(const Measurement<N>& y) noexcept {
    const Mat<N> B = arm_.inertia(y.q);
    const Vec<N> p = B * y.qd;
    if (started_) {
      const double h = y.t - t_;
      const Vec<N> transposed = (B - B_) / h * y.qd - arm_.coriolis(y.q, y.qd);
      integral_ += h * (tau_ + transposed - arm_.gravity(y.q) - arm_.friction(y.qd) + r_);
      r_ = K_ * (p - integral_ - p0_);
    } else {
      p0_ = p;
      integral_.setZero(), r_.setZero();
    }
    started_ = true;
    t_ = y.t, B_ = B, tau_ = y.tau;
    return {-r_};
  }

 private:
  KdlArm<N> arm_;
  double K_, t_ = 0;
  bool started_ = false;
  Mat<N> B_;
  Vec<N> tau_, integral_, r_, p0_;
};

/// The NDOB of the paper, (17) to (19), with the gain X = w B: L = w, so that with z = tau_ext + w
/// p the two terms of B cancel, zdot = w (tau + C^T qd - g - F - tau_ext).
template <int N>
class KdlNdob {
 public:
  static constexpr const char* kName = "kdl_ndob";
  static constexpr int kDof = N;

  /// @param w [rad/s] bandwidth of every joint
  KdlNdob(const KdlArm<N>& arm, double w) : arm_(arm), w_(w) {}

  void reset() noexcept { started_ = false; }
  Estimate<N> update(const Measurement<N>& y) noexcept {
    const Mat<N> B = arm_.inertia(y.q);
    const Vec<N> p = B * y.qd;
    if (!started_) {
      d_.setZero();
      z_ = w_ * p;
    } else {
      const double h = y.t - t_;
      const Vec<N> transposed = (B - B_) / h * y.qd - arm_.coriolis(y.q, y.qd);
      z_ += h * w_ * (tau_ + transposed - arm_.gravity(y.q) - arm_.friction(y.qd) - d_);
      d_ = z_ - w_ * p;
    }
    started_ = true;
    t_ = y.t, B_ = B, tau_ = y.tau;
    return {d_};
  }

 private:
  KdlArm<N> arm_;
  double w_, t_ = 0;
  bool started_ = false;
  Mat<N> B_;
  Vec<N> tau_, z_, d_;
};

/// KDL's ChainExternalWrenchEstimator, of which it takes the torques. It knows no friction: that is
/// taken off the torque that it gets.
template <int N>
class KdlWrenchEstimator {
 public:
  static constexpr const char* kName = "kdl_wrench";
  static constexpr int kDof = N;

  /// @param K [rad/s] bandwidth of every joint
  /// @param h [s] between samples, which has to be the same always
  KdlWrenchEstimator(const KdlArm<N>& arm, double K, double h)
      : arm_(arm), K_(K), h_(h), to_joints_(arm.T().transpose().inverse()) {
    reset();
  }

  void reset() noexcept {
    solver_ = std::make_unique<KDL::ChainExternalWrenchEstimator>(arm_.chain(), arm_.acceleration(),
                                                                  1 / h_, K_, 0);
    started_ = false;
  }
  Estimate<N> update(const Measurement<N>& y) noexcept {
    q_.data = arm_.rho(y.q), qd_.data = arm_.T() * y.qd;
    Estimate<N> estimate;
    if (started_) {
      KDL::Wrench wrench;
      solver_->JntToExtWrench(q_, qd_, tau_, wrench);
      solver_->getEstimatedJntTorque(out_);
      estimate.tau_ext = -arm_.T().transpose() * out_.data;
    } else {
      solver_->setInitialMomentum(q_, qd_);
    }
    started_ = true;
    tau_.data = to_joints_ * (y.tau - arm_.friction(y.qd));
    return estimate;
  }

 private:
  KdlArm<N> arm_;
  double K_, h_;
  Mat<N> to_joints_;  // of torques
  std::unique_ptr<KDL::ChainExternalWrenchEstimator> solver_;
  bool started_ = false;
  KDL::JntArray q_ = KDL::JntArray(N), qd_ = q_, tau_ = q_, out_ = q_;
};

}  // namespace tauext::peers

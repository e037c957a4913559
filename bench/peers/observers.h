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

/// What both observers below take of a sample: p = B qd and n = tau + C^T qd - g - F, where C^T qd
/// is Bdot qd - C qd and Bdot a difference, since KDL has neither.
template <int N>
class KdlMomentum {
 public:
  explicit KdlMomentum(const KdlArm<N>& arm) : arm_(arm) {}  ///< of this arm

  void reset() noexcept { started_ = false; }  ///< the next sample starts anew
  /// Takes a sample; whether there was one before it, so that n and h are known.
  bool advance(const Measurement<N>& y) noexcept {
    const bool known = started_;
    const Mat<N> B = arm_.inertia(y.q);
    p_ = B * y.qd;
    if (known) {
      h_ = y.t - t_;
      const Vec<N> transposed = (B - B_) / h_ * y.qd - arm_.coriolis(y.q, y.qd);
      n_ = tau_ + transposed - arm_.gravity(y.q) - arm_.friction(y.qd);
    }
    started_ = true;
    t_ = y.t, B_ = B, tau_ = y.tau;
    return known;
  }

  const Vec<N>& p() const noexcept { return p_; }  ///< [kg m^2/s]
  const Vec<N>& n() const noexcept { return n_; }  ///< [N m] from the last sample to this one
  double h() const noexcept { return h_; }         ///< [s] likewise

 private:
  KdlArm<N> arm_;
  double t_ = 0, h_ = 0;
  bool started_ = false;
  Mat<N> B_;
  Vec<N> tau_, p_, n_;
};

/// The momentum observer of momentum_observer.h's sources, r = K (p - p(0) - integral of (n + r)),
/// tau_ext = -r.
template <int N>
class KdlMomentumObserver {
 public:
  static constexpr const char* kName = "kdl_momentum";
  static constexpr int kDof = N;

  /// @param K [rad/s] bandwidth of every joint
  KdlMomentumObserver(const KdlArm<N>& arm, double K) : momentum_(arm), K_(K) {}

  void reset() noexcept { momentum_.reset(); }
  Estimate<N> update(const Measurement<N>& y) noexcept {
    if (momentum_.advance(y)) {
      integral_ += momentum_.h() * (momentum_.n() + r_);
      r_ = K_ * (momentum_.p() - integral_);
    } else {
      integral_ = momentum_.p();
      r_.setZero();
    }
    return {-r_};
  }

 private:
  KdlMomentum<N> momentum_;
  double K_;
  Vec<N> integral_, r_;  // the first momentum included
};

/// The NDOB of the paper, (17) to (19), with the gain X = w B: L = w, so that with z = tau_ext + w
/// p the two terms of Bdot cancel, zdot = w (n - tau_ext).
template <int N>
class KdlNdob {
 public:
  static constexpr const char* kName = "kdl_ndob";
  static constexpr int kDof = N;

  /// @param w [rad/s] bandwidth of every joint
  KdlNdob(const KdlArm<N>& arm, double w) : momentum_(arm), w_(w) {}

  void reset() noexcept { momentum_.reset(); }
  Estimate<N> update(const Measurement<N>& y) noexcept {
    if (momentum_.advance(y)) {
      z_ += momentum_.h() * w_ * (momentum_.n() - d_);
      d_ = z_ - w_ * momentum_.p();
    } else {
      z_ = w_ * momentum_.p();
      d_.setZero();
    }
    return {d_};
  }

 private:
  KdlMomentum<N> momentum_;
  double w_;
  Vec<N> z_, d_;
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

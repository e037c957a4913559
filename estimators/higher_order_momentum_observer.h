// SPDX-License-Identifier: Apache-2.0
/// @file
/// Momentum observers of second and third order: Ruggiero, Cacace, Sadeghian and Lippiello,
/// "Passivity-based control of VTOL UAVs with a momentum-based estimator of external wrench and
/// unmodeled dynamics", Robotics and Autonomous Systems 2015, where every joint's estimate is an
/// all-pole low-pass of tau_ext with unit gain. The gains here are Butterworth's, from one
/// bandwidth w (-3 dB at w):
///     mo2:                    d'' / w^2 + sqrt2 d' / w + d = u
///     mo3:  d''' / w^3 + 2 d'' / w^2   +   2 d' / w   + d = u,   u = n - pdot                (i)
/// with p and n of momentum.h. Noise beyond w falls with w^-2 (w^-3), a ramp is followed slope
/// sqrt2 / w (slope 2 / w) behind; a step overshoots by 4 % (8 %).
///
/// Discretised exactly for u constant over [t_k-1, t_k), where it is n - (p_k - p_k-1) / h, so
/// stable for every w h. With x = (d, d'/w, d''/w^2) and a = w h, A the companion matrix of (i),
/// and g the impulse response of (i) in normalised time,
///     x_k = u e_1 + Phi (x_k-1 - u e_1),   Phi = exp(A a)                                  (ii)
///     mo2: Phi = g'(a) I + g(a) (A + sqrt2 I)
///     mo3: Phi = g''(a) I + g'(a) (A + 2 I) + g(a) (A^2 + 2 A + 2 I)                       (iii)
#pragma once

#include <cmath>
#include <tuple>

#include "estimators/momentum.h"
#include "estimators/sampling.h"

namespace tauext {

/// Momentum observer of the given order over a robot model M.
template <RobotModel M, int Order>
requires(Order == 2 || Order == 3) class HigherOrderMomentumObserver {
 public:
  static constexpr const char* kName = Order == 2 ? "mo2" : "mo3";
  static constexpr int kDof = M::kDof;
  using Scalar = ScalarOf<M>;  ///< double, or a Pack for several runs at once
  using Model = M;             ///< of the arm
  template <class Other>
  using For = HigherOrderMomentumObserver<Other, Order>;  ///< the same over another model

  struct Parameters {
    Scalar bandwidth = 30;  ///< [rad/s] -3 dB, positive: larger is faster and noisier
    TorqueSampling torque = TorqueSampling::kHeld;  ///< when tau acted
    double max_gap = 0.05;                          ///< [s] a longer gap restarts the observer

    static constexpr auto fields() {
      return std::tuple(bandwidth_field<Parameters>(), torque_field<Parameters>(),
                        max_gap_field<Parameters>());
    }

    /// Bandwidth w [rad/s] on every joint, in every pose.
    static Parameters for_bandwidth(const M&, double w) { return {.bandwidth = w}; }
  };

  /// @throws std::invalid_argument for parameters out of range
  explicit HigherOrderMomentumObserver(const M& model, const Parameters& p = {})
      : p_(check_parameters(p, kName)),
        sampling_(p.max_gap, limits_of(model), p.torque),
        momentum_(model) {}

  void reset() noexcept {
    sampling_.reset();
    new_step_ = {};
    x_.setZero();
  }

  Estimate<kDof, Scalar> update(const Measurement<kDof, Scalar>& y) noexcept {
    Status status = sampling_.accept(y);
    if (!used(status)) return {x_.col(0), status, sampling_.joints()};
    const MomentumStep<kDof, Scalar> step = momentum_.advance(y, sampling_.torque(y));
    if (status == Status::kStarted) {
      x_.template rightCols<Order - 1>().setZero();
      return {x_.col(0), status, sampling_.joints()};
    }
    const Scalar h = sampling_.h();
    if (new_step_(h)) Phi_ = transition(p_.bandwidth * new_step_.h());
    const Vec<kDof, Scalar> u = step.n - step.dp / h;
    x_.col(0) -= u;
    x_ = (x_ * Phi_.transpose()).eval();  // (ii), a joint a row
    x_.col(0) += u;
    if (!within(x_, kEstimateLimit)) {
      x_.setZero();
      status = Status::kDiverged;
    }
    return {x_.col(0), status, sampling_.joints()};
  }

  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed
  /// What a run is at: all that changes from sample to sample. See runs/runs.h.
  auto memory() noexcept {
    return std::tuple_cat(std::tie(sampling_, new_step_, Phi_, x_), momentum_.memory());
  }

 private:
  // (iii)
  static Mat<Order, Scalar> transition(const Scalar& a) noexcept {
    using std::cos, std::exp, std::sin;
    const Mat<Order, Scalar> I = Mat<Order, Scalar>::Identity();
    Mat<Order, Scalar> A;
    if constexpr (Order == 2) {
      constexpr double kRoot2 = 1.4142135623730951;
      A << 0, 1, -1, -kRoot2;
      const Scalar e = exp(-a / kRoot2), c = cos(a / kRoot2), s = sin(a / kRoot2);
      return e * (c - s) * I + kRoot2 * e * s * (A + kRoot2 * I);
    } else {
      // partial fractions of 1 / ((s + 1) (s^2 + s + 1)), whose roots are -1 and -1/2 +- i root
      constexpr double kRoot = 0.8660254037844386;
      A << 0, 1, 0, 0, 0, 1, -1, -2, -2;
      const Scalar e1 = exp(-a), e2 = exp(-a / 2);
      const Scalar c = e2 * cos(kRoot * a), s = e2 * sin(kRoot * a) / (2 * kRoot);
      return (e1 - 2 * s) * I + (c + s - e1) * (A + 2 * I) + (e1 - c + s) * (A * A + 2 * A + 2 * I);
    }
  }

  Parameters p_;
  Sampling<kDof, Scalar> sampling_;
  Momentum<M> momentum_;
  StepChange<Scalar> new_step_;
  Mat<Order, Scalar> Phi_ = Mat<Order, Scalar>::Identity();
  Eigen::Matrix<Scalar, kDof, Order> x_ = x_.Zero();  // [N m] d, d'/w, d''/w^2; row: joint
};

/// mo2
template <RobotModel M>
using MomentumObserver2 = HigherOrderMomentumObserver<M, 2>;
/// mo3
template <RobotModel M>
using MomentumObserver3 = HigherOrderMomentumObserver<M, 3>;

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// What can be set in the EKF of ekf.h: the covariances of the paper (32) and (38), and ours.
#pragma once

#include <array>
#include <cstdint>
#include <tuple>

#include "estimators/concepts.h"
#include "estimators/samples/gate.h"
#include "estimators/sampling.h"

namespace tauext {

/// Which torque drives the step from k-1 to k.
enum class Alignment : std::uint8_t {
  kHeld,   ///< tau_k-1, which acted over that step: (10)
  kPaper,  ///< tau_k, as (13) prints it: an error of h dtau/dt
};

constexpr auto choices(Alignment) {
  return std::array{Choice<Alignment>{"held", Alignment::kHeld},
                    Choice<Alignment>{"paper", Alignment::kPaper}};
}

/// All covariances are diagonals: [rad^2], [(rad/s)^2], [(N m)^2]. A larger Q_d or a smaller R is
/// faster and noisier. P0, Q and R have no default that fits every arm.
template <int N, class Scalar = double>
struct EkfParameters {
  Vec<3 * N, Scalar> P0 = Vec<3 * N, Scalar>::Zero();  ///< of the state at the start, at least 0
  Vec<3 * N, Scalar> Q = Vec<3 * N, Scalar>::Zero();   ///< of the process, per step, at least 0
  Vec<2 * N, Scalar> R = Vec<2 * N, Scalar>::Zero();   ///< of the measured q and qd, positive
  /// [(rad/s^2)^2] per step: adds Q_load B B^T to Q_d in each pose, and ten times that to P0. So
  /// every joint of any arm is as fast, and no P0 and Q have to be found for it.
  Scalar Q_load = 0;
  /// [s] 0: Q is added once per step and R belongs to every sample, whatever the step, as printed.
  /// Otherwise both are meant for steps of Ts, and a step of h takes Q h / Ts and R Ts / h, white
  /// noise of constant density, so that the answer does not depend on the sampling time.
  double Ts = 0;
  Integration integration = Integration::kSecondOrder;  ///< (i), or (10) alone
  Alignment alignment = Alignment::kHeld;               ///< which tau belongs to a step
  Start start = Start::kFirstMeasurement;               ///< what the first sample does to the state
  /// [1] standard deviations by which q may jump; the printed R knows no noise, so with it there is
  /// no gate
  Scalar gate = 1e12;
  TorqueSampling torque = TorqueSampling::kHeld;  ///< when tau acted
  double max_gap = 0.05;                          ///< [s] a longer gap restarts the filter

  static constexpr auto fields() {
    using P = EkfParameters;
    return std::tuple(
        Field{"P0", &P::P0, "SI^2", 0, 1e20, "3N variances of q, qd, tau_ext at the start"},
        Field{"Q", &P::Q, "SI^2", 0, 1e20, "3N likewise, per step; larger is faster"},
        Field{"R", &P::R, "SI^2", 1e-30, 1e12, "2N of measured q and qd; larger is slower"},
        Field{"Q_load", &P::Q_load, "(rad/s^2)^2", 0, 1e20, "Q of B^-1 tau_ext; larger is faster"},
        Field{"Ts", &P::Ts, "s", 0, 1, "the step that Q and R are meant for; 0: any"},
        integration_field<P>(),
        Field{"alignment", &P::alignment, "", 0, 0, "paper errs by a sample of tau"},
        start_field<P>(), gate_field<P>(), torque_field<P>(), max_gap_field<P>());
  }

  /// (32) for the three joints of wallmobot3, (38) for the one of testbed1.
  static EkfParameters paper() requires(N == 3 || N == 1) {
    EkfParameters p;
    if constexpr (N == 1) {
      p.P0 << 1e-20, 1e-20, 1e-2;
      p.Q << 1e-14, 1e-14, 1e-2;
      p.R << 1e-20, 1e-17;
      return p;
    } else {
      p.P0 << 1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-2, 1e-2, 1e-2;
      p.Q << 1e-3, 1e-3, 1e-3, 1e-6, 1e-6, 1e-6, 4, 2.5, 4;
      p.R << 8e-10, 1e-12, 1e-12, 3e-11, 1e-12, 1e-12;
      return p;
    }
  }

  /// Noise that sensors have (velocity 1e-3 rad/s, angle 1e-5 rad) and next to none in the model,
  /// per 1 ms; with (32) R is negligible, and what is left is an NDOB. Q_d is for wallmobot3.
  static EkfParameters honest() requires(N == 3) { return honest(Vec<N>::Constant(0.02)); }

  /// honest() with bandwidth w [rad/s] of every joint in every pose, however B couples them: the
  /// load's share of the velocity's spectrum, Q_load / w^2, is as large as the rest, so for each
  /// kind of noise alone the filter is Butterworth's with -3 dB at w: w^4 = Q_load / R_v for R_v.
  template <DifferentiableModel M>
  static EkfParameters for_bandwidth(const M&, double w) {
    const EkfParameters p = honest(Vec<N>::Zero());
    const double r_q = p.R[0] * p.Ts, r_v = p.R[N] * p.Ts;  // [rad^2 s], [(rad/s)^2 s]
    const double q_q = p.Q[0] / p.Ts, q_v = p.Q[N] / p.Ts;  // [rad^2/s], [(rad/s)^2/s]
    const double measured = 1 / (1 / r_v + 1 / (w * w * r_q + q_q));
    const double q_d = w * w * (w * w * measured + q_v);  // [(rad/s^2)^2/s]
    EkfParameters out = p;
    out.Q_load = q_d * p.Ts;
    return out;
  }

 private:
  static EkfParameters honest(const Vec<N>& Q_d) {
    constexpr double kR_q = 1e-10, kR_v = 1e-6, kQ_q = 1e-14, kQ_v = 1e-10;
    const Vec<N> ones = Vec<N>::Ones();
    EkfParameters p;
    p.P0 << kR_q * ones, kR_v * ones, 10 * Q_d;
    p.Q << kQ_q * ones, kQ_v * ones, Q_d;
    p.R << kR_q * ones, kR_v * ones;
    p.Ts = 1e-3;
    p.gate = 100;
    return p;
  }
};

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Sliding-mode momentum observer: Garofalo, Mansfeld, Jankowski and Ott, "Sliding mode momentum
/// observers for estimation of external torques and joint acceleration", ICRA 2019. It is
/// super-twisting with linear terms; with the p and n of momentum.h, d = tau_ext with the sign of
/// (3), e = p_hat - p,
///     p_hat' = n - d - T2 e - T1 sqrt|e| sgn e,   d' = S2 e + S1 sgn e                      (i)
/// joint by joint. A tau_ext that changes by less than S1 per second is reached in finite time and
/// then followed exactly; the linear part alone (T1 = S1 = 0) is a second-order momentum observer.
///
/// An explicit step of (i) chatters: d jumps by +-2 h S1 for ever. So the end of the step is taken
/// on the right, sgn(0) being any number in [-1, 1] (Brogliato, Polyakov and Efimov, "The implicit
/// discretization of the supertwisting sliding-mode control algorithm", IEEE Transactions on
/// Automatic Control 2020):
///     b = e_k-1 - (p_k - p_k-1) + h (n - d_k-1)                    e_k for d and e held
///     (1 + h T2 + h^2 S2) |e_k| + h T1 sqrt|e_k| + h^2 S1 = |b|,   sgn e_k = sgn b         (ii)
/// For |b| <= h^2 S1 that is e_k = 0 with b / (h^2 S1) for its sign, else a quadratic in sqrt|e_k|.
#pragma once

#include <cmath>
#include <tuple>

#include "estimators/momentum.h"
#include "estimators/sampling.h"

namespace tauext {

/// Super-twisting momentum observer over a robot model M.
template <RobotModel M>
class SlidingModeObserver {
 public:
  static constexpr const char* kName = "smo";
  static constexpr int kDof = M::kDof;

  /// S1, S2 have no default that fits every arm. In all of them larger is faster and noisier.
  struct Parameters {
    Vec<kDof> S1 =
        Vec<kDof>::Zero();  ///< [N m/s] at least 0: rate of tau_ext that is followed exactly;
                            ///< noise moves d by up to h S1 a step
    Vec<kDof> S2 = Vec<kDof>::Zero();  ///< [1/s^2] positive: of the linear part, w^2
    Vec<kDof> T1 = Vec<kDof>::Zero();  ///< [sqrt(N m / s)] at least 0, about sqrt(2 S1): damps S1
    Vec<kDof> T2 = Vec<kDof>::Zero();  ///< [1/s] at least 0: damps S2
    TorqueSampling torque = TorqueSampling::kHeld;  ///< when tau acted
    double max_gap = 0.05;                          ///< [s] a longer gap restarts the observer

    static constexpr auto fields() {
      using P = Parameters;
      return std::tuple(
          Field{"S1", &P::S1, "N m/s", 0, 1e15, "rate of tau_ext that is followed exactly"},
          Field{"S2", &P::S2, "1/s^2", 1e-12, 1e15,
                "of the linear part; larger is faster, noisier"},
          Field{"T1", &P::T1, "sqrt(N m/s)", 0, 1e12, "damps S1"},
          Field{"T2", &P::T2, "1/s", 0, 1e12, "damps S2"}, torque_field<P>(), max_gap_field<P>());
    }

    /// The linear part is mo2 of bandwidth w [rad/s]: T2 = sqrt2 w, S2 = w^2. The sliding terms are
    /// as large as the linear ones where the velocity is wrong by 1e-4 rad/s, a tenth of a usual
    /// sensor's noise, e_0 = 1e-4 diag(B(0)): smaller errors than that are the sliding mode's.
    static Parameters for_bandwidth(const M& model, double w) {
      const Vec<kDof> e_0 = 1e-4 * Mat<kDof>(model.inertia(Vec<kDof>::Zero())).diagonal();
      Parameters p;
      p.T2.setConstant(kRoot2 * w);
      p.S2.setConstant(w * w);
      p.T1 = kRoot2 * w * e_0.cwiseSqrt();
      p.S1 = w * w * e_0;
      return p;
    }
  };

  /// @throws std::invalid_argument for parameters out of range
  explicit SlidingModeObserver(const M& model, const Parameters& p)
      : p_(check_parameters(p, kName)),
        sampling_(p.max_gap, limits_of(model), p.torque),
        momentum_(model) {}

  void reset() noexcept {
    sampling_.reset();
    d_.setZero();
  }

  Estimate<kDof> update(const Measurement<kDof>& y) noexcept {
    Status status = sampling_.accept(y);
    if (!used(status)) return {d_, status, sampling_.joints()};
    const MomentumStep<kDof> step = momentum_.advance(y, sampling_.torque(y));
    if (status == Status::kStarted) {
      e_.setZero();
      return {d_, status, sampling_.joints()};
    }
    const double h = sampling_.h();
    const Vec<kDof> b = e_ - step.dp + h * (step.n - d_);
#pragma GCC unroll 8
    for (int i = 0; i < kDof; ++i) advance(i, h, b[i]);
    if (!(e_.allFinite() && within(d_, kEstimateLimit))) {
      e_.setZero();
      d_.setZero();
      status = Status::kDiverged;
    }
    return {d_, status, sampling_.joints()};
  }

 private:
  static constexpr double kRoot2 = 1.4142135623730951;

  // (ii) for joint i
  [[gnu::always_inline]] void advance(int i, double h, double b) noexcept {
    const double slide = h * h * p_.S1[i];
    const double beyond = std::abs(b) - slide;
    double e = 0, sgn = slide > 0 ? b / slide : 0;
    if (beyond > 0) {
      const double linear = 1 + h * (p_.T2[i] + h * p_.S2[i]), half = 0.5 * h * p_.T1[i];
      const double root = beyond / (half + std::sqrt(half * half + linear * beyond));
      sgn = std::copysign(1, b);
      e = sgn * root * root;
    }
    e_[i] = e;
    d_[i] += h * (p_.S1[i] * sgn + p_.S2[i] * e);
  }

  Parameters p_;
  Sampling<kDof> sampling_;
  Momentum<M> momentum_;
  Vec<kDof> e_ = Vec<kDof>::Zero();  // [N m s] p_hat - p
  Vec<kDof> d_ = Vec<kDof>::Zero();  // [N m] the last estimate
};

}  // namespace tauext

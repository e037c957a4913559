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
  using Scalar = ScalarOf<M>;  ///< double, or a Pack for several runs at once
  using Model = M;             ///< of the arm
  template <class Other>
  using For = SlidingModeObserver<Other>;  ///< the same over another model

  /// S1, S2 have no default that fits every arm. In all of them larger is faster and noisier.
  struct Parameters {
    Vec<kDof, Scalar> S1 =
        Vec<kDof,
            Scalar>::Zero();  ///< [N m/s] at least 0: rate of tau_ext that is followed exactly;
                              ///< noise moves d by up to h S1 a step
    Vec<kDof, Scalar> S2 =
        Vec<kDof, Scalar>::Zero();  ///< [1/s^2] positive: of the linear part, w^2
    Vec<kDof, Scalar> T1 =
        Vec<kDof, Scalar>::Zero();  ///< [sqrt(N m / s)] at least 0, about sqrt(2 S1): damps S1
    Vec<kDof, Scalar> T2 = Vec<kDof, Scalar>::Zero();  ///< [1/s] at least 0: damps S2
    TorqueSampling torque = TorqueSampling::kHeld;     ///< when tau acted
    double max_gap = 0.05;                             ///< [s] a longer gap restarts the observer

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
      const Vec<kDof, Scalar> e_0 =
          1e-4 * Mat<kDof, Scalar>(model.inertia(Vec<kDof, Scalar>::Zero())).diagonal();
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

  Estimate<kDof, Scalar> update(const Measurement<kDof, Scalar>& y) noexcept {
    Status status = sampling_.accept(y);
    if (!used(status)) return {d_, status, sampling_.joints()};
    const MomentumStep<kDof, Scalar> step = momentum_.advance(y, sampling_.torque(y));
    if (status == Status::kStarted) {
      e_.setZero();
      return {d_, status, sampling_.joints()};
    }
    const Scalar h = sampling_.h();
    const Vec<kDof, Scalar> b = e_ - step.dp + h * (step.n - d_);
#pragma GCC unroll 8
    for (int i = 0; i < kDof; ++i) advance(i, h, b[i]);
    if (!(finite(e_) && within(d_, kEstimateLimit))) {
      e_.setZero();
      d_.setZero();
      status = Status::kDiverged;
    }
    return {d_, status, sampling_.joints()};
  }

  const Parameters& parameters() const noexcept {
    return p_;
  }  ///< as constructed
  /// What a run is at: all that changes from sample to sample. See runs/runs.h.
  auto memory() noexcept {
    return std::tuple_cat(std::tie(sampling_, e_, d_), momentum_.memory());
  }

 private:
  static constexpr double kRoot2 = 1.4142135623730951;

  // (ii) for joint i
  [[gnu::always_inline]] void advance(int i, const Scalar& h, const Scalar& b) noexcept {
    using std::abs, std::copysign, std::sqrt;
    const Scalar slide = h * h * p_.S1[i];
    const Scalar beyond = abs(b) - slide;
    Scalar e = 0, sgn = select(slide > Scalar(0), Scalar(b / slide), Scalar(0));
    const auto is_beyond = beyond > Scalar(0);
    if (any(is_beyond)) {
      const Scalar linear = 1 + h * (p_.T2[i] + h * p_.S2[i]), half = 0.5 * h * p_.T1[i];
      const Scalar root = beyond / (half + sqrt(half * half + linear * beyond));
      sgn = select(is_beyond, Scalar(copysign(Scalar(1), b)), sgn);
      e = select(is_beyond, Scalar(sgn * root * root), Scalar(0));
    }
    e_[i] = e;
    d_[i] += h * (p_.S1[i] * sgn + p_.S2[i] * e);
  }

  Parameters p_;
  Sampling<kDof, Scalar> sampling_;
  Momentum<M> momentum_;
  Vec<kDof, Scalar> e_ = Vec<kDof, Scalar>::Zero();  // [N m s] p_hat - p
  Vec<kDof, Scalar> d_ = Vec<kDof, Scalar>::Zero();  // [N m] the last estimate
};

}  // namespace tauext

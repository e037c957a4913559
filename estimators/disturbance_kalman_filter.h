// SPDX-License-Identifier: Apache-2.0
/// @file
/// Disturbance Kalman filter on the momentum: Hu and Xiong, "Contact force estimation for robot
/// manipulator using semiparametric model and disturbance Kalman filter", IEEE Transactions on
/// Industrial Electronics 2018. With the p and n of momentum.h and d = tau_ext with the sign of
/// (3),
///     pdot = n - d + white noise of density Q_p,   ddot = white noise of density Q_d           (i)
/// measured as B qd, where qd carries white noise of density Q_qd.
///
/// Exact over a step h (Van Loan): with x = [p; d], P in blocks,
///     p += h (n - d)
///     P_pp += h^2 P_dd - h (P_dp + P_dp^T) + h Q_p + h^3/3 Q_d                             (ii)
///     P_dp -= h P_dd + h^2/2 Q_d,   P_dd += h Q_d
///     R = B Q_qd B^T / h
/// R / h and h Q keep the densities, so the answer does not depend on the sampling time. Then
///     S = P_pp + R,   [p; d] += [P_pp; P_dp] S^-1 (B qd - p),   P -= [P_pp; P_dp] S^-1 [P_pp P_dp^T]   (iii)
/// with S factorised and never inverted. Of the symmetric blocks one triangle is computed and
/// mirrored.
///
/// With window > 0 it adapts, as a strong tracking filter: Zhou and Frank, "Strong tracking
/// filtering of nonlinear time-varying stochastic systems with coloured noise", International
/// Journal of Control 1996 (after others' code). In (ii) Phi P Phi^T, what is there without the
/// densities, is multiplied by
///     f = max(1, tr N / tr M),   M = (Phi P Phi^T)_pp,
///     N = V - weakening R / h - h Q_p - h^3/3 Q_d                                       (iv)
/// with V the mean of nu nu^T, nu = B qd - p before (iii), over the window, and each joint's entry
/// divided by that of R, so that joints of all sizes count: where the innovations are larger than
/// they should be, the filter forgets what it knew, and follows. The weakening keeps it from doing
/// so where V only varies by chance.
///
/// In steady state, with Q_p = 0 and Q_d = w^4 R h, this is mo2 of bandwidth w. R moves with the
/// pose, by orders of magnitude where a straight arm is nearly singular, so a Q_d that is constant
/// suits one pose; what is tuned for a bandwidth takes Q_d from each pose's R.
#pragma once

#include <algorithm>
#include <cmath>
#include <tuple>

#include "estimators/math/ldlt.h"
#include "estimators/momentum.h"
#include "estimators/samples/gate.h"
#include "estimators/sampling.h"

namespace tauext {

/// Disturbance Kalman filter over a robot model M; `kAdapts` gives what is made for a bandwidth a
/// window of 50 ms, and another name.
template <RobotModel M, bool kAdapts = false>
class DisturbanceKalmanFilter {
 public:
  static constexpr const char* kName = kAdapts ? "dkf_adaptive" : "dkf";
  static constexpr int kDof = M::kDof;
  using Scalar = ScalarOf<M>;  ///< double, or a Pack for several runs at once
  using Model = M;             ///< of the arm
  template <class Other>
  using For = DisturbanceKalmanFilter<Other, kAdapts>;  ///< the same over another model

  /// Neither w nor Q_d has a default that fits every arm.
  struct Parameters {
    Scalar w =
        0;  ///< [rad/s] positive: Q_d = w^4 B Q_qd B^T in every pose, P0 what follows from it
    Mat<kDof, Scalar> Q_d =
        Mat<kDof, Scalar>::Zero();  ///< [(N m)^2/s] density of ddot, symmetric, positive definite:
                                    ///< larger is faster and noisier
    Vec<kDof, Scalar> Q_p =
        Vec<kDof,
            Scalar>::Zero();  ///< [(N m)^2 s] density of the model's error, at least 0: larger
                              ///< is slower, as it explains what else would be d
    Vec<kDof, Scalar> Q_qd =
        Vec<kDof, Scalar>::Constant(1e-9);  ///< [(rad/s)^2 s] density of the noise of qd, positive,
                                            ///< larger is slower; 1e-3 rad/s at 1 ms
    Vec<kDof, Scalar> P0_qd =
        Vec<kDof, Scalar>::Constant(1e-8);  ///< [(rad/s)^2] variance of the first qd, at least 0
    Mat<kDof, Scalar> P0_d =
        Mat<kDof, Scalar>::Zero();  ///< [(N m)^2] of the first d, symmetric, at least 0
    /// [1] standard deviations by which the momentum may jump; a blow makes hundreds
    Scalar gate = 1000;
    Scalar weakening = 2;  ///< [1] of (iv), at least 1: larger adapts to larger loads alone
    double window = 0;     ///< [s] of (iv): shorter takes chance for a load sooner; 0: never adapts
    TorqueSampling torque = TorqueSampling::kHeld;  ///< when tau acted
    double max_gap = 0.05;                          ///< [s] a longer gap restarts the filter

    /// w comes from for_bandwidth, and then Q_d and P0_d are not read; the three cannot be set by
    /// name.
    static constexpr auto fields() {
      using P = Parameters;
      return std::tuple(
          Field{"Q_p", &P::Q_p, "(N m)^2 s", 0, 1e20, "the model's error; larger is slower"},
          Field{"Q_qd", &P::Q_qd, "(rad/s)^2 s", 1e-30, 1e6, "the noise of qd; larger is slower"},
          Field{"P0_qd", &P::P0_qd, "(rad/s)^2", 0, 1e12, "variance of the first qd"},
          Field{"weakening", &P::weakening, "1", 1, 1e6, "larger adapts to larger loads alone"},
          Field{"window", &P::window, "s", 0, 1e3, "over which it adapts; 0: not at all"},
          gate_field<P>(), torque_field<P>(), max_gap_field<P>());
    }

    /// What fields() leaves out.
    static constexpr auto unnamed() {
      return std::tuple(&Parameters::w, &Parameters::Q_d, &Parameters::P0_d);
    }

    /// In every pose every joint is Butterworth's of -3 dB at w [rad/s], however B couples them. P0
    /// is what the filter settles to.
    static Parameters for_bandwidth(const M&, double w) {
      Parameters p;
      p.w = w;
      p.P0_qd = kRoot2 * w * p.Q_qd;
      if (kAdapts) p.window = 0.05;
      return p;
    }
  };

  /// @throws std::invalid_argument for parameters out of range
  explicit DisturbanceKalmanFilter(const M& model, const Parameters& p)
      : p_(check_parameters(p, kName)),
        sampling_(p.max_gap, limits_of(model), p.torque),
        momentum_(model),
        Q_d_(p.Q_d) {
    require(all(p.w >= Scalar(0)), "w [rad/s] of dkf must not be negative");
    require(all(p.w > Scalar(0)) || Ldlt<kDof, Scalar>(p.Q_d).ok(),
            "Q_d of dkf must be positive definite");
    for (int i = 0; i < kDof; ++i)
      require(all(p.P0_d(i, i) >= Scalar(0)), "P0_d of dkf must not be negative");
    mirror(Q_d_);
    mirror(p_.P0_d);
  }

  void reset() noexcept {
    sampling_.reset();
    d_.setZero();
  }

  Estimate<kDof, Scalar> update(const Measurement<kDof, Scalar>& y) noexcept {
    Status status = sampling_.accept(y);
    if (!used(status)) return {d_, status, sampling_.joints()};
    const MomentumStep<kDof, Scalar> step = momentum_.advance(y, sampling_.torque(y));
    if (status == Status::kStarted) {
      start(step);
      return {d_, status, sampling_.joints()};
    }
    const Mat<kDof, Scalar> R =
        step.B * p_.Q_qd.asDiagonal() * step.B.transpose();  // (ii), times h
    if (all(p_.w > Scalar(0))) {
      Q_d_ = p_.w * p_.w * p_.w * p_.w * R;
      mirror(Q_d_);
    }
    if (p_.window > 0) [[unlikely]]
      fade(sampling_.h(), step, R);
    predict(sampling_.h(), step.n);
    const Mat<kDof, Scalar> S = P_pp_ + R / sampling_.h();
    status = sampling_.confirm(beyond<kDof, Scalar>(p_.gate, step.p - p_hat_, nu_, S.diagonal()));
    if (status == Status::kOk && !correct(S, step)) {
      sampling_.reset();
      return {d_, Status::kSingularInertia};
    }
    if (!(finite(p_hat_) && within(d_, kEstimateLimit))) {
      d_.setZero();
      start(step);
      status = Status::kDiverged;
    }
    return {d_, status, sampling_.joints()};
  }

  /// P [(N m s)^2 ... (N m)^2] of [p; d] after the last sample; symmetric.
  Mat<2 * kDof, Scalar> covariance() const noexcept {
    Mat<2 * kDof, Scalar> P;
    P << P_pp_, P_dp_.transpose(), P_dp_, P_dd_;
    return P;
  }

  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed
  /// What a run is at: all that changes from sample to sample. See runs/runs.h.
  auto memory() noexcept {
    return std::tuple_cat(std::tie(sampling_, Q_d_, p_hat_, nu_, d_, V_, P_pp_, P_dp_, P_dd_),
                          momentum_.memory());
  }

 private:
  static constexpr double kRoot2 = 1.4142135623730951;

  void start(const MomentumStep<kDof, Scalar>& step) noexcept {
    p_hat_ = step.p;
    nu_.setZero();
    V_.setZero();
    P_pp_.noalias() = step.B * p_.P0_qd.asDiagonal() * step.B.transpose();
    mirror(P_pp_);
    P_dp_.setZero();
    P_dd_ = p_.P0_d;
    if (all(p_.w > Scalar(0))) {
      P_dd_ = kRoot2 * p_.w * p_.w * p_.w * step.B * p_.Q_qd.asDiagonal() * step.B.transpose();
      mirror(P_dd_);
    }
  }

  // (ii)
  [[gnu::always_inline]] void predict(const Scalar& h, const Vec<kDof, Scalar>& n) noexcept {
    p_hat_ += h * (n - d_);
    P_pp_ += h * (h * P_dd_ - (P_dp_ + P_dp_.transpose()) + h * h / 3 * Q_d_);
    P_pp_.diagonal() += h * p_.Q_p;
    P_dp_ -= h * P_dd_ + 0.5 * h * h * Q_d_;
    P_dd_ += h * Q_d_;
  }

  // (iv), before (ii): Phi (f P) Phi^T is f times Phi P Phi^T. R times h
  [[gnu::noinline]] void fade(const Scalar& h, const MomentumStep<kDof, Scalar>& step,
                              const Mat<kDof, Scalar>& R_h) noexcept {
    using std::exp, std::max;
    const Vec<kDof, Scalar> nu = step.p - p_hat_ - h * (step.n - d_), R = R_h.diagonal() / h;
    const Vec<kDof, Scalar> known =
        P_pp_.diagonal() + h * (h * P_dd_.diagonal() - Scalar(2) * P_dp_.diagonal());
    const Scalar stays = exp(Scalar(-h / p_.window));
    V_ = stays * V_ + (Scalar(1) - stays) * nu.cwiseAbs2();
    const Vec<kDof, Scalar> unexplained =
        V_ - p_.weakening * R - h * (p_.Q_p + h * h / 3 * Q_d_.diagonal());
    const Scalar f =
        max(Scalar(1), Scalar(unexplained.cwiseQuotient(R).sum() / known.cwiseQuotient(R).sum()));
    P_pp_ *= f;
    P_dp_ *= f;
    P_dd_ *= f;
  }

  // (iii); false if S is not positive definite
  [[gnu::always_inline]] bool correct(const Mat<kDof, Scalar>& variance,
                                      const MomentumStep<kDof, Scalar>& step) noexcept {
    const Ldlt<kDof, Scalar> S(variance);
    if (!S.ok()) return false;
    nu_ = step.p - p_hat_;
    const Vec<kDof, Scalar> innovation = S.solve(nu_);
    const Mat<kDof, Scalar> G_p = S.solve(P_pp_),
                            G_d = S.solve(Mat<kDof, Scalar>(P_dp_.transpose()));
    p_hat_ += P_pp_ * innovation;
    d_ += P_dp_ * innovation;
    P_pp_ -= P_pp_ * G_p;
    P_dd_ -= P_dp_ * G_d;
    P_dp_ -= P_dp_ * G_p;
    mirror(P_pp_);
    mirror(P_dd_);
    return true;
  }

  // the lower triangle into the upper one
  [[gnu::always_inline]] static void mirror(Mat<kDof, Scalar>& m) noexcept {
#pragma GCC unroll 8
    for (int j = 1; j < kDof; ++j) {
#pragma GCC unroll 8
      for (int i = 0; i < j; ++i) m(i, j) = m(j, i);
    }
  }

  Parameters p_;
  Sampling<kDof, Scalar> sampling_;
  Momentum<M> momentum_;
  Mat<kDof, Scalar> Q_d_;                                // of this pose, if w is given
  Vec<kDof, Scalar> p_hat_ = Vec<kDof, Scalar>::Zero();  // [N m s]
  Vec<kDof, Scalar> nu_ = Vec<kDof, Scalar>::Zero();  // [N m s] innovation of the last correction
  Vec<kDof, Scalar> d_ = Vec<kDof, Scalar>::Zero();   // [N m] the last estimate
  Vec<kDof, Scalar> V_ = d_;                          // [(N m s)^2] diagonal of V
  // blocks of P
  Mat<kDof, Scalar> P_pp_ = Mat<kDof, Scalar>::Zero(), P_dp_ = P_pp_, P_dd_ = P_pp_;
};

/// The one that adapts.
template <RobotModel M>
using AdaptiveKalmanFilter = DisturbanceKalmanFilter<M, true>;

}  // namespace tauext

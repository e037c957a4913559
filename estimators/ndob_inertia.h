// SPDX-License-Identifier: Apache-2.0
/// @file
/// Nonlinear disturbance observer with the gain X = w B(q): Mohammadi, Tavakoli, Marquez and
/// Hashemzadeh, "Nonlinear disturbance observer design for robotic manipulators", Control
/// Engineering Practice 2013, whose gain matrix it is with their free matrix a multiple of the
/// unit.
///
///     d = z - w B qd                                                                   (17)
///     zdot = w (tau + C^T qd - g - F - d),   because Bdot = C + C^T                        (18)
/// where n = tau + C^T qd - g - F and p = B qd are those of momentum.h: no B^-1, and every joint
/// follows tau_ext as a low-pass of w, whatever the pose. So it is the first-order momentum
/// observer, but for how it is stepped. As in ndob.h everything but tau_k-1 is the mean of both
/// ends, d_k too:
///     (1 + h w / 2) (z_k - z_k-1) = h w (n - d_k-1 + w (p_k - p_k-1) / 2)                  (i)
#pragma once

#include <tuple>

#include "estimators/momentum.h"
#include "estimators/sampling.h"

namespace tauext {

/// NDOB with X = w B(q) over a robot model M.
template <RobotModel M>
class NdobInertia {
 public:
  static constexpr const char* kName = "ndob_wb";
  static constexpr int kDof = M::kDof;
  using Scalar = ScalarOf<M>;  ///< double, or a Pack for several runs at once
  using Model = M;             ///< of the arm
  template <class Other>
  using For = NdobInertia<Other>;  ///< the same over another model

  struct Parameters {
    Scalar bandwidth = 30;  ///< [rad/s] w, positive: larger is faster and noisier
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
  explicit NdobInertia(const M& model, const Parameters& p = {})
      : p_(check_parameters(p, kName)),
        sampling_(p.max_gap, limits_of(model), p.torque),
        momentum_(model) {}

  void reset() noexcept {
    sampling_.reset();
    tau_ext_.setZero();
  }

  Estimate<kDof, Scalar> update(const Measurement<kDof, Scalar>& y) noexcept {
    Status status = sampling_.accept(y);
    if (!used(status)) return {tau_ext_, status, sampling_.joints()};
    const MomentumStep<kDof, Scalar> step = momentum_.advance(y, sampling_.torque(y));
    const Scalar w = p_.bandwidth;
    if (status == Status::kStarted) {
      z_ = tau_ext_ + w * step.p;
    } else {
      const Scalar hw = sampling_.h() * w;
      z_ += hw / (1 + 0.5 * hw) * (step.n - tau_ext_ + 0.5 * w * step.dp);  // (i)
      tau_ext_ = z_ - w * step.p;                                           // (17)
      if (!within(tau_ext_, kEstimateLimit)) {
        tau_ext_.setZero();
        z_ = w * step.p;
        status = Status::kDiverged;
      }
    }
    return {tau_ext_, status, sampling_.joints()};
  }

  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed
  /// What a run is at: all that changes from sample to sample. See runs/runs.h.
  auto memory() noexcept {
    return std::tuple_cat(std::tie(sampling_, z_, tau_ext_), momentum_.memory());
  }

 private:
  Parameters p_;
  Sampling<kDof, Scalar> sampling_;
  Momentum<M> momentum_;
  Vec<kDof, Scalar> z_ = Vec<kDof, Scalar>::Zero();        // [N m]
  Vec<kDof, Scalar> tau_ext_ = Vec<kDof, Scalar>::Zero();  // [N m] the last estimate
};

}  // namespace tauext

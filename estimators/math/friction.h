// SPDX-License-Identifier: Apache-2.0
/// @file
/// Dry friction of one joint, as an estimator models it.
///
///     F(qd) = level tanh(qd / v_s),   or level sign(qd) for v_s = 0
/// At standstill the sign of a velocity that is all round-off and noise flips from sample to
/// sample, and a sign() throws that into the estimate: +-2 level of chatter. The tanh passes
/// through zero smoothly. What no function of qd can know is the friction of an arm that sticks: it
/// lies anywhere within +-level, and an estimate at rest is only that good (the stiction bound).
///
/// An explicit step of h sees dF/dqd = level / v_s at rest, so it asks for
///     v_s >= h level / (2 B).
#pragma once

#include <cmath>

namespace tauext {

/// Coulomb friction F(qd) with the sign of the velocity; see above.
struct CoulombFriction {
  double level = 0;  ///< [N m] at full slip, at least 0
  double v_s = 0;    ///< [rad/s] where 76 % of it are reached; larger: smoother, later; 0: sign()

  /// F [N m] at qd [rad/s].
  double torque(double qd) const noexcept {
    if (v_s > 0) return level * std::tanh(qd / v_s);
    return qd > 0 ? level : qd < 0 ? -level : 0;
  }

  /// dF/dqd [N m s/rad], given torque(qd); 0 for sign().
  double slope(double torque) const noexcept {
    return v_s > 0 && level > 0 ? (level - torque * torque / level) / v_s : 0;
  }
};

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// testbed1: the one-joint testbed of section 6, as identified in (36)-(37),
///     tau = theta_1 qdd + theta_2 g cos q + theta_3 g sin q + theta_4 sign(qd),      (36)
/// q = 0 with the arm level, positive upwards. sign() is smoothed by default (friction.h).
///
/// No rigid body of sensible mass has the printed values: the first moment of 11.69 kg m with an
/// inertia of 0.419 kg m^2 takes 326 kg at least. If g already is inside theta_2 and theta_3, 3.4
/// kg do. The equation is what counts, so it is taken as printed; Parameters::absorbed() is the
/// other reading.
#pragma once

#include "estimators/concepts.h"
#include "estimators/math/friction.h"
#include "estimators/math/sin_cos.h"
#include "estimators/sampling.h"

namespace tauext {

/// Dynamics of the testbed.
class Testbed1 {
 public:
  static constexpr int kDof = 1;

  /// (37). The letters theta are those of (36).
  struct Parameters {
    double theta1 = 0.41937;  ///< [kg m^2] inertia
    double theta2 = 11.668;   ///< [kg m] first moment along the arm
    double theta3 = -0.74;    ///< [kg m] first moment across it, downwards
    double theta4 = 2.163;    ///< [N m] dry friction
    double g = kGravity;      ///< [m/s^2] the g of (36)
    /// [rad/s] of friction.h; 0 is the printed sign(). At least Ts theta_4 / (2 theta_1) = 0.0026
    /// for
    /// Ts = 1 ms; ours is the slip at which the MJCF's friction is full, too
    double v_s = 0.005;

    /// theta_2 and theta_3 in N m, g inside them.
    static Parameters absorbed() {
      Parameters p;
      p.g = 1;
      return p;
    }
    /// The printed sign(qd).
    static Parameters raw_sign() {
      Parameters p;
      p.v_s = 0;
      return p;
    }
  };

  /// @throws std::invalid_argument for parameters out of range
  explicit Testbed1(const Parameters& p) : p_(p), friction_{p.theta4, p.v_s} {
    require(p.theta1 > 0, "theta_1 [kg m^2] of testbed1 must be positive");
    require(p.theta4 >= 0 && p.v_s >= 0, "theta_4 and v_s of testbed1 must not be negative");
  }

  Testbed1() : Testbed1(Parameters()) {}

  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed

  /// B = theta_1 [kg m^2].
  Mat<1> inertia(const Vec<1>&) const noexcept { return Mat<1>(p_.theta1); }

  /// g(q) = theta_2 g cos q + theta_3 g sin q [N m].
  Vec<1> gravity(const Vec<1>& q) const noexcept {
    Vec<1> s, c;
    sin_cos(q, s, c);
    return p_.g * (p_.theta2 * c + p_.theta3 * s);
  }

  /// C qd + g = g [N m].
  Vec<1> bias(const Vec<1>& q, const Vec<1>&) const noexcept { return gravity(q); }

  /// C^T qd - g = -g [N m].
  Vec<1> momentum_bias(const Vec<1>& q, const Vec<1>&) const noexcept { return -gravity(q); }

  /// F(qd) = theta_4 sign(qd), smoothed [N m].
  Vec<1> friction(const Vec<1>& qd) const noexcept { return Vec<1>(friction_.torque(qd[0])); }

  /// qdd = (u - F - g) / theta_1 for u = tau - tau_ext [N m], with its Jacobians.
  ForwardDynamics<1> forward_dynamics(const Vec<1>& q, const Vec<1>& qd,
                                      const Vec<1>& u) const noexcept {
    Vec<1> s, c;
    sin_cos(q, s, c);
    const Vec<1> F = friction(qd);
    const double b = 1 / p_.theta1;
    ForwardDynamics<1> f;
    f.qdd = b * (u - F - p_.g * (p_.theta2 * c + p_.theta3 * s));
    f.dqdd_dq = b * p_.g * (p_.theta2 * s - p_.theta3 * c);
    f.dqdd_dqd = Mat<1>(-b * friction_.slope(F[0]));
    f.dqdd_dtau_ext = Mat<1>(-b);
    f.ok = true;
    return f;
  }

 private:
  Parameters p_;
  CoulombFriction friction_;
};

static_assert(DifferentiableModel<Testbed1>);

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// wallmobot3: the planar arm q = (q2, q3, q4) of Tables I and II, in closed form.
///
/// In the plane (x forward, z up) a positive rotation about +y takes x to -z. Frame a has
///     x_a = (cos phi_a, -sin phi_a),   y_a = (-sin phi_a, -cos phi_a),
/// and with Table I the absolute angles are
///     phi_2 = q2 - pi/2,   phi_4 = q3,   phi_5 = q3 + q4 + pi/2.
/// Frame 3 only translates (the parallelogram), so m_3 counts as a point at the tip of link 2.
///
/// In w = (phi_2, phi_4, phi_5) every inertia term couples two angles or none (d = phi_a - phi_b):
///     M_ab(d) = A_ab cos d + S_ab sin d,     M_ab' = dM_ab/dd,   M_ab'' = -M_ab           (i)
///     row a: M_ab wdd_b + M_ab' (-wd_b^2),   row b: M_ab wdd_a + M_ab' wd_a^2             (ii)
/// which is M wdd + C wd with Mdot - 2 C skew. Then q enters by w = A q + const:
///     B = A^T M A,   C qd = A^T (C wd),   A = [1 0 0; 0 1 0; 0 1 1].                      (iii)
#pragma once

#include <cmath>
#include <stdexcept>

#include "estimators/concepts.h"
#include "estimators/math/block.h"
#include "estimators/math/ldlt.h"
#include "estimators/math/sin_cos.h"

namespace tauext {

/// Tables I and II. I_zz is about the origin of its frame, the joint (about the centre of mass
/// the printed values would exceed what a rod of that mass and length can have).
struct WallMoBot3Parameters {
  double a2 = 0.5;                         ///< [m] link 2, joint to joint
  double a4 = 0.85;                        ///< [m] link 4, joint to joint
  double m2 = 3.31, Izz2 = 0.309;          ///< [kg], [kg m^2]
  double com2_x = 0.260, com2_y = 0;       ///< [m] in frame 2
  double m3 = 10.42;                       ///< [kg]; where its COM lies drops out
  double m4 = 6.21, Izz4 = 1.624;          ///< [kg], [kg m^2]
  double com4_x = 0.440, com4_y = -0.008;  ///< [m] in frame 4
  double m5 = 177, Izz5 = 69.79;           ///< [kg], [kg m^2] last link with the 150 kg panel
  double com5_x = 0.089, com5_y = -0.317;  ///< [m] in frame 5
  Vec<3> viscous = Vec<3>::Zero();         ///< [N m s/rad] of (3)'s F; the paper gives none
  Vec<3> coulomb = Vec<3>::Zero();         ///< [N m] likewise, coulomb tanh(qd / v_s): friction.h
  double v_s = 0.01;                       ///< [rad/s]

  /// The arm with another panel [kg]: m5 changes and Izz5 with it, in proportion.
  static WallMoBot3Parameters with_panel(double panel) {
    WallMoBot3Parameters p;
    const double m5 = p.m5 - 150 + panel;
    p.Izz5 *= m5 / p.m5;
    p.m5 = m5;
    return p;
  }
};

/// Dynamics of wallmobot3. Scalar is double in use; the tests put in complex and long numbers.
/// kDry: with dry friction, which costs every step some 5 % even where it is 0.
template <class Scalar = double, bool kDry = false>
class BasicWallMoBot3 {
 public:
  static constexpr int kDof = 3;
  using Number = Scalar;        ///< of what its numbers are
  using Vec3 = Vec<3, Scalar>;  ///< of q2, q3, q4
  using Mat3 = Mat<3, Scalar>;  ///< of q2, q3, q4

  using Parameters = WallMoBot3Parameters;

  /// The arm with these masses and lengths.
  /// @throws std::invalid_argument for dry friction without kDry
  explicit BasicWallMoBot3(const Parameters& p = {}) : p_(p) {
    if (!kDry && !p.coulomb.isZero(0))
      throw std::invalid_argument("coulomb of wallmobot3: that is DryWallMoBot3");
    const double h4x = p.m4 * p.com4_x + p.m5 * p.a4;  // first moment carried by link 4
    const double h4y = p.m4 * p.com4_y;
    const double h5x = p.m5 * p.com5_x, h5y = p.m5 * p.com5_y;
    const double m2_tip = p.m3 + p.m4 + p.m5;
    M22_ = p.Izz2 + m2_tip * p.a2 * p.a2;
    M44_ = p.Izz4 + p.m5 * p.a4 * p.a4;
    M55_ = p.Izz5;
    A24_ = p.a2 * h4x, S24_ = p.a2 * h4y;
    A25_ = p.a2 * h5x, S25_ = p.a2 * h5y;
    A45_ = p.a4 * h5x, S45_ = p.a4 * h5y;
    gx_ << p.m2 * p.com2_x + m2_tip * p.a2, h4x, h5x;
    gy_ << p.m2 * p.com2_y, h4y, h5y;
  }

  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed
  /// The same arm, computed with S.
  template <class S>
  BasicWallMoBot3<S, kDry> with() const {
    return BasicWallMoBot3<S, kDry>(p_);
  }

  // inertia and momentum_bias are inlined so that a momentum observer takes the sines once for both

  /// B(q) [kg m^2].
  [[gnu::always_inline]] Mat3 inertia(const Vec3& q) const noexcept {
    return to_joints(coupling(q));
  }

  /// g(q) [N m].
  Vec3 gravity(const Vec3& q) const noexcept { return to_joints(gravity(coupling(q))); }

  /// C(q, qd) [N m s/rad], the Christoffel form: Bdot - 2 C is skew.
  Mat3 coriolis(const Vec3& q, const Vec3& qd) const noexcept {
    const Coupling c = coupling(q);
    const Vec3 wd = to_links(qd);
    Mat3 C = Mat3::Zero();
    C(0, 1) = -c.d24 * wd[1], C(1, 0) = c.d24 * wd[0];
    C(0, 2) = -c.d25 * wd[2], C(2, 0) = c.d25 * wd[0];
    C(1, 2) = -c.d45 * wd[2], C(2, 1) = c.d45 * wd[1];
    C.col(1) += C.col(2);  // (iii)
    C.row(1) += C.row(2);
    return C;
  }

  /// C qd + g [N m].
  Vec3 bias(const Vec3& q, const Vec3& qd) const noexcept {
    const Coupling c = coupling(q);
    return to_joints(Vec3(coriolis_force(c, to_links(qd)) + gravity(c)));
  }

  /// C^T qd - g [N m].
  [[gnu::always_inline]] Vec3 momentum_bias(const Vec3& q, const Vec3& qd) const noexcept {
    const Coupling c = coupling(q);
    const Vec3 wd = to_links(qd);
    const Scalar p24 = c.d24 * wd[0] * wd[1];
    const Scalar p25 = c.d25 * wd[0] * wd[2];
    const Scalar p45 = c.d45 * wd[1] * wd[2];
    return to_joints(Vec3(Vec3(p24 + p25, p45 - p24, -p25 - p45) - gravity(c)));
  }

  /// F(qd) [N m].
  Vec3 friction(const Vec3& qd) const noexcept {
    Vec3 F = p_.viscous.template cast<Scalar>().cwiseProduct(qd);
    if constexpr (kDry) F += p_.coulomb.template cast<Scalar>().cwiseProduct(slip(qd));
    return F;
  }

  /// inertia and bias, sharing the sines.
  [[gnu::always_inline]] Dynamics<3, Scalar> dynamics(const Vec3& q,
                                                      const Vec3& qd) const noexcept {
    const Coupling c = coupling(q);
    return {to_joints(c), to_joints(Vec3(coriolis_force(c, to_links(qd)) + gravity(c)))};
  }

  /// qdd = B^-1 (u - C qd - F - g) for u = tau - tau_ext [N m], with its Jacobians:
  ///     B dqdd/dq = -d(B qdd + C qd + g)/dq at fixed qdd,   B dqdd/dqd = -d(C qd + F)/dqd.
  ForwardDynamics<3, Scalar> forward_dynamics(const Vec3& q, const Vec3& qd,
                                              const Vec3& u) const noexcept {
    const auto m = motion(q, qd, u);
    const Mat3 per_torque = m.minus_inverse.matrix();
    return {m.qdd.template to<3>(), per_torque * m.by_q.matrix(), per_torque * m.by_qd.matrix(),
            per_torque, m.ok};
  }

  /// The same in lanes, with inertia(q) where B is asked for.
  [[gnu::always_inline]] detail::LinearMotion<3, Scalar> motion(
      const Vec3& q, const Vec3& qd, const Vec3& u,
      detail::Block<3, Scalar>* inertia = nullptr) const noexcept {
    const Coupling c = coupling(q);
    const Vec3 wd = to_links(qd);
    const Mat3 B = to_joints(c);
    if (inertia) *inertia = detail::Block<3, Scalar>::from(B);
    const Ldlt<3, Scalar> factor(B);
    const Vec3 qdd =
        factor.solve(Vec3(u - friction(qd) - to_joints(Vec3(coriolis_force(c, wd) + gravity(c)))));
    // (ii) by the angles: d/dphi_a = -d/dphi_b, row a: M' wdd_b + M wd_b^2, row b: M' wdd_a - M
    // wd_a^2
    const Vec3 wdd = to_links(qdd);
    const Scalar r24 = c.d24 * wdd[1] + c.f24 * wd[1] * wd[1];
    const Scalar r42 = c.d24 * wdd[0] - c.f24 * wd[0] * wd[0];
    const Scalar r25 = c.d25 * wdd[2] + c.f25 * wd[2] * wd[2];
    const Scalar r52 = c.d25 * wdd[0] - c.f25 * wd[0] * wd[0];
    const Scalar r45 = c.d45 * wdd[2] + c.f45 * wd[2] * wd[2];
    const Scalar r54 = c.d45 * wdd[1] - c.f45 * wd[1] * wd[1];
    const Vec3 dg = Scalar(kGravity) * (gx_.cwiseProduct(c.sin) + gy_.cwiseProduct(c.cos));
    const Scalar v24 = 2 * c.d24 * wd[1], v42 = 2 * c.d24 * wd[0];
    const Scalar v25 = 2 * c.d25 * wd[2], v52 = 2 * c.d25 * wd[0];
    const Scalar v45 = 2 * c.d45 * wd[2], v54 = 2 * c.d45 * wd[1];
    Vec3 slope = p_.viscous.template cast<Scalar>();
    if constexpr (kDry) {
      const Vec3 s = slip(qd);
      slope += (p_.coulomb / p_.v_s)
                   .template cast<Scalar>()
                   .cwiseProduct(Vec3::Ones() - s.cwiseProduct(s));
    }
    auto by_qd = block_of_joints(0, -v24, -v25, v42, 0, -v45, v52, v54, 0);
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j) by_qd.column[j].set(j, by_qd(j, j) + slope[j]);
    return {detail::Column<3, Scalar>::template from<3>(qdd),
            block_of_joints(r24 + r25 + dg[0], -r24, -r25, r42, r45 - r42 + dg[1], -r45, r52, r54,
                            dg[2] - r52 - r54),
            by_qd, factor.minus_inverse(), factor.ok()};
  }

  /// Geometric Jacobian [m; m; rad] of the panel's attachment point: (vx, vz, pitch rate) by qd.
  /// tau_ext = -J^T (fx, fz, m) for a force and a pitch moment that act on the arm there.
  Mat3 jacobian(const Vec3& q) const noexcept {
    const Coupling c = coupling(q);
    constexpr double kX = 0.93, kY = -(0.109 + 0.2025);  // [m] a_5, d_6 + delta_x in frame 5
    const Vec3 x(p_.a2, p_.a4, kX), y(0, 0, kY);
    Mat3 J;
    J.row(0) = -(x.cwiseProduct(c.sin) + y.cwiseProduct(c.cos)).transpose();
    J.row(1) = -(x.cwiseProduct(c.cos) - y.cwiseProduct(c.sin)).transpose();
    J.row(2) << 0, 0, 1;
    J.col(1) += J.col(2);
    return J;
  }

 private:
  // the share of dry friction that acts
  Vec3 slip(const Vec3& qd) const noexcept {
    using std::tanh;
    return qd.unaryExpr([v_s = p_.v_s](const Scalar& v) { return Scalar(tanh(v / v_s)); });
  }

  // sines of phi_2, phi_4, phi_5; f = M_ab and d = M_ab' of (i)
  struct Coupling {
    Vec3 sin, cos;
    Scalar f24, d24, f25, d25, f45, d45;
  };

  // inlined wherever it is used: a call would send every field through memory
  [[gnu::always_inline]] Coupling coupling(const Vec3& q) const noexcept {
    Vec3 s, k;
    sin_cos(to_links(q), s, k);
    Coupling c;
    c.sin = Vec3(-k[0], s[1], k[2]);  // the offsets of phi_2 and phi_5 are quarter turns
    c.cos = Vec3(s[0], k[1], -s[2]);
    const auto pair = [&](int a, int b, double A, double S, Scalar& f, Scalar& d)
        __attribute__((always_inline)) {
      const Scalar cd = c.cos[a] * c.cos[b] + c.sin[a] * c.sin[b];
      const Scalar sd = c.sin[a] * c.cos[b] - c.cos[a] * c.sin[b];
      f = A * cd + S * sd;
      d = S * cd - A * sd;
    };
    pair(0, 1, A24_, S24_, c.f24, c.d24);
    pair(0, 2, A25_, S25_, c.f25, c.d25);
    pair(1, 2, A45_, S45_, c.f45, c.d45);
    return c;
  }

  [[gnu::always_inline]] Vec3 gravity(const Coupling& c) const noexcept {
    return Scalar(kGravity) * (gy_.cwiseProduct(c.sin) - gx_.cwiseProduct(c.cos));
  }

  [[gnu::always_inline]] static Vec3 coriolis_force(const Coupling& c,
                                                    const Vec3& wd) noexcept {  // (ii)
    const Vec3 s = wd.cwiseProduct(wd);
    return {-c.d24 * s[1] - c.d25 * s[2], c.d24 * s[0] - c.d45 * s[2], c.d25 * s[0] + c.d45 * s[1]};
  }

  // (iii), for a velocity, a force, a matrix and M itself
  static Vec3 to_links(const Vec3& qd) noexcept {
    return {qd[0], qd[1], qd[1] + qd[2]};
  }
  static Vec3 to_joints(const Vec3& n) noexcept {
    return {n[0], n[1] + n[2], n[2]};
  }
  [[gnu::always_inline]] static Mat3 to_joints(Mat3 m) noexcept {
    m.col(1) += m.col(2);
    m.row(1) += m.row(2);
    return m;
  }
  // of a matrix over the links, by rows; register by register: see lanes.h
  [[gnu::always_inline]] static detail::Block<3, Scalar> block_of_joints(
      const Scalar& aa, const Scalar& ab, const Scalar& ac, const Scalar& ba, const Scalar& bb,
      const Scalar& bc, const Scalar& ca, const Scalar& cb, const Scalar& cc) noexcept {
    using Column = detail::Column<3, Scalar>;
    detail::Block<3, Scalar> b;
    b.column[0] = Column::of(aa, ba + ca, ca);
    b.column[1] = Column::of(ab + ac, bb + bc + cb + cc, cb + cc);
    b.column[2] = Column::of(ac, bc + cc, cc);
    return b;
  }
  [[gnu::always_inline]] Mat3 to_joints(const Coupling& c) const noexcept {
    Mat3 B;
    B << M22_, c.f24 + c.f25, c.f25,                           //
        c.f24 + c.f25, M44_ + M55_ + 2 * c.f45, M55_ + c.f45,  //
        c.f25, M55_ + c.f45, M55_;
    return B;
  }

  Parameters p_;
  double M22_, M44_, M55_;                    // [kg m^2] diagonal of M
  double A24_, S24_, A25_, S25_, A45_, S45_;  // [kg m^2] of (i)
  Vec3 gx_, gy_;                              // [kg m] first moments along x_a, y_a
};

/// The closed form in double, as everybody but the derivatives uses it.
using WallMoBot3 = BasicWallMoBot3<double>;
/// The same with the dry friction of (3).
using DryWallMoBot3 = BasicWallMoBot3<double, true>;
static_assert(DifferentiableModel<WallMoBot3>);

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// The dynamics of any arm of hinges and slides, a chain or a tree, from plain numbers.
///
/// Everything is in the world's axes and about the origin of the base, so that sums over bodies
/// need no transformations. With i's subtree: i and all bodies behind it,
///     V_i = V_parent + S_i qd_i,   S'_i = V_i x S_i,   A_i = A_parent + S_i qdd_i + S'_i qd_i,
///     F_i = sum over the subtree of (I A + V x* I V),  C qd + g = S_i . F_i at qdd = 0,      (i)
/// with A of the base = -gravity. With I^c, H the inertia and momentum I V of the subtree,
///     B_ij = S_i . I^c_j S_j   (j behind i, or i),    B qd = S_i . H_i,
///     C^T qd = d/dq (qd^T B qd / 2) = S'_i . H_i.                                             (ii)
/// The last holds as the kinetic energy of a subtree that is moved as a whole does not change.
///
/// Derivatives are those of Singh, Russell and Wensing, Efficient Analytical Derivatives of
/// Rigid-Body Dynamics using Spatial Vector Algebra (RA-L 2022). In these axes their Coriolis
/// matrix of a subtree has 12 numbers instead of 36: x's relative acceleration at the point r is
/// 2 x_w x v(r), so
///     2 B^c x = 2 (tr(Y) x_w - Y x_w ; x_w x l),  Y = integral of v r^T dm,  l = that of v dm.  (iii)
/// With S''_j = A_parent x S_j + V_parent x S'_j, for j behind i, or i:
///     d tau_j/d q_i = 2 B^c_j S'_i . S_j + I^c_j S''_i . S_j
///     d tau_i/d q_j = S_i . (2 B^c_j S'_j + I^c_j S''_j + S_j x* F_j)
///     d tau_j/d qd_i = 2 (B^c_j S_i + I^c_j S'_i) . S_j
///     d tau_i/d qd_j = 2 S_i . (B^c_j S_j + I^c_j S'_j)                                       (iv)
#pragma once

#include <array>
#include <cstddef>
#include <stdexcept>

#include "estimators/concepts.h"
#include "estimators/math/ldlt.h"
#include "estimators/math/tanh.h"
#include "estimators/tree/tree_joint.h"
#include "estimators/tree/tree_passes.h"

namespace tauext {

/// An arm with N coordinates. Scalar is double in use; the tests put in complex and long numbers.
///
/// The coordinates q are those of its M joints, rho. Where the arm is driven otherwise (a
/// parallelogram), or where joints follow others (the second finger of a gripper), rho = drho q +
/// rho0. Such ties are rigid; what holds them does no work and is in no torque.
template <int N, class Scalar = double, int M = N>
class TreeModel {
  static_assert(M >= N, "every coordinate moves a joint");

 public:
  static constexpr int kDof = N;
  using Number = Scalar;                    ///< of what its numbers are
  static constexpr int kJoints = M;         ///< that the coordinates move
  using VecN = Vec<N, Scalar>;              ///< a number of each coordinate
  using MatN = Mat<N, Scalar>;              ///< over the coordinates
  using Square = detail::Block<N, Scalar>;  ///< the same in lanes

  using Parameters = TreeParameters<N, M>;  ///< what it is made of

  /// @throws std::invalid_argument for a joint that is none, naming its number and what is wrong
  explicit TreeModel(const Parameters& p)
      : p_(p),
        direct_(M == N && p.drho.isIdentity(0) && p.rho0.isZero(0)),
        passes_(p.joints, p.gravity),
        drho_(p.drho.template cast<Scalar>()) {
    if (!p.drho.allFinite() || !p.gravity.allFinite() || !p.rho0.allFinite())
      throw std::invalid_argument("a tree's numbers must be finite");
    if (!detail::has_full_rank(p.drho))
      throw std::invalid_argument("a tree's drho must have full rank");
    for (int i = 0; i < M; ++i) {
      const TreeJoint& j = p.joints[static_cast<std::size_t>(i)];
      viscous_[i] = Scalar(j.viscous), skew_[i] = Scalar(j.viscous_skew);
      dry_[i] = Scalar(j.dry), offset_[i] = Scalar(j.offset), per_slip_[i] = Scalar(1 / j.v_s);
    }
  }

  const Parameters& parameters() const noexcept { return p_; }  ///< as constructed
  /// The same arm, computed with S.
  template <class S>
  TreeModel<N, S, M> with() const {
    return TreeModel<N, S, M>(p_);
  }

  // none of them is inlined: each is hundreds of instructions, and stands in every estimator

  /// B(q) [kg m^2].
  [[gnu::noinline]] MatN inertia(const VecN& q) const noexcept {
    const auto s = passes_.pose(to_rho(q));
    return inertia(s, passes_.composite(s.I));
  }

  /// g(q) [N m].
  [[gnu::noinline]] VecN gravity(const VecN& q) const noexcept {
    const auto s = passes_.pose(to_rho(q));
    return forces(VecM(-passes_.weights(s, passes_.composite(s.I))));
  }

  /// C qd + g [N m].
  [[gnu::noinline]] VecN bias(const VecN& q, const VecN& qd) const noexcept {
    const auto s = passes_.pose(to_rho(q));
    return forces(bias(s, passes_.flow(s, to_rate(qd))));
  }

  /// C^T qd - g [N m].
  [[gnu::noinline]] VecN momentum_bias(const VecN& q, const VecN& qd) const noexcept {
    const auto s = passes_.pose(to_rho(q));
    return forces(momentum_bias(s, passes_.composite(s.I), to_rate(qd)));
  }

  /// inertia and bias, sharing the pose.
  [[gnu::noinline]] Dynamics<N, Scalar> dynamics(const VecN& q, const VecN& qd) const noexcept {
    const auto s = passes_.pose(to_rho(q));
    return {inertia(s, passes_.composite(s.I)), forces(bias(s, passes_.flow(s, to_rate(qd))))};
  }

  /// inertia and momentum_bias, sharing the pose.
  [[gnu::noinline]] Dynamics<N, Scalar> momentum_dynamics(const VecN& q,
                                                          const VecN& qd) const noexcept {
    const auto s = passes_.pose(to_rho(q));
    const auto c = passes_.composite(s.I);
    return {inertia(s, c), forces(momentum_bias(s, c, to_rate(qd)))};
  }

  /// F(qd) [N m].
  VecN friction(const VecN& qd) const noexcept {
    const VecM rate = to_rate(qd);
    VecM slope;
    return forces(VecM(viscous_.cwiseProduct(rate) + offset_ + dry_friction(rate, slope)));
  }

  /// What of it Coulomb's friction takes [N m]: steep where the speed changes its sign.
  VecN dry_friction(const VecN& qd) const noexcept {
    VecM slope;
    return forces(dry_friction(to_rate(qd), slope));
  }

  /// qdd = B^-1 (u - C qd - F - g) for u = tau - tau_ext [N m], with its Jacobians, by (iv).
  ForwardDynamics<N, Scalar> forward_dynamics(const VecN& q, const VecN& qd,
                                              const VecN& u) const noexcept {
    VecM slope;
    const VecN dry = forces(dry_friction(to_rate(qd), slope));
    const auto m = motion(q, qd, u - dry);
    const MatN per_torque = m.minus_inverse.matrix();
    return {m.qdd.template to<N>(), per_torque * m.by_q.matrix(),
            per_torque * (m.by_qd.matrix() + drho_.transpose() * slope.asDiagonal() * drho_),
            per_torque, m.ok};
  }

  /// The same in lanes, but without dry friction; and inertia(q), where B is asked for.
  [[gnu::noinline]] detail::LinearMotion<N, Scalar> motion(
      const VecN& q, const VecN& qd, const VecN& u, Square* inertia = nullptr) const noexcept {
    const VecM rate = to_rate(qd);
    const auto s = passes_.template pose<true>(to_rho(q));
    auto flow = passes_.template flow<true>(s, rate);
    const auto c = passes_.composite(s.I);
    const VecM rest = bias(s, flow) + viscous_.cwiseProduct(rate) + offset_;
    const auto IS = Passes::template momenta<true>(s, c);
    Bodies own_B = passes_.inertia(s, IS);
    const Square& B = to_q(own_B);
    if (inertia) *inertia = B;
    const Factor factor = factorised(B);
    detail::LinearMotion<N, Scalar> m;
    m.ok = factor.ok();
    const VecN qdd = factor.solve(VecN(u - forces(rest)));
    m.qdd = detail::Column<N, Scalar>::template from<N>(qdd);
    m.minus_inverse = factor.minus_inverse();
    passes_.template accelerate<true>(s, to_rate(qdd), flow);
    Bodies by_rho, by_rate;
    passes_.template derivatives<true>(s, flow, c, IS, by_rho, by_rate);
#pragma GCC unroll 8
    for (int i = 0; i < M; ++i) by_rate.column[i].set(i, by_rate(i, i) + viscous_[i]);
    m.by_q = to_q(by_rho);
    m.by_qd = to_q(by_rate);
    return m;
  }

  /// Where a point [m] in the frame of a joint's body is, in the axes of the base, whose origin is
  /// that of the first joint's parent.
  /// @param joint from 0
  Vec<3, Scalar> position(const VecN& q, int joint, const Vec<3>& point) const noexcept {
    return passes_.at_base(passes_.pose(to_rho(q)), joint, point);
  }

  /// Geometric Jacobian (m; rad) by q of a point [m] in the frame of a joint's body: its velocity
  /// in the first three rows, the angular velocity in the others, in the axes of the base. tau_ext
  /// = -J^T (f; n) for a force f [N] and a moment n [N m] that act on the arm there.
  /// @param joint from 0
  /// @param position as position() has it, if asked for
  Eigen::Matrix<Scalar, 6, N> jacobian(const VecN& q, int joint, const Vec<3>& point,
                                       Vec<3, Scalar>* position = nullptr) const noexcept {
    const auto s = passes_.pose(to_rho(q));
    const Vec<3, Scalar> at = passes_.at_base(s, joint, point);
    if (position != nullptr) *position = at;
    Eigen::Matrix<Scalar, 6, M> J;
    for (int i = 0; i < M; ++i) {
      const Vec<3, Scalar> w(s.S.w.x[i], s.S.w.y[i], s.S.w.z[i]);
      const Vec<3, Scalar> v(s.S.v.x[i], s.S.v.y[i], s.S.v.z[i]);
      J.col(i) << v + w.cross(at), w;
      J.col(i) *= passes_.sums().ahead(joint)[i];
    }
    if constexpr (M == N)
      if (direct_) return J;
    return J * drho_;
  }

 private:
  using Passes = detail::TreePasses<M, Scalar>;
  using VecM = Vec<M, Scalar>;  // a number of each joint
  using Pose = typename Passes::Pose;
  using Bodies = detail::Block<M, Scalar>;  // over the joints
  using Factor = Ldlt<N, Scalar>;

  [[gnu::always_inline]] MatN inertia(const Pose& s,
                                      const typename Passes::Inertia& c) const noexcept {
    Bodies B = passes_.inertia(s, Passes::momenta(s, c));
    return to_q(B).matrix();
  }

  [[gnu::always_inline]] VecM bias(const Pose& s, const typename Passes::Flow& f) const noexcept {
    return Passes::along(s.S, passes_.sums().subtree(f.F));
  }

  VecM momentum_bias(const Pose& s, const typename Passes::Inertia& c,
                     const VecM& rate) const noexcept {
    const auto f = passes_.flow(s, rate);
    return Passes::along(f.Sd, passes_.sums().subtree(f.H)) + passes_.weights(s, c);
  }

  // of the joints' rates, and how it grows with them
  [[gnu::always_inline]] VecM dry_friction(const VecM& rate, VecM& slope) const noexcept {
    using tauext::tanh;
    const VecM share = tanh(VecM(rate.cwiseProduct(per_slip_)));
    const VecM level = dry_ + skew_.cwiseProduct(rate);
    const VecM rest = VecM::Constant(Scalar(1)) - share.cwiseProduct(share);
    slope = skew_.cwiseProduct(share) + level.cwiseProduct(per_slip_).cwiseProduct(rest);
    return level.cwiseProduct(share);
  }

  VecM to_rho(const VecN& q) const noexcept {
    if constexpr (M == N) {
      if (direct_) return q;
    }
    return drho_.lazyProduct(q) + p_.rho0.template cast<Scalar>();
  }
  VecM to_rate(const VecN& qd) const noexcept {
    if constexpr (M == N) {
      if (direct_) return qd;
    }
    return drho_.lazyProduct(qd);
  }
  VecN forces(const VecM& of_rho) const noexcept {
    if constexpr (M == N) {
      if (direct_) return of_rho;
    }
    return drho_.transpose().lazyProduct(of_rho);
  }

  // what is over the joints, over the coordinates; in place where these are as many
  [[gnu::always_inline]] decltype(auto) to_q(Bodies& of_rho) const noexcept {
    if constexpr (M == N) {
      if (!direct_) of_rho = tied(of_rho);
      return (of_rho);
    } else {
      return tied(of_rho);
    }
  }

  // drho^T of_rho drho; few joints depend on a coordinate
  [[gnu::noinline]] Square tied(const Bodies& of_rho) const noexcept {
    Square out = Square::zero();
    for (int j = 0; j < N; ++j) {
      auto column = detail::Column<M, Scalar>::zero();
      for (int k = 0; k < M; ++k) {
        if (p_.drho(k, j) != 0) column = column + drho_(k, j) * of_rho.column[k];
      }
      for (int i = 0; i < N; ++i) {
        Scalar sum(0);
        for (int k = 0; k < M; ++k) {
          if (p_.drho(k, i) != 0) sum += drho_(k, i) * column[k];
        }
        out.column[j].set(i, sum);
      }
    }
    return out;
  }

  [[gnu::always_inline]] static Factor factorised(const Square& B) noexcept {
    if constexpr (Factor::kLanes) {
      return Factor(B);
    } else {
      return Factor(B.matrix());
    }
  }

  Parameters p_;
  bool direct_;  // q is rho
  Passes passes_;
  Eigen::Matrix<Scalar, M, N> drho_;
  VecM viscous_, skew_, dry_, offset_;  // friction of each joint, as TreeJoint has it
  VecM per_slip_;                       // 1 / v_s
};

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// From tau_ext to the force at a point of the arm: the measured quantity of the paper's title.
///
/// A force f [N] on the arm at a point with the Jacobian J gives tau_ext = -J^T f; with a moment n
/// [N m], too, J has six rows and f stands for (f; n / l), l a length that makes both forces. The
/// joints see the directions u_i of J = sum s_i u_i v_i^T by the levers s_i, whose squares are the
/// eigenvalues of J J^T. Damped least squares,
///     f = -sum g_i u_i u_i^T J tau_ext,    g_i = 1 / max(s_i^2, e^2),   e = least_lever s_1,     (i)
/// is exact where every lever is longer than e, and lets a force fade to 0 where it gets shorter
/// (Maciejewski and Klein 1988), instead of the error of the estimate growing by 1 / s_i. Its
/// answer to a true force is R f with
///     R = sum g_i s_i^2 u_i u_i^T,                                                          (ii)
/// the diagonal of which says how much of each component can be seen at all: in a plane arm, 0 of
/// the force across the plane.
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <stdexcept>

#include "estimators/tree/tree_model.h"

namespace tauext {

/// So many joints a moment at a point wants, and the line of a force.
inline constexpr int kJointsOfMoment = 6;

/// A point that moves with a joint's body.
struct ArmPoint {
  int joint = 0;                  ///< whose body, from 0; -1: it never moves
  Vec<3> place = Vec<3>::Zero();  ///< [m] in the body's frame (TreeJoint)
};

/// What acts on the arm at a point, in the axes of the base.
struct SiteForce {
  Vec<3> force = Vec<3>::Zero();   ///< [N]
  Vec<3> moment = Vec<3>::Zero();  ///< [N m] about the point; 0 where it is not looked for
  /// [1] of force and moment: how much of the component is seen, by (ii); 1 all, 0 nothing
  Vec<6> seen = Vec<6>::Zero();
  double condition = 0;  ///< [1] longest over shortest lever of those above e; 0: there is none
  double left_over = 0;  ///< [N m] root of the sum of squares of tau_ext that this does not explain
};

/// How a force is looked for.
struct SiteForceParameters {
  bool moment = false;        ///< a moment, too: wants 6 joints; else a touch without one
  double length = 0.3;        ///< [m] a moment of this times 1 N is as large as 1 N
  double least_lever = 0.02;  ///< [1] of the longest lever: shorter ones are damped
};

namespace detail {

// (i) and what it says of itself, for the force alone, Rows = 3, or with the moment, 6
template <int Rows>
struct LeverSolution {
  Vec<Rows> f = Vec<Rows>::Zero();
  Vec<Rows> seen = Vec<Rows>::Zero();
  double condition = 0;
};

// given J J^T and J tau_ext: compiled once for all numbers of joints
template <int Rows>
LeverSolution<Rows> solve_by_lever(const Mat<Rows>& JJt, const Vec<Rows>& J_tau_ext,
                                   double least_lever) noexcept {
  const Eigen::SelfAdjointEigenSolver<Mat<Rows>> by_lever(JJt);
  const Mat<Rows>& u = by_lever.eigenvectors();
  const Vec<Rows> squares = by_lever.eigenvalues().cwiseMax(0);  // growing
  const double least = least_lever * least_lever * squares[Rows - 1];
  LeverSolution<Rows> out;
  if (!(least > 0)) return out;
  const Vec<Rows> damped = squares.cwiseMax(least);
  out.f = -u * (u.transpose() * J_tau_ext).cwiseQuotient(damped);
  out.seen = u.cwiseAbs2() * squares.cwiseQuotient(damped);
  double shortest = squares[Rows - 1];
  for (int i = Rows - 1; i >= 0 && squares[i] >= least; --i) shortest = squares[i];
  out.condition = std::sqrt(squares[Rows - 1] / shortest);
  return out;
}

template <int Rows, int N, int M>
SiteForce force_at(const TreeModel<N, double, M>& arm, const ArmPoint& at,
                   const SiteForceParameters& p, const Vec<N>& q, const Vec<N>& tau_ext) noexcept {
  Eigen::Matrix<double, Rows, N> J = arm.jacobian(q, at.joint, at.place).template topRows<Rows>();
  if constexpr (Rows == 6) J.template bottomRows<3>() *= p.length;
  const auto found = solve_by_lever<Rows>(J * J.transpose(), J * tau_ext, p.least_lever);
  SiteForce out;
  out.seen.template head<Rows>() = found.seen;
  out.condition = found.condition;
  out.left_over = (tau_ext + J.transpose() * found.f).norm();
  out.force = found.f.template head<3>();
  if constexpr (Rows == 6) out.moment = p.length * found.f.template tail<3>();
  return out;
}

}  // namespace detail

/// The force at a point of an arm of N coordinates and M joints.
template <int N, int M = N>
class ForceAtSite {
 public:
  /// @throws std::invalid_argument for a point that does not move with a joint, for a moment with
  /// fewer than 6 joints, and for parameters out of range
  ForceAtSite(const TreeModel<N, double, M>& arm, const ArmPoint& at,
              const SiteForceParameters& p = {})
      : arm_(arm), at_(at), p_(p) {
    if (at.joint < 0 || at.joint >= M || !at.place.allFinite())
      throw std::invalid_argument("a force is looked for at a point that no joint moves");
    if (p.moment && N < kJointsOfMoment)
      throw std::invalid_argument("force and moment at a point want 6 joints or more");
    if (!(p.length > 0 && p.least_lever > 0 && p.least_lever < 1))
      throw std::invalid_argument("length must be positive, least_lever between 0 and 1");
  }

  /// Of the arm at q [rad] with tau_ext [N m, sign of (3)].
  SiteForce operator()(const Vec<N>& q, const Vec<N>& tau_ext) const noexcept {
    return p_.moment ? detail::force_at<6>(arm_, at_, p_, q, tau_ext)
                     : detail::force_at<3>(arm_, at_, p_, q, tau_ext);
  }

 private:
  TreeModel<N, double, M> arm_;
  ArmPoint at_;
  SiteForceParameters p_;
};

}  // namespace tauext

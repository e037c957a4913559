// SPDX-License-Identifier: Apache-2.0
/// @file
/// An arm's dynamics by Orocos KDL, as its users write them.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cstddef>
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/frames.hpp>
#include <kdl/jntarray.hpp>
#include <kdl/jntspaceinertiamatrix.hpp>
#include <memory>

#include "estimators/concepts.h"
#include "estimators/tree/tree_model.h"

namespace tauext::peers {

/// KDL's chain of these joints, of which each carries the next.
template <int N>
KDL::Chain chain_of(const typename TreeModel<N>::Parameters& p) {
  const auto vector = [](const Vec<3>& v) { return KDL::Vector(v[0], v[1], v[2]); };
  KDL::Chain chain;
  for (int i = 0; i < N; ++i) {
    const TreeJoint& j = p.joints[static_cast<std::size_t>(i)];
    const Mat<3>& R = j.rotation;
    const KDL::Rotation rotation(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0),
                                 R(2, 1), R(2, 2));
    const auto type =
        j.kind == TreeJoint::Kind::kHinge ? KDL::Joint::RotAxis : KDL::Joint::TransAxis;
    const KDL::Joint joint(vector(j.position), vector(R * j.axis.normalized()), type, 1, -j.zero,
                           j.armature);
    const Mat<3>& I = j.inertia;
    chain.addSegment(KDL::Segment(
        joint, KDL::Frame(rotation, vector(j.position)),
        KDL::RigidBodyInertia(
            j.mass, vector(j.center),
            KDL::RotationalInertia(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)))));
  }
  return chain;
}

/// The terms of (3) by KDL's ChainDynParam: B by composite bodies, C qd and g by two passes of
/// Newton and Euler. It has no C^T qd and no derivatives. Friction is the arm's own. Where the arm
/// is driven otherwise than joint by joint, rho = T q + rho0 are its joints.
template <int N>
class KdlArm {
 public:
  static constexpr int kDof = N;

  /// Of a chain.
  explicit KdlArm(const TreeModel<N>& arm)
      : arm_(arm),
        chain_(std::make_shared<KDL::Chain>(chain_of<N>(arm.parameters()))),
        gravity_(arm.parameters().gravity[0], arm.parameters().gravity[1],
                 arm.parameters().gravity[2]),
        solver_(std::make_shared<KDL::ChainDynParam>(*chain_, gravity_)),
        T_(arm.parameters().drho),
        rho0_(arm.parameters().rho0) {}

  const KDL::Chain& chain() const { return *chain_; }           ///< KDL's
  const KDL::Vector& acceleration() const { return gravity_; }  ///< [m/s^2] of gravity
  const Mat<N>& T() const { return T_; }                        ///< drho/dq
  Vec<N> rho(const Vec<N>& q) const { return T_ * q + rho0_; }  ///< [rad] of the joints

  Mat<N> inertia(const Vec<N>& q) const noexcept {  ///< B [kg m^2]
    q_.data = rho(q);
    solver_->JntToMass(q_, B_);
    return T_.transpose() * B_.data * T_;
  }
  Vec<N> gravity(const Vec<N>& q) const noexcept {  ///< g [N m]
    q_.data = rho(q);
    solver_->JntToGravity(q_, out_);
    return T_.transpose() * out_.data;
  }
  Vec<N> coriolis(const Vec<N>& q, const Vec<N>& qd) const noexcept {  ///< C qd [N m]
    q_.data = rho(q), qd_.data = T_ * qd;
    solver_->JntToCoriolis(q_, qd_, out_);
    return T_.transpose() * out_.data;
  }
  Vec<N> friction(const Vec<N>& qd) const noexcept { return arm_.friction(qd); }  ///< F [N m]

  /// qdd = B^-1 (u - C qd - F - g), with its Jacobians by differences.
  ForwardDynamics<N> forward_dynamics(const Vec<N>& q, const Vec<N>& qd,
                                      const Vec<N>& u) const noexcept {
    constexpr double kStep = 1e-6;
    ForwardDynamics<N> f;
    f.qdd = acceleration_of(q, qd, u);
    for (int j = 0; j < N; ++j) {
      const Vec<N> e = kStep * Vec<N>::Unit(j);
      f.dqdd_dq.col(j) = (acceleration_of(q + e, qd, u) - f.qdd) / kStep;
      f.dqdd_dqd.col(j) = (acceleration_of(q, qd + e, u) - f.qdd) / kStep;
    }
    f.dqdd_dtau_ext = -inertia(q).inverse();
    f.ok = true;
    return f;
  }

 private:
  Vec<N> acceleration_of(const Vec<N>& q, const Vec<N>& qd, const Vec<N>& u) const noexcept {
    const Vec<N> rest = coriolis(q, qd) + gravity(q) + friction(qd);
    return inertia(q).llt().solve(u - rest);
  }

  TreeModel<N> arm_;
  std::shared_ptr<const KDL::Chain> chain_;  // solvers keep a reference to it
  KDL::Vector gravity_;
  std::shared_ptr<KDL::ChainDynParam> solver_;
  Mat<N> T_;
  Vec<N> rho0_;
  mutable KDL::JntArray q_ = KDL::JntArray(N), qd_ = q_, out_ = q_;
  mutable KDL::JntSpaceInertiaMatrix B_ = KDL::JntSpaceInertiaMatrix(N);
};

}  // namespace tauext::peers

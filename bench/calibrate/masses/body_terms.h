// SPDX-License-Identifier: Apache-2.0
/// @file
/// The torques that a motion takes, as a sum over the bodies of an arm: each body's part is linear
/// in ten numbers.
///
/// In a body's own axes and about the origin of its joint's frame, with its velocities w, v, its
/// mass m, first moments h = m c and moments of inertia I about that origin, the momentum is
///     l = m v + w x h,     L = I w + h x v.
/// Where the coordinate j moves it by w_j, v_j, which change by w'_j, v'_j (the joint's axis turns
/// with the velocity V of its own body: S' = V x S, estimators/tree/tree_model.h),
///     (B qd)_j = w_j . L + v_j . l,
///     (C^T qd - g)_j = w'_j . L + v'_j . l + (m v_j + w_j x h) . g                             (iii)
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mjcf/import/measured_terms.h"
#include "mjcf/plant/tree.h"

namespace tauext {

/// Numbers of a body: m [kg], h [kg m] (3), and xx, yy, zz, xy, xz, yz of the tensor I [kg m^2].
inline constexpr int kBodyTerms = 10;
using BodyVector = Eigen::Matrix<double, kBodyTerms, 1>;  ///< these of a body

/// Those of a body about its joint's frame.
BodyVector body_vector(const TreeJoint& joint);

/// The body of these numbers, in a frame of the same axes whose origin is at `origin` [m].
MeasuredBody body_of(const BodyVector& numbers, const Eigen::Vector3d& origin);

/// What the bodies' numbers multiply, of some bodies of an arm.
class BodyTerms {
 public:
  /// At one state: a row for each coordinate, kBodyTerms columns for each body.
  struct At {
    Eigen::MatrixXd momentum;  ///< of B qd
    Eigen::MatrixXd rest;      ///< of -(C^T qd - g)
  };

  /// @param bodies by the numbers of their joints
  BodyTerms(const ArmTree& arm, std::vector<int> bodies);

  /// @param q [rad] or [m] and qd of the coordinates
  At at(const Eigen::VectorXd& q, const Eigen::VectorXd& qd) const;

  int columns() const { return kBodyTerms * static_cast<int>(bodies_.size()); }  ///< of At

 private:
  ArmTree arm_;
  std::vector<int> bodies_;
};

}  // namespace tauext

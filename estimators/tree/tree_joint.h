// SPDX-License-Identifier: Apache-2.0
/// @file
/// What an arm of hinges and slides is made of: a joint and the rigid body behind it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "estimators/types.h"

namespace tauext {

/// One joint with its body. The body's frame has its origin on the joint's axis. Where q is `zero`,
/// it stands in the parent's frame at `position`, turned by `rotation`.
struct TreeJoint {
  /// How the body moves.
  enum class Kind { kHinge, kSlide };

  int parent = -1;                       ///< number of an earlier joint; -1: the base
  Kind kind = Kind::kHinge;              ///< q in rad or m
  Vec<3> axis = Vec<3>::UnitZ();         ///< [1] in the body's frame; of any length but 0
  Mat<3> rotation = Mat<3>::Identity();  ///< from the body's axes to the parent's
  Vec<3> position = Vec<3>::Zero();      ///< [m] in the parent's frame
  double zero = 0;                       ///< [rad] q of that pose; [m] of a slide
  double mass = 0;                       ///< [kg] of the body; 0 for one without
  Vec<3> center = Vec<3>::Zero();        ///< [m] of mass, in the body's frame
  Mat<3> inertia = Mat<3>::Zero();       ///< [kg m^2] about the center of mass
  double armature = 0;                   ///< [kg m^2] of the rotor, as the joint feels it
  double viscous = 0;                    ///< [N m s/rad] friction by speed
  double viscous_skew = 0;               ///< [N m s/rad] more of it where qd > 0, less where qd < 0
  double dry = 0;                        ///< [N m] Coulomb friction
  double offset = 0;                     ///< [N m] that tau is always too large by
  double v_s = 0.01;                     ///< [rad/s] of CoulombFriction
};

/// What a TreeModel is made of.
template <int N, int M = N>
struct TreeParameters {
  std::array<TreeJoint, M> joints;                                ///< parents before children
  Vec<3> gravity = {0, 0, -kGravity};                             ///< [m/s^2]
  Eigen::Matrix<double, M, N> drho = decltype(drho)::Identity();  ///< of full rank
  Vec<M> rho0 = Vec<M>::Zero();                                   ///< [rad] or [m] rho at q = 0
};

namespace detail {

/// @throws std::invalid_argument with the number of the joint, from 1, and what is wrong
inline void check_joint(const TreeJoint& j, int i) {
  const auto require = [&](bool good, const char* what) {
    if (!good)
      throw std::invalid_argument("joint " + std::to_string(i + 1) + " of a tree: " + what);
  };
  require(j.parent >= -1 && j.parent < i, "its parent must be an earlier joint, or -1");
  require(j.axis.norm() > 0 && std::isfinite(j.axis.norm()), "its axis must have a direction");
  require((j.rotation * j.rotation.transpose() - Mat<3>::Identity()).norm() < 1e-6 &&
              j.rotation.determinant() > 0,
          "its rotation must be one");
  require(j.position.allFinite() && std::isfinite(j.zero) && j.center.allFinite(),
          "its place must be finite");
  require(j.mass >= 0 && std::isfinite(j.mass), "its mass must be 0 or more");
  require(j.inertia.allFinite() &&
              (j.inertia - j.inertia.transpose()).norm() <= 1e-9 * j.inertia.norm(),
          "its inertia must be finite and symmetric");
  require(j.armature >= 0 && j.viscous >= 0 && j.dry >= 0 && j.v_s > 0,
          "armature and friction must be 0 or more, v_s above 0");
  require(std::abs(j.viscous_skew) <= j.viscous, "viscous_skew must not exceed viscous");
  require(std::isfinite(j.offset), "its offset must be finite");
}

// whether the columns are independent: none vanishes where the others are taken out of it
template <int Rows, int Columns>
bool has_full_rank(Eigen::Matrix<double, Rows, Columns> m) {
  double size[Columns] = {};
  for (int c = 0; c < Columns; ++c) {
    for (int r = 0; r < Rows; ++r) size[c] = std::max(size[c], std::abs(m(r, c)));
  }
  for (int c = 0; c < Columns; ++c) {
    int pivot = c;
    for (int r = c; r < Rows; ++r) {
      if (std::abs(m(r, c)) > std::abs(m(pivot, c))) pivot = r;
    }
    if (!(std::abs(m(pivot, c)) > 1e-12 * size[c])) return false;
    for (int j = c; j < Columns; ++j) std::swap(m(c, j), m(pivot, j));
    for (int r = c + 1; r < Rows; ++r) {
      const double share = m(r, c) / m(c, c);
      for (int j = c; j < Columns; ++j) m(r, j) -= share * m(c, j);
    }
  }
  return true;
}

}  // namespace detail
}  // namespace tauext

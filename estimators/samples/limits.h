// SPDX-License-Identifier: Apache-2.0
/// @file
/// What an arm can do, beyond which a reading is a broken sensor's.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <type_traits>

#include "estimators/concepts.h"
#include "estimators/math/ldlt.h"

namespace tauext {

/// A reading [rad, rad/s, N m] beyond which it is no robot's.
inline constexpr double kMeasurementLimit = 1e6;

/// [rad] after which a hinge is where it was.
inline constexpr double kTurn = 6.283185307179586;

/// Per joint; by default what no robot of any kind exceeds. Of a slide: m, m/s, N, m/s^2.
template <int N>
struct ArmLimits {
  Vec<N> q_least = Vec<N>::Constant(-kMeasurementLimit);  ///< [rad] range of the position
  Vec<N> q_most = Vec<N>::Constant(kMeasurementLimit);    ///< [rad]
  Vec<N> qd = Vec<N>::Constant(100);                      ///< [rad/s] speed
  Vec<N> tau = Vec<N>::Constant(kMeasurementLimit);       ///< [N m] torque
  Vec<N> qdd = Vec<N>::Constant(kMeasurementLimit);       ///< [rad/s^2] change of speed, in time
  Vec<N> dtau = Vec<N>::Constant(kMeasurementLimit);      ///< [N m] change of torque, at once
  std::uint8_t turns = 0xff;  ///< joints to whose q a turn makes no difference, bit 0 for the first
};

/// Whether each range holds something and no number is missing.
template <int N>
bool sensible(const ArmLimits<N>& a) noexcept {
  return (a.q_least.array() <= a.q_most.array()).all() && (a.qd.array() > 0).all() &&
         (a.tau.array() > 0).all() && (a.qdd.array() > 0).all() && (a.dtau.array() > 0).all();
}

/// What the drives of an arm can do at most; 0 where nobody knows.
template <int N>
struct DriveLimits {
  Vec<N> torque = Vec<N>::Zero();  ///< [N m]
  Vec<N> speed = Vec<N>::Zero();   ///< [rad/s]
};

/// What follows from an arm's model and its drives. The scale of a joint's torque is what holds the
/// arm and accelerates it by 5 rad/s^2, in the worst of 64 poses,
///     scale_i = max |g_i| + 5 max B_ii,   qdd_i = 20 rad/s^2 + 2 max |(B^-1 g)_i|  (free falls)
///     tau_i = 50 scale_i + 5 max_j scale_j,   dtau_i = 0.1 scale_i + 0.05 max_j scale_j
/// Where the torque of a joint's drive is known, it takes the place of scale_i if it is more, and
/// tau_i is 3 times that; qd_i is 3 times a known speed, and 5 rad/s at least. The factors are
/// ours, from no source, and wide on purpose: a gate too narrow costs good samples. A slide that B
/// or g depends on has no turns.
template <RobotModel M>
ArmLimits<M::kDof> limits_by_model(const M& model, const DriveLimits<M::kDof>& drives = {}) {
  constexpr int N = M::kDof;
  Vec<N> weight = Vec<N>::Zero(), inertia = weight, fall = weight, q = weight;
  std::uint64_t random = 1;  // Knuth's generator
  for (int pose = 0; pose < 64; ++pose) {
    const Mat<N> B = model.inertia(q);
    const Ldlt<N> factor(B);
    if (factor.ok()) {
      const Vec<N> g = model.gravity(q);
      weight = weight.cwiseMax(g.cwiseAbs());
      inertia = inertia.cwiseMax(B.diagonal());
      fall = fall.cwiseMax(factor.solve(g).cwiseAbs());
    }
    for (int j = 0; j < N; ++j) {
      random = random * 6364136223846793005u + 1442695040888963407u;
      q[j] = kTurn * (static_cast<double>(random >> 11) * 0x1p-53 - 0.5);
    }
  }
  ArmLimits<N> out;
  for (int j = 0; j < N; ++j) {
    Vec<N> turned = q;
    turned[j] += kTurn;
    const bool same = (model.inertia(turned) - model.inertia(q)).norm() <= 1e-6 * inertia.norm() &&
                      (model.gravity(turned) - model.gravity(q)).norm() <= 1e-6 * weight.norm();
    if (!same) out.turns &= static_cast<std::uint8_t>(~(1 << j));
  }
  for (int j = 0; j < N; ++j)
    if (drives.speed[j] > 0) out.qd[j] = std::max(3 * drives.speed[j], 5.);
  const Vec<N> own = weight + 5 * inertia, scale = own.cwiseMax(drives.torque);
  if (!(own.minCoeff() > 0) || !scale.allFinite() || !fall.allFinite()) return out;
  const Vec<N> most = Vec<N>::Constant(own.maxCoeff());
  out.tau = 50 * own + 5 * most;
  out.dtau = 0.1 * scale + 0.05 * most;
  out.qdd = Vec<N>::Constant(20) + 2 * fall;
  for (int j = 0; j < N; ++j)
    if (drives.torque[j] > 0) out.tau[j] = 3 * scale[j];
  out.tau = out.tau.cwiseMin(kMeasurementLimit);
  return out;
}

/// Of this arm: what it says of itself (`limits()`), or what follows from its model.
/// @throws std::invalid_argument if `limits()` are not sensible
template <RobotModel M>
ArmLimits<M::kDof> limits_of(const M& model) {
  if constexpr (!std::is_same_v<ScalarOf<M>, double>) {
    return limits_of(model.template with<double>());
  } else if constexpr (requires { model.limits(); }) {
    const ArmLimits<M::kDof> out = model.limits();
    if (!sensible(out)) throw std::invalid_argument("limits() want q_least <= q_most, others > 0");
    return out;
  } else {
    return limits_by_model(model);
  }
}

}  // namespace tauext

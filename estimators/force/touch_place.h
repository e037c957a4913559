// SPDX-License-Identifier: Apache-2.0
/// @file
/// Where an arm is touched: the link, and the line along which the force acts.
///
/// A force on a link turns the joints on its way from the base and no joint behind it, so the last
/// joint with a torque carries the link that is touched (De Luca and Mattone 2005; Haddadin,
/// De Luca and Albu-Schaeffer 2017, "isolation"). A force whose line meets that joint's axis, or
/// runs along it, is taken for one on the link before: no torque tells them apart, and on the last
/// joint of many arms the end effector lies on that axis. Where six joints or more stand before the
/// link, force f and moment n about its origin follow from (i) of site_force.h, and with them the
/// line
///     p(s) = p0 + f x n / |f|^2 + s f.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "estimators/force/site_force.h"

namespace tauext {

/// A line in the axes of the base.
struct ForceLine {
  Vec<3> point = Vec<3>::Zero();      ///< [m] the one that is nearest to the link's origin
  Vec<3> direction = Vec<3>::Zero();  ///< [1] of the force on the arm
  double pitch = 0;                   ///< [m] moment along it, over the force: 0 for one touch
};

/// Where the arm is touched.
struct TouchPlace {
  /// the coordinate, from 0, that moves the touched link; of several joints that it moves, the
  /// first is meant; -1: no torque is beyond its limit
  int link = -1;
  bool has_line = false;  ///< whether the arm has the joints, in a pose that sees all of force and
                          ///< moment, and no joint that follows others may be touched instead
  ForceLine line;         ///< else 0
  double force = 0;       ///< [N] along it
};

/// Finds the place, sample by sample; keeps nothing of the past. Of an arm of N coordinates and M
/// joints.
template <int N, int M = N>
class TouchFinder {
 public:
  /// @param limits [N m], per coordinate, that the error of tau_ext does not exceed
  /// @throws std::invalid_argument for limits that are not positive
  TouchFinder(const TreeModel<N, double, M>& arm, const Vec<N>& limits)
      : arm_(arm), limits_(limits) {
    if (!(limits.minCoeff() > 0) || !limits.allFinite())
      throw std::invalid_argument("limits of torques must be positive");
    for (int i = 0; i < N; ++i) first_[static_cast<std::size_t>(i)] = first_joint(i);
  }

  /// Of the arm at q [rad] with tau_ext [N m, sign of (3)].
  TouchPlace operator()(const Vec<N>& q, const Vec<N>& tau_ext) const noexcept {
    const Vec<N> size = tau_ext.cwiseAbs().cwiseQuotient(limits_);
    int surest = 0;
    TouchPlace out;
    if (!(size.maxCoeff(&surest) > 1)) return out;
    out.link = surest;
    for (int i = surest + 1; i < N; ++i) {
      if (size[i] > 1 && carries(out.link, i)) out.link = i;
    }
    add_line(q, tau_ext, out);
    return out;
  }

 private:
  // that coordinate i moves
  int first_joint(int i) const {
    if constexpr (M == N) return i;
    const Vec<M> moved = arm_.parameters().drho.col(i).cwiseAbs();
    int first = 0;
    while (!(moved[first] > 1e-9 * moved.maxCoeff())) ++first;
    return first;
  }

  // whether joint i stands on the way from the base to joint j
  bool stands_before(int i, int j) const noexcept {
    while (j > i) j = arm_.parameters().joints[static_cast<std::size_t>(j)].parent;
    return j == i;
  }
  // the same of the first joints of two coordinates
  bool carries(int one, int other) const noexcept {
    return stands_before(first_[static_cast<std::size_t>(one)],
                         first_[static_cast<std::size_t>(other)]);
  }

  // whether the torques could be those of another joint's link, too: one that follows, and moves
  // with this coordinate or behind its joint
  bool has_double(int link) const noexcept {
    const int joint = first_[static_cast<std::size_t>(link)];
    for (int j = 0; j < M; ++j) {
      if (std::find(first_.begin(), first_.end(), j) != first_.end()) continue;
      const auto& drho = arm_.parameters().drho;
      if (!drho.row(j).isZero(0) && (drho(j, link) != 0 || stands_before(joint, j))) return true;
    }
    return false;
  }

  void add_line(const Vec<N>& q, const Vec<N>& tau_ext, TouchPlace& out) const noexcept {
    if constexpr (N >= kJointsOfMoment) {
      int before = 0;  // joints that turn the link
      for (int i = 0; i < N; ++i) before += carries(i, out.link);
      if (before < kJointsOfMoment || has_double(out.link)) return;
      const int joint = first_[static_cast<std::size_t>(out.link)];
      const SiteForce w = detail::force_at<6>(arm_, {joint, Vec<3>::Zero()}, {}, q, tau_ext);
      const double square = w.force.squaredNorm();
      if (!(w.seen.minCoeff() > 1 - 1e-9) || !(square > 0)) return;
      out.has_line = true;
      out.force = std::sqrt(square);
      out.line.direction = w.force / out.force;
      out.line.pitch = w.force.dot(w.moment) / square;
      out.line.point = arm_.position(q, joint, Vec<3>::Zero()) + w.force.cross(w.moment) / square;
    }
  }

  TreeModel<N, double, M> arm_;
  Vec<N> limits_;
  std::array<int, N> first_{};  // joint that each coordinate moves
};

}  // namespace tauext

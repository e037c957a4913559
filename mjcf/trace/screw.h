// SPDX-License-Identifier: Apache-2.0
/// @file
/// The triangle of a joint that a linear screw drives, section 6.1 of the paper: the screw of
/// length b runs from the base to a point of the arm, a and c away from the joint.
#pragma once

#include <cmath>

namespace tauext {

/// (33)-(34) of one joint.
struct Screw {
  double a = 0;       ///< [m] joint to the screw's end on the arm
  double c = 0;       ///< [m] joint to the screw's end on the base
  double gamma0 = 0;  ///< [rad] angle at the joint, between a and c, at q = 0
  double sense = 1;   ///< +1 if a growing q opens that angle, else -1

  /// b [m] at q [rad], by the law of cosines.
  double length(double q) const {
    return std::sqrt(a * a + c * c - 2 * a * c * std::cos(gamma(q)));
  }

  /// Theta [rad], the angle between a and b (34).
  double angle(double q) const {
    const double b = length(q);
    return std::acos((a * a + b * b - c * c) / (2 * a * b));
  }

  /// a sin Theta = db/dq [m], so tau = force lever(q) (33); with the law of sines, which keeps its
  /// sign and its digits where Theta is near 0 or pi.
  double lever(double q) const { return sense * a * c * std::sin(gamma(q)) / length(q); }

 private:
  double gamma(double q) const { return gamma0 + sense * q; }
};

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Which combinations of the bodies' numbers torques can show at all (base parameters: Gautier and
/// Khalil, "Direct calculation of minimum set of inertial parameters of serial robots", T-RA 1990),
/// and which of them recordings have shown.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "bench/calibrate/masses/body_terms.h"
#include "mjcf/plant/tree.h"

namespace tauext {

/// Combinations of numbers, in units of what the bodies have (metric() of physical_fit.h).
struct BaseParameters {
  int all = 0;    ///< that torques show, beside rotors and offsets
  int shown = 0;  ///< of these: with a standard error below a tenth
  /// [1] how many of the others are numbers of each body; a combination counts in parts
  Eigen::VectorXd missing;
};

/// @param bodies of the arm, as in `terms`
/// @param information the inverse of the covariance of their numbers, where joints have their own
/// terms, too
BaseParameters base_parameters(const ArmTree& arm, const BodyTerms& terms,
                               const std::vector<BodyVector>& bodies,
                               const Eigen::MatrixXd& information);

/// [rad] or [m] poses that fill the ranges of the coordinates evenly, a column each.
Eigen::MatrixXd even_poses(const ArmTree& arm, int poses);

}  // namespace tauext

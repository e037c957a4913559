// SPDX-License-Identifier: Apache-2.0
/// @file
/// Recordings as sums over windows (windows.h) of products of the columns of (ii), which is all
/// that least squares needs of them, however long they are.
#pragma once

#include <Eigen/Core>
#include <iterator>
#include <vector>

#include "bench/calibrate/joint_fit.h"
#include "bench/calibrate/least_squares.h"
#include "bench/calibrate/masses/body_terms.h"
#include "bench/calibrate/windows.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// Terms of a joint, kJointTerms in their order, in columns behind those of the bodies.
inline constexpr int kTermsOfJoint = static_cast<int>(std::size(kJointTerms));

/// Sums over some windows of a joint, with A the columns, Z their instruments (least_squares.h),
/// and y the mean torque [N m].
struct WindowSums {
  Eigen::MatrixXd ZZ;  ///< Z^T Z
  Eigen::MatrixXd ZA;  ///< Z^T A
  Eigen::MatrixXd AA;  ///< A^T A
  Eigen::VectorXd Zy;  ///< Z^T y
  Eigen::VectorXd Ay;  ///< A^T y
  double yy = 0;       ///< y^T y
  int windows = 0;     ///< of which they are

  /// Of none.
  explicit WindowSums(int columns = 0);
  WindowSums& operator+=(const WindowSums& more);  ///< of other windows
  /// rms of y - A theta [N m].
  double residual(const Eigen::VectorXd& theta) const;
};

/// Those of one joint.
struct JointSums {
  std::vector<WindowSums> stretches;  ///< kStretches of them, as the recordings go on
  WindowSums all;                     ///< their sum
  int left_out = 0;                   ///< windows that are not in them
  double fastest = 0;                 ///< [rad/s] in those that are
};

/// @param slip [rad/s] over which the dry friction of each joint is smooth; what is so slow that
/// not all of it acts is left out
/// @throws std::invalid_argument naming a joint with too few windows
std::vector<JointSums> window_sums(const ArmTree& arm, const BodyTerms& bodies,
                                   const std::vector<Trace>& logs, const Windows& windows,
                                   const Eigen::VectorXd& slip);

}  // namespace tauext

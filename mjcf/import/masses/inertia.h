// SPDX-License-Identifier: Apache-2.0
/// @file
/// Moments of inertia that a body can have.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace tauext::detail {

/// A body's inertia, and what it was made of.
struct MendedInertia {
  Eigen::Matrix3d inertia;    ///< [kg m^2] whose principal moments are above 0, and at most the sum
                              ///< of the others
  Eigen::Vector3d principal;  ///< [kg m^2] its principal moments, the least first
  Eigen::Quaterniond axes;    ///< from them to its frame
  Eigen::Vector3d moments;    ///< [kg m^2] the principal ones before
  double change = 0;          ///< of a moment, as a share of the largest
  bool few_digits = true;     ///< whether it was lost where the file was printed
};

/// The nearest one that a body of that mass [kg] has; that of a ball of water's density where there
/// is none at all.
MendedInertia mended(const Eigen::Matrix3d& inertia, double kg);

/// Like "'link' (line 12) 0.1, 0.2 and 0.5".
std::string impossible(const std::string& body, const std::string& place,
                       const Eigen::Vector3d& moments);

/// What is wrong with such bodies, and the remedy.
std::string impossible_inertias(const std::vector<std::string>& bodies);

}  // namespace tauext::detail

// SPDX-License-Identifier: Apache-2.0
/// @file
/// The torques that a recorded motion takes, integrated: no acceleration is needed.
///
/// With the momentum p = B qd, (3) without contact is dp/dt = tau + C^T qd - g - F, so over a
/// window [t_a, t_b) of length T
///     mean(tau) = (p_b - p_a) / T - mean(C^T qd - g) + mean(F)                              (ii)
/// The means go through the same samples, so nothing is lost to a filter.
#pragma once

#include <Eigen/Core>

#include "bench/calibrate/windows.h"
#include "mjcf/plant/tree.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// A recording of an arm.
class ArmMotion {
 public:
  /// @throws std::invalid_argument for another number of joints
  ArmMotion(const ArmTree& arm, const Trace& log);

  /// [N m] the right side of (ii), of one joint.
  double expected(int joint, const Window& w) const;

 private:
  const Trace& log_;
  Eigen::MatrixXd momentum_;  // p of each sample
  Eigen::MatrixXd rest_;      // F - (C^T qd - g), likewise
};

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// The torques that a recorded motion takes, integrated: no acceleration is needed.
///
/// With the momentum p = B qd, (3) without contact is dp/dt = tau + C^T qd - g - F, so over a
/// window
///     mean(tau) = mean(dp/dt) - mean(C^T qd - g) + mean(F)                                  (ii)
/// The means go through the same samples with the same weights (windows.h), so nothing is lost to a
/// filter.
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

  /// [N m] its instrument.
  double expected_around(int joint, const Window& w) const;

 private:
  const Trace& log_;
  Eigen::MatrixXd momentum_;  // p of each sample
  Eigen::MatrixXd rest_;      // F - (C^T qd - g), likewise
};

}  // namespace tauext

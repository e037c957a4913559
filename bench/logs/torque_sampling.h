// SPDX-License-Identifier: Apache-2.0
/// @file
/// Whether a log's tau is rather held from t on or read at t (TorqueSampling), from a motion
/// without contact.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "estimators/types.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// How much of the difference between both readings a log shows.
struct TorqueWeight {
  double weight = 0;  ///< [1] 0 if tau is held, 1 if it is read at instants; neither: cannot tell
  double sure = 0;    ///< [1] three standard errors
  /// Whether that contradicts the reading that was assumed, beyond doubt.
  bool contradicts(bool assumed_instant) const;
};

/// Between one momentum observer's estimates by both readings lies a signal that is known; without
/// a contact the estimate by `held` is weight times that signal, and noise. A joint counts by its
/// weight's standard error, over as many fewer samples as the observer is slower than they.
/// @param held, instant [N m] estimates, a column each sample
/// @param status of the samples; those that are not kOk, or in contact, do not count
/// @param bandwidth [rad/s] of the observer
/// @return nothing where no joint has 1000 samples that count, or none moves
std::optional<TorqueWeight> torque_weight(const Trace& trace, const Eigen::MatrixXd& held,
                                          const Eigen::MatrixXd& instant,
                                          const std::vector<Status>& status, double bandwidth);

}  // namespace tauext

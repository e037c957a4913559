// SPDX-License-Identifier: Apache-2.0
/// @file
/// Runs as estimators and detectors see them, read once for all of them.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/roster/session/answers.h"
#include "bench/roster/thresholds.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// A detector that is asked.
struct Asked {
  std::string detector;       ///< specification
  DetectorSettings settings;  ///< how it is set
};

/// Many estimators over one or several runs, and many detectors behind each. Specifications and
/// settings are those of Robot, and so are its errors. Several runs are several lanes of a SIMD
/// register where estimator, detector and samples allow it (estimators/runs/), and else come one
/// after the other.
class Session {
 public:
  virtual ~Session() = default;

  /// Runs an estimator over the runs. Detectors see its estimates from now on.
  /// @return why those of each run cannot be used (soundness.h); "" where they can
  /// @throws std::invalid_argument for one that needs a truth which the traces do not have
  virtual std::vector<std::string> estimate(std::string_view estimator) = 0;

  /// What each of these detectors says of each run from a time on [s], all at once: the score's
  /// rises are through `levels`, which grow.
  virtual std::vector<std::vector<Answers>> answers(std::span<const Asked> detectors,
                                                    std::span<const double> levels,
                                                    double from) = 0;
  /// The largest statistic of a calibratable detector in each run, joint by joint, over samples
  /// with t >= from [s].
  virtual std::vector<Eigen::VectorXd> largest_statistic(const Asked& detector, double from) = 0;
  /// The mean of z z^T over samples of each run with t >= from [s], z the change() of a detector
  /// with a metric.
  virtual std::vector<Eigen::MatrixXd> covariance(const Asked& detector, double from) = 0;
};

class Robot;

/// Of a robot, over traces, both of which must outlive it. So many traces as Robot::runs_at_once()
/// take the least time each, if they have the same time stamps and no sample is left out; more are
/// done one by one.
/// @throws std::invalid_argument for traces of another number of joints
std::unique_ptr<Session> make_session(const Robot& robot, std::span<const Trace> traces);

}  // namespace tauext

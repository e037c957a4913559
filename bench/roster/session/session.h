// SPDX-License-Identifier: Apache-2.0
/// @file
/// Runs as estimators and detectors see them, read once for all of them.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/roster/thresholds.h"
#include "estimators/types.h"

namespace tauext {

/// What a detector said of one run, from a time on.
struct Answers {
  /// A fiducial mark.
  struct Mark {
    double t;         ///< [s]
    Contact contact;  ///< what for
  };
  /// [s] from one rise through a level to the next, at least
  static constexpr double kApart = 0.2;

  std::vector<Mark> marks;                 ///< all there are
  std::vector<std::vector<double>> rises;  ///< [s] where the score rose through each level
  long samples = 0;                        ///< that were looked at
  long alarmed = 0;                        ///< of them, with a score of 1 or more
};

/// A detector that is asked.
struct Asked {
  std::string_view detector;  ///< specification
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

}  // namespace tauext

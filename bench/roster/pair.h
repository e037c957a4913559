// SPDX-License-Identifier: Apache-2.0
/// @file
/// An estimator with a detector behind it, over a run, a sample at a time, and by batches.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "bench/roster/detectors.h"
#include "bench/roster/estimators.h"
#include "estimators/samples/status_counts.h"
#include "estimators/types.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// What a run over a whole trace gives; one column or element per sample.
struct Output {
  Eigen::MatrixXd tau_ext;          ///< [N m]
  std::vector<Status> status;       ///< of the estimates
  std::vector<std::uint8_t> marks;  ///< empty without a detector
  StatusCounts counts;              ///< of the statuses
};

/// What became of one sample.
struct StepResult {
  Status status = Status::kOk;  ///< of the estimate
  std::uint8_t joints = 0;      ///< that it is about, bit 0 for the first
  Detection detection;          ///< of the detector, if there is one
};

/// An estimator, and a detector behind it if there is one, of the same number of joints.
class Pair {
 public:
  /// @param d null: no detector
  Pair(std::unique_ptr<EstimatorStage<>> e, std::unique_ptr<DetectorStage<>> d)
      : estimator_(std::move(e)), detector_(std::move(d)) {}

  void reset() noexcept;  ///< forgets all samples
  /// Reads a value for each joint of q [rad], qd [rad/s] and tau [N m] at time t [s], and writes
  /// tau_ext [N m]. Allocates nothing.
  StepResult step(double t, const double* q, const double* qd, const double* tau,
                  double* tau_ext) noexcept;
  /// The next samples; `detections` of a pair without a detector is left as it is.
  void run(const SampleColumns<>& in, const EstimateColumns<>& out,
           std::span<Detection> detections);
  /// Resets, then runs over the whole trace.
  Output run(const Trace& trace);
  bool detects() const { return detector_ != nullptr; }  ///< whether there is a detector

 private:
  std::unique_ptr<EstimatorStage<>> estimator_;
  std::unique_ptr<DetectorStage<>> detector_;
};

/// A pair over the samples of a trace, again and again: the work that is timed.
class Runner {
 public:
  static constexpr int kBatch = 1000;  ///< samples

  /// Copies t, q, qd and tau of the trace.
  Runner(Pair pair, const Trace& trace);
  /// The next samples, from a reset and the first one again after the last.
  void batch();
  /// All of them, from a reset.
  Output run();

 private:
  Pair pair_;
  Trace samples_;
  std::size_t next_ = 0;
  std::vector<double> tau_ext_;
  std::vector<Status> status_;
  std::vector<std::uint8_t> joints_;
  std::vector<Detection> detections_;
};

}  // namespace tauext

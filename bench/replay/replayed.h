// SPDX-License-Identifier: Apache-2.0
/// @file
/// What estimators make of a log, sample by sample, and what is said of them in the end.
#pragma once

#include <Eigen/Core>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "bench/roster/robot.h"
#include "bench/score/detection_metrics.h"
#include "bench/score/metrics.h"
#include "mjcf/trace/read/recording.h"

namespace tauext {

/// What an estimate means: the force at a point, and the link that is touched.
struct Acting {
  SiteForce force;   ///< at the point
  TouchPlace touch;  ///< wherever it is
};

/// An estimator, and a detector behind it if there is one, over a log that goes by. Nothing in it
/// grows with the log.
class Replayed {
 public:
  /// What it may be beside a pair.
  struct Setup {
    std::string estimator;              ///< its specification
    std::string detector;               ///< behind it; "" for none
    const ArmForces* forces = nullptr;  ///< to find out what acts; null if nobody asked
    double score_from = 0;              ///< [s] errors before it do not count
  };
  /// For a log that has these.
  Replayed(Setup setup, Pair pair, const RecordingContents& log);

  /// The next sample.
  void take(const RecordedSample& y);

  const std::string& estimator() const { return setup_.estimator; }  ///< its specification
  const std::string& detector() const { return setup_.detector; }    ///< "" for none
  bool finds_forces() const { return setup_.forces != nullptr; }     ///< whether that was asked
  const Eigen::VectorXd& tau_ext() const { return tau_ext_; }        ///< [N m] of the last sample
  const StepResult& last() const { return last_; }                   ///< its status and mark
  const Acting& acting() const { return acting_; }                   ///< and what it means
  const StatusCounts& counts() const { return counts_; }             ///< of all samples
  /// Joint by joint, over samples with t >= score_from; empty without a truth.
  const std::vector<metrics::Errors>& errors() const { return errors_; }
  /// What its marks are worth, as the log's labels say.
  metrics::DetectionScore marks() const { return marks_.score(); }

  /// The sample with the largest force.
  struct Largest {
    double force = -1;  ///< [N]; below 0: there was no sample
    double t = 0;       ///< [s]
    int link = 0;       ///< as touched_link() has it
  };
  const Largest& largest() const { return largest_; }  ///< of all samples

 private:
  Setup setup_;
  Pair pair_;
  Eigen::VectorXd tau_ext_;
  StepResult last_;
  Acting acting_;
  StatusCounts counts_;
  std::vector<metrics::Errors> errors_;
  metrics::DetectionCounter marks_;
  Largest largest_;
};

/// A table of their errors, if the log has a truth; and what their detectors were worth, if it has
/// contacts.
void print_metrics(const std::vector<Replayed>& all, const RecordingContents& log, std::FILE* to);

/// Of each the largest force, if forces were looked for.
void print_forces(const std::vector<Replayed>& all, int dof, std::FILE* to);

}  // namespace tauext

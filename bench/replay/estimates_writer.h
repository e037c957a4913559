// SPDX-License-Identifier: Apache-2.0
/// @file
/// The file of what estimators made of a log.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "bench/replay/replayed.h"

namespace tauext {

/// Takes estimates as they come. A file appears whole, by commit(), or not at all; standard output
/// and pipes get rows at once.
class EstimatesWriter {
 public:
  virtual ~EstimatesWriter() = default;
  /// What all of them made of the sample y, which they have taken.
  /// @param tau of the sample, as the log has it
  /// @throws std::runtime_error naming the path
  virtual void add(const RecordedSample& y, const Eigen::VectorXd& tau,
                   const std::vector<Replayed>& all) = 0;
  /// @throws std::runtime_error naming the path
  virtual void commit() = 0;
};

/// A CSV with a row for each sample: t, and of each estimator its tau_ext, status, mark and forces;
/// t and tau_ext in as many digits as tell them from others, forces in nine. Standard output if the
/// path is "-". Or a .npz with the arrays t, NAME_tau_ext, NAME_status, the marks, and NAME_force,
/// NAME_moment and NAME_link, which lies in memory until commit(). Or a .mcap with the recording as
/// McapSamples has it, and a topic /estimate/NAME for each of them.
/// @param all those whose estimates will come
/// @param log the recording, before its torques were made of currents, scaled or added to
/// @throws std::runtime_error naming the path
std::unique_ptr<EstimatesWriter> estimates_writer(const std::string& path,
                                                  const std::vector<Replayed>& all,
                                                  const RecordingContents& log);

}  // namespace tauext

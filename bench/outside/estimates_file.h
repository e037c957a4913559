// SPDX-License-Identifier: Apache-2.0
/// @file
/// Estimates that were made elsewhere.
#pragma once

#include <string>
#include <vector>

#include "bench/roster/pair.h"
#include "mjcf/trace/trace.h"

namespace tauext {

/// What somebody's estimator said of the samples of a trace.
struct OutsideEstimates {
  std::string estimator;  ///< its name
  std::string detector;   ///< behind it; "" for none
  Output output;          ///< a column for each sample; one without an estimate is kBadTime
};

/// The estimators of a file (bench/outside/README.md), each sample of the trace with the estimate
/// of its time.
/// @param name of an estimator that the file does not name
/// @throws std::runtime_error naming the path and what is wrong: unreadable, no tau_ext, another
/// number of joints or samples, most rows at times of no sample, an estimator without estimates for
/// most of the samples
std::vector<OutsideEstimates> read_estimates(const std::string& path, const std::string& name,
                                             const Trace& trace);

}  // namespace tauext

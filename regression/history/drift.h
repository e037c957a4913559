// SPDX-License-Identifier: Apache-2.0
/// @file
/// What has added up since the reference: in time, kernel by kernel, and in the metrics. And how
/// that is shown.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "regression/history/history.h"

namespace tauext::gate {

/// What may add up.
struct DriftLimits {
  double time = 0.02;    ///< [1] a step may surely be longer than the reference's by this share
  double metric = 0.02;  ///< [1] a metric may be worse by this share
};

/// One kernel of the last record.
struct KernelDrift {
  std::string kernel;
  /// ln(time / the first reference's), as far back as a chain of references reaches; the last one
  /// is the last record's.
  std::vector<double> level;
  KernelRecord last;
  double accepted = 0;     ///< [1] by how much it may be slower than the reference, on purpose
  bool drifted = false;    ///< slower than the reference by more than that and the limit
  bool undecided = false;  ///< measured so, but not surely
};

/// One metric that is worse than the reference's.
struct MetricDrift {
  std::string name;  ///< "entry metric"
  double before = 0, after = 0;
};

/// What a history says of its last record.
struct Drift {
  std::vector<KernelDrift> kernels;
  std::vector<MetricDrift> metrics;  ///< the worst first
  int metrics_moved = 0;             ///< since the reference, for better or worse
  bool slower() const;               ///< whether a kernel is, beyond what is accepted
  bool any() const { return slower() || !metrics.empty(); }  ///< whether something is worse
};

/// @param history with at least one record
Drift drift_of(const std::vector<Record>& history, const DriftLimits& limits = {});

/// One bar for each of the last `most` values, from the smallest to the largest. Where these differ
/// by less than 0.01, the highest bar stands for the smallest + 0.01.
std::string sparkline(const std::vector<double>& values, std::size_t most);

/// The last commit beside its reference: what drifted, and a line for each kernel that ever
/// changed.
/// @param all those that did not, too
/// @param markdown tables for a page, else for a terminal
std::string format_drift(const std::vector<Record>& history, const Drift& drift, bool all,
                         bool markdown);

/// The kernels of a commit in the JSON that github-action-benchmark charts, as its tool
/// customSmallerIsBetter: each the time of a step in % of the reference's.
std::string format_for_charts(const Record& last);

}  // namespace tauext::gate

// SPDX-License-Identifier: Apache-2.0
/// @file
/// How golden metrics compare with the committed ones.
///
/// T0: a repeated seed gives the same bits. T1: a value that differs by more than its metric's
/// tolerance, better or worse, wants a reviewed update. T2: paired over the seeds, a mean that is
/// worse by more than 0.5 % and by more than 3 standard errors is less accurate.
#pragma once

#include <string>
#include <vector>

#include "bench/score/metric_list.h"
#include "regression/accuracy/golden_file.h"

namespace tauext::gate {

/// What became of one line.
enum class Change { kUnchanged, kBetter, kWorse, kChanged, kNew, kGone };

/// A line that is not as it was.
struct MetricChange {
  std::string entry, metric;
  Change change = Change::kChanged;
  double before = 0, after = 0;  ///< means over the seeds; NaN: never
  double standard_errors = 0;  ///< of the mean of the paired differences; infinite if all are equal
  std::string worst_seed;      ///< the one that changed most, for the worse if any did
  std::string largest_error_at;  ///< [s] of that seed's run, as its golden file says; "" if unknown
  std::string note;
  std::string accepted;  ///< why it is right; "" if nobody says so
};

/// What was found.
struct AccuracyReport {
  int lines = 0;                          ///< compared
  std::vector<MetricChange> changes;      ///< the worst first
  std::string no_baseline;                ///< why nothing was compared; "" if it was
  std::vector<std::string> not_repeated;  ///< T0: what the same seed did not give twice
  int worse() const;
};

/// Limits of T2.
inline constexpr double kWorseBy = 0.005, kStandardErrors = 3;

/// Compares head with the baseline. Another MuJoCo, other sensors or other seeds: no_baseline.
/// @param filter regular expression on entries; only those of the baseline that match can be gone
AccuracyReport compare_accuracy(const Golden& baseline, const Golden& head,
                                const std::string& filter = "");

/// T0: the lines of `again`, which has some of the seeds of `once`, that are not the same to the
/// last bit, as "entry metric, seed n: a then b".
std::vector<std::string> not_repeated(const Golden& once, const Golden& again);

/// A metric's row, that of all joints for one joint's; one of its own, less is better, if nobody
/// knows it.
const MetricRow& metric_row(const std::string& metric);

/// A metric's value for people: six digits, or "never".
std::string said(double value);

/// Whether larger is better, by bench/score/metric_list.h.
bool larger_is_better(const std::string& metric);

}  // namespace tauext::gate

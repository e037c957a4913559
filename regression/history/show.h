// SPDX-License-Identifier: Apache-2.0
/// @file
/// A history for people.
#pragma once

#include <string>
#include <vector>

#include "regression/history/drift.h"

namespace tauext::gate {

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

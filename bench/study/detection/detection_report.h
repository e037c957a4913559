// SPDX-License-Identifier: Apache-2.0
/// @file
/// What people and programs see of a detection study.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "bench/roster/thresholds.h"
#include "bench/study/detection/study_counts.h"
#include "mjcf/trace/table_writer.h"

namespace tauext::study {

/// As text a table for each condition, and what the columns mean; else one table with a column of
/// conditions.
/// @param runs that were studied
std::string format_study(const StudyRuns& runs, const std::vector<Cell>& cells,
                         TableFormat format = TableFormat::kText);

/// All of it as JSON text: counts, quantiles, the bound on false alarms, points of the ROC.
/// @param context keys and texts that say where it comes from
std::string study_json(const StudyRuns& runs, const std::vector<Cell>& cells,
                       const Thresholds& thresholds,
                       const std::vector<std::pair<std::string, std::string>>& context = {});

}  // namespace tauext::study

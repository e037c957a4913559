// SPDX-License-Identifier: Apache-2.0
/// @file
/// Scores for people.
#pragma once

#include <string>
#include <vector>

#include "bench/score/entry.h"
#include "bench/score/score.h"
#include "mjcf/trace/table_writer.h"

namespace tauext {

/// One row: an entry, its score and, once it was timed, the time of a step.
struct Row {
  Entry entry;  ///< what was run
  Score score;  ///< what it is worth
};

/// The rows in their order; a column for each metric of the table that some row has; `*` at the
/// best of a group's column (baselines do not compete), "never" for a metric without a value. A
/// failed entry says why, as "FAILED: why" or in a column of its own. CSV and JSON name the columns
/// by the metrics' keys.
/// @param also columns that the suite's table does not have
std::string format_table(const std::vector<Row>& rows, TableFormat format = TableFormat::kText,
                         const std::vector<Metric>& also = {});

/// What the columns of format_table(rows) mean, a line each.
std::string table_legend(const std::vector<Row>& rows, const std::vector<Metric>& also = {});

/// A share [%] for a table; "-" of nothing.
std::string percent(double part, double of);

/// A time [s] in milliseconds for a table; "-" for NaN.
std::string milliseconds(double s, int digits = 0);

/// The list of metrics as a table.
std::string list_of_metrics(TableFormat format = TableFormat::kMarkdown);

}  // namespace tauext

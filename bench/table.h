// SPDX-License-Identifier: Apache-2.0
/// @file
/// The table for people.
#pragma once

#include <string>
#include <vector>

#include "bench/suite.h"

namespace tauext {

/// One row: an entry, its score and, once it was timed, the time of a step.
struct Row {
  Entry entry;
  Score score;  ///< with cpu_ns when timed
};

/// The rows in their order, columns aligned, units in the head, `*` at the best of a group's column
/// (baselines do not compete), "never" for a metric without a value, "FAILED: why" for a failed
/// entry. Columns that no row has are left out.
std::string format_table(const std::vector<Row>& rows);

/// One line a symbol: what the columns mean.
std::string table_legend();

}  // namespace tauext

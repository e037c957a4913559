// SPDX-License-Identifier: Apache-2.0
/// @file
/// Tables of what seeds say.
#pragma once

#include <string>
#include <vector>

#include "bench/seeds/seeds.h"
#include "mjcf/trace/table_writer.h"

namespace tauext {

/// For people a table of means and one of differences; for programs a row for each entry and
/// metric.
/// @param against the estimator that others of its group are compared with, behind their own
/// detector; or ESTIMATOR+DETECTOR
std::string format_seeds(const std::vector<SeededRow>& rows, const std::string& against,
                         TableFormat format = TableFormat::kText);

}  // namespace tauext

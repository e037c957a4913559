// SPDX-License-Identifier: Apache-2.0
/// @file
/// What people and programs see of a detection study.
#pragma once

#include <string>
#include <vector>

#include "bench/detection_study.h"

namespace tauext {

/// A table for each condition, and the worst of each pair over all of them.
std::string format_study(const std::vector<Cell>& cells);

/// All of it as JSON text: counts, quantiles, the bound on false alarms, points of the ROC.
std::string study_json(const std::vector<Cell>& cells, const Thresholds& thresholds);

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// What one run adds to a cell of the detection study. Not installed.
#pragma once

#include <vector>

#include "bench/detection_study.h"
#include "estimators/types.h"
#include "mjcf/touch.h"
#include "mjcf/trace.h"

namespace tauext::study {

/// Counts a run of that kind: what a detector said of it, against the touches that were there.
void count(TouchKind kind, const Trace& t, const std::vector<Detection>& d,
           const std::vector<Touch>& touches, Cell& cell);

/// Adds a run to the sum; the names in `sum` stay.
void add(const Cell& run, Cell& sum);

}  // namespace tauext::study

// SPDX-License-Identifier: Apache-2.0
/// @file
/// How far an arm moves on after it has met something.
#pragma once

#include <span>
#include <vector>

#include "bench/study/study_runs.h"
#include "mjcf/plant/model.h"
#include "mjcf/scenarios/regions.h"
#include "mjcf/trace/trace.h"

namespace tauext::study {

/// At each sample of a run, how far [m] the touched point is from where it was when the meeting
/// began; 0 where none has begun, or the last one is over for longer than metrics::kGrace.
/// @param touches that the run has, one after the other
std::vector<double> moved_on(const std::vector<RegionTouch>& touches, const Model& model,
                             const Trace& truth);
/// The same of each of these jobs; empty for one without a region.
std::vector<std::vector<double>> moved_on(const StudyRuns& runs, std::span<const Job> jobs,
                                          const Model& model, std::span<const Trace> truths);

}  // namespace tauext::study

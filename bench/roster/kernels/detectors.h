// SPDX-License-Identifier: Apache-2.0
/// @file
/// The detectors of detector_list.h, compiled once for each level of instructions; W is that of the
/// level, and in the functions' names, so that none of another level is taken.
#pragma once

#include <memory>
#include <vector>

#include "bench/roster/detectors.h"
#include "estimators/math/pack.h"

namespace tauext::detail {

// for an arm whose torques are so many times the usual ones
template <int W>
std::vector<DetectorType> roster_detectors(const JointVec<>& torques);
template <>
std::vector<DetectorType> roster_detectors<kRuns>(const JointVec<>& torques);

// null for one that is not of the list
template <int W>
std::unique_ptr<DetectorStage<Pack<W>>> detector_of_runs(const Specification& s,
                                                         const DetectorSettings& settings,
                                                         const JointVec<>& torques);
template <>
std::unique_ptr<DetectorStage<Pack<kRuns>>> detector_of_runs<kRuns>(
    const Specification& s, const DetectorSettings& settings, const JointVec<>& torques);

}  // namespace tauext::detail

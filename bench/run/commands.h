// SPDX-License-Identifier: Apache-2.0
/// @file
/// The commands that make an entry's run outside of the suite.
#pragma once

#include <string>

#include "bench/score/suite.h"

namespace tauext {

/// Two lines: tauext-record with everything that the entry's trace depends on (the pair that stops
/// the motor, in a scenario that reacts), and tauext-replay, which prints the errors of the same
/// estimates.
/// @param entry its name, of those that are selected
/// @throws std::invalid_argument for an unknown entry, and for thresholds, which those two programs
/// do not take
std::string record_and_replay(const std::string& entry, const SuiteOptions& options,
                              const Selection& selection = {});

}  // namespace tauext

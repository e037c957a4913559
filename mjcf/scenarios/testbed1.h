// SPDX-License-Identifier: Apache-2.0
/// @file
/// The experiments of section 6 of the paper, and runs of the testbed that a seed draws.
#pragma once

#include <cstdint>
#include <vector>

#include "mjcf/scenarios/scenario_type.h"

namespace tauext {

/// Those that scenarios("testbed1") begins with.
std::vector<Scenario> scenarios_of_testbed1();

/// `manual` of testbed1 with other moves of the hand; seed 1 is the one in the list.
Scenario manual_of_testbed1(std::uint64_t seed);

/// A blow on testbed1's tip while it moves up, down or rests: upwards or downwards, a half sine of
/// 100 to 300 N and 10 to 50 ms, each drawn by the seed. 2 s long.
Scenario blow_on_testbed1(std::uint64_t seed);

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Section 5.2 of the paper, and what it leaves out.
#pragma once

#include <vector>

#include "mjcf/scenarios/scenario_type.h"

namespace tauext {

/// Those that scenarios("wallmobot3") begins with.
std::vector<Scenario> scenarios_of_wallmobot3();

}  // namespace tauext

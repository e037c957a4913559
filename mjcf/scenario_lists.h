// SPDX-License-Identifier: Apache-2.0
/// @file
/// The scenarios of each robot; mjcf/scenario.h is how to ask for them.
#pragma once

#include <vector>

#include "mjcf/scenario.h"

namespace tauext {

std::vector<Scenario> scenarios_of_wallmobot3();
std::vector<Scenario> scenarios_of_testbed1();

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Masses that no arm will have.
#pragma once

#include <string>

#include "mjcf/mujoco/handles.h"

namespace tauext {

/// Of an arm of three joints or more, not all in one place: bodies whose inertia is that of
/// something larger than the whole arm, and a mass that would be heavier than gold if it filled a
/// cube as long as the arm reaches; hinges of more than four turns, and slides of more than 10 m.
/// Files have such numbers where somebody only needed some, or in g, mm and degrees. In one line,
/// with what they are; "" if there are none.
std::string doubts_about(const mjModel& m);

}  // namespace tauext

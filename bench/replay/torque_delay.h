// SPDX-License-Identifier: Apache-2.0
/// @file
/// Whether the torques of a recording are those of another time than its motion.
///
/// The mean torque of windows (arm_windows.h) is compared with the model's as it is, and as it was
/// up to 0.2 s earlier or later. What a joint's torque may have beside the model without being late
/// is left aside: friction, a rotor's inertia, other masses, and a sensor's offset.
#pragma once

#include <string>

#include "bench/replay/arm_windows.h"
#include "mjcf/plant/tree.h"

namespace tauext {

/// "" or why: the torques fit better by half (mean square: 2.25) if they are taken 20 to 190 ms
/// earlier or later, by more than chance, and a factor does not explain as much.
std::string found_delay(const ArmTree& arm, const WindowMaker& recording);

}  // namespace tauext

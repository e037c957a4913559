// SPDX-License-Identifier: Apache-2.0
/// @file
/// What else than a load explains a recording's torques, where it is too little for torque_fit.h to
/// see in slow poses: gravity that is there twice, or that one joint or all lack, a factor of all
/// torques or of one joint's, all signs of one joint reversed, two joints that move alike and are
/// exchanged, a rotor larger than the arm, or an offset larger than a sensor's.
///
/// Each is fitted to the mean torques of windows (arm_windows.h), beside what any recording may
/// have: friction and rotors' inertia that the file lacks, and, but for the last, an offset.
#pragma once

#include <string>

#include "bench/replay/arm_windows.h"
#include "mjcf/plant/tree.h"

namespace tauext {

/// "" or a cause with its number and the remedy. But for the rotor it is no chance, and explains
/// more than an unknown load does; each makes the rest of a joint 1.5 times smaller.
std::string found_cause(const ArmTree& arm, const WindowMaker& recording);

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Writes a recording in the layout of other people's programs, of which presets.h has the maps: to
/// try on a made one what real ones will meet.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjcf/trace/trace.h"

namespace tauext {

/// Writes what the sensors read, and `contact` where it is known; a truth is left out, as no
/// recording has one. The clock begins where such clocks do; but for a bag's it counts whole
/// milliseconds, so that samples that jitter may get the same. To standard output if the path is
/// "-"; the file appears whole or not at all.
/// @param layout libfranka, ur_rtde (currents, and blanks between, as UR's record.py) or
/// joint_state (a bag, without contact)
/// @param gain [N m/A] of each drive, for currents
/// @param joints their names, for a bag; empty: joint1, joint2, ..
/// @throws std::invalid_argument for another layout, listing these, and for a gain that is 0
/// @throws std::runtime_error naming the path
void write_layout(const Trace& trace, const std::string& layout, const Eigen::VectorXd& gain,
                  std::vector<std::string> joints, const std::string& path);

}  // namespace tauext

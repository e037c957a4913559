// SPDX-License-Identifier: Apache-2.0
/// @file
/// Writes what was calibrated into a robot file (mjcf/import/robot_file.h).
#pragma once

#include <string>
#include <vector>

#include "bench/calibrate/arm_calibration.h"
#include "bench/calibrate/weighing.h"

namespace tauext {

/// What goes into it.
struct NewRobotFile {
  std::string from;                     ///< the robot's file: MJCF, URDF, or ours, which is kept
  std::string lock;                     ///< of its joints (ImportOptions), if it is not ours
  std::vector<CalibratedJoint> joints;  ///< may be none
  const Weighing* payload = nullptr;    ///< may be missing
  std::vector<std::string> recordings;  ///< of which it was made, for the reader
};

/// The text of a file that will stand at `out`, from where the robot's file is named. Friction or
/// inertia that came out negative is 0 there: `said` gets a line about each.
/// @throws std::runtime_error as robot_file() does
std::string robot_file_text(const NewRobotFile& robot, const std::string& out,
                            std::vector<std::string>& said);

}  // namespace tauext

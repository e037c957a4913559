// SPDX-License-Identifier: Apache-2.0
/// @file
/// Writes what was calibrated into a robot file (mjcf/import/robot_file.h).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "bench/calibrate/arm_calibration.h"
#include "bench/calibrate/weighing.h"
#include "mjcf/import/measured_terms.h"
#include "mjcf/plant/tree.h"

namespace tauext {

/// What goes into it.
struct NewRobotFile {
  std::string from;                     ///< the robot's file: MJCF, URDF, or ours, which is kept
  std::string lock;                     ///< of its joints (ImportOptions), if it is not ours
  std::vector<CalibratedJoint> joints;  ///< may be none
  const Weighing* payload = nullptr;    ///< may be missing
  std::vector<std::string> recordings;  ///< of which it was made, for the reader
  std::map<std::string, MeasuredBody> bodies;  ///< may be none
};

/// The text of a file that will stand at `out`, from where the robot's file is named.
/// @throws std::runtime_error as robot_file() does
std::string robot_file_text(const NewRobotFile& robot, const std::string& out);

/// The arm of that file, which is written to a folder of its own and read again.
/// @throws std::runtime_error as load_mjcf() does
ArmTree read_back(const NewRobotFile& robot);

/// Writes the file to a folder of its own and reads it again: what its model leaves of the
/// recordings becomes each joint's `after`. Where that is not what the fit promised, or where
/// friction is more than the joint's drive can overcome, it adds a doubt.
/// @throws std::runtime_error as load_mjcf() does
void judge_by_file(NewRobotFile& robot, const std::vector<Trace>& logs, const Windows& windows);

}  // namespace tauext

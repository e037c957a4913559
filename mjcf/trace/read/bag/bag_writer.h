// SPDX-License-Identifier: Apache-2.0
/// @file
/// Writes a bag of ROS 2, as rosbag2_storage_sqlite3 does (schema 2, Foxy to Humble).
#pragma once

#include <string>
#include <vector>

#include "mjcf/trace/trace.h"

namespace tauext {

/// The bytes of a bag with a sensor_msgs/JointState on /joint_states for each sample.
/// @param joints their names, one for each
/// @param begin [s] of the clock at t = 0
/// @throws std::runtime_error if SQLite was missing at build
std::string bag_of(const Trace& trace, const std::vector<std::string>& joints, double begin);

}  // namespace tauext

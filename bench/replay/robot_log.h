// SPDX-License-Identifier: Apache-2.0
/// @file
/// A recorded log, for a robot.
#pragma once

#include <memory>
#include <string>

#include "bench/logs/read_log.h"
#include "bench/roster/robot.h"

namespace tauext {

/// All of it, with torques in N m, and its report. Where the torques may be another robot's, it
/// prints why, and the log is not usable().
/// @throws std::runtime_error or std::invalid_argument naming the path and the reason, also where
/// the torques contradict the robot (bench/replay/torque_fit.h)
RecordedLog robot_log(const Robot& robot, const std::string& path, const std::string& channel,
                      const std::string& columns,
                      std::shared_ptr<const ContactsFile> contacts = nullptr);

}  // namespace tauext

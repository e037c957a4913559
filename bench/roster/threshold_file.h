// SPDX-License-Identifier: Apache-2.0
/// @file
/// The file of thresholds that calibration writes and the suite reads, and what it says of a
/// detector.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "bench/roster/robot.h"
#include "bench/roster/thresholds.h"

namespace tauext {

/// The text of their file.
/// @param more keys that stand before the thresholds; nobody here reads them
std::string thresholds_json(const Thresholds& t, const nlohmann::ordered_json& more = nullptr);

/// Writes them as JSON; the file appears whole or not at all.
/// @param more as of thresholds_json()
/// @throws std::runtime_error naming the path
void write_thresholds(const Thresholds& t, const std::string& path,
                      const nlohmann::ordered_json& more = nullptr);

/// @throws std::runtime_error naming the path and what is wrong: unreadable, not JSON, a missing
/// key, no set, a margin or a threshold that is not positive, a wrong number of joints, an unknown
/// robot, and of a robot without a file an unknown estimator or detector (a metric that is none is
/// refused where the detector is built)
Thresholds read_thresholds(const std::string& path);

/// What training says of a detector behind an estimator, both by specification, as DetectorSettings
/// want it: by the name of the detector, or of those that it is made of. Nothing without sets, and
/// for a detector that has no thresholds to train.
/// @param velocity_noise [rad/s] of the sensors behind which it runs
/// @param condition of the study, for which a set may be alone; "" for none
/// @throws std::invalid_argument listing what was trained, if that pair was not on that robot
/// @throws std::runtime_error if the robot's file has changed since
DetectorThresholds trained_for(const Thresholds& thresholds, const Robot& robot,
                               double velocity_noise, const std::string& estimator,
                               const std::string& detector, const std::string& condition = "");

}  // namespace tauext

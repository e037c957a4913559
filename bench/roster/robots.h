// SPDX-License-Identifier: Apache-2.0
/// @file
/// The list of robots at run time.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "bench/roster/robot.h"
#include "mjcf/scenarios/scenario.h"

namespace tauext {

namespace detail {
// for bench/registry.h
using MakeRobot = std::function<std::unique_ptr<const Robot>()>;
void require_unused();
void add_robot(MakeRobot make);
}  // namespace detail

/// Every robot of bench/roster/roster.h, and the registered ones.
const std::vector<std::unique_ptr<const Robot>>& robots();

/// A robot by its name, also of kRobotsByMjcf, or FILE[:lock=REGEX], which then is its name: the
/// path of its MJCF or URDF file (.xml, .urdf) and the joints of it that are fixed, an arm of 1 to
/// 8 hinges and slides with the estimators, detectors and scenarios that every arm has. A file is
/// read once.
/// @param lock REGEX of a file's joints that are fixed; "" for none
/// @throws std::invalid_argument for an unknown name, listing the known ones, and for joints of a
/// robot from no file; std::runtime_error or std::invalid_argument naming the path and what is
/// wrong with it
const Robot& robot(std::string_view name, std::string_view lock = "");

/// wallmobot3 whose estimators believe in a panel of so many kg; 150 is what robot("wallmobot3")
/// believes.
std::unique_ptr<const Robot> wallmobot3_believing(double panel);

/// The instructions that estimators and detectors are compiled for (CMake's TAUEXT_ARCH), as -march
/// names them; "" for any processor.
std::string level();

/// Whether a detector stands in the studies alone (for_each_study_detector).
bool study_only(std::string_view detector);

/// A scenario of that robot.
/// @throws std::invalid_argument for an unknown name, listing the known ones
const Scenario& scenario_of(const Robot& robot, std::string_view name);

/// What --list prints: what all robots have that are known by name, or one, and by what one from a
/// file is scaled; and the keys of specifications.
/// @param robot,lock by which robot() finds it; "" for all
/// @throws std::invalid_argument as robot()
std::string list_known(const std::string& robot = "", const std::string& lock = "");

/// A line for each key that an estimator or a detector of any robot has, or of that one: unit,
/// limits, what larger does.
std::string list_fields(const Robot* of = nullptr);

}  // namespace tauext

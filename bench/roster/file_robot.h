// SPDX-License-Identifier: Apache-2.0
/// @file
/// A robot that nobody compiled in: estimators on the model of an MJCF file or text.
#pragma once

#include <memory>
#include <string>

#include "bench/roster/robot.h"

namespace tauext {

/// The estimators and detectors that every arm has, at 30 rad/s, on the dynamics of a file of 1 to
/// kMaxFileJoints hinges and slides (mjcf/plant/tree.h). Parameters of detectors in N m are those
/// of an arm that is used to 1200 N m (ArmScale::usual_torque), and less or more here, joint by
/// joint.
/// @param name FILE[:lock=REGEX], or that of a robot of ours
/// @throws std::runtime_error or std::invalid_argument naming the path and what is wrong
std::unique_ptr<const Robot> file_robot(const std::string& name);

}  // namespace tauext

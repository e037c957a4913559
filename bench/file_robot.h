// SPDX-License-Identifier: Apache-2.0
/// @file
/// A robot that nobody compiled in: estimators on the model of an MJCF file.
#pragma once

#include <string>

#include "bench/robot.h"

namespace tauext {

/// The most joints of such a robot.
inline constexpr int kMaxFileJoints = 7;

/// The estimators and detectors that every arm has, at 30 rad/s, on the dynamics of an MJCF file of
/// 1 to 7 hinges and slides (mjcf/arm_dynamics.h). MuJoCo costs some us for each estimator and
/// step.
/// @throws std::runtime_error or std::invalid_argument naming the path and what is wrong
Robot file_robot(const std::string& path);

}  // namespace tauext

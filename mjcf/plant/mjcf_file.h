// SPDX-License-Identifier: Apache-2.0
/// @file
/// MJCF files of users. MuJoCo crashes or hangs at some of them, and believes any number.
#pragma once

#include <string>

#include "mjcf/plant/confined.h"

namespace tauext {

/// From now on MuJoCo's errors are exceptions (std::runtime_error), and it says nothing itself.
void throw_mujoco_errors();

/// Compiles a file in a child process, which also refuses numbers that no machine has (those of
/// dynamics: bodies, joints, tendons, motors, sites, gravity) and tries one step.
/// @returns MuJoCo's binary form of it (MJB)
/// @throws std::runtime_error in one line, naming the path, the element and what is wrong
std::string compiled_mjcf(const std::string& path, const Limits& limits = {});

}  // namespace tauext

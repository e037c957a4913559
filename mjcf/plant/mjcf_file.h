// SPDX-License-Identifier: Apache-2.0
/// @file
/// MJCF files of users: MuJoCo crashes or hangs at some, and believes any number.
#pragma once

#include <string>

#include "mjcf/plant/confined.h"

namespace tauext {

/// From now on MuJoCo's errors are exceptions (std::runtime_error), and it says nothing itself.
void throw_mujoco_errors();

/// A file in MuJoCo's binary form (MJB), once a child process has compiled it, found its numbers
/// physical and taken a step.
/// @throws std::runtime_error naming the path and, in one line, the element and what is wrong
std::string compiled_mjcf(const std::string& path, const Limits& limits = {});

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// One number of joints of file_robot; each is compiled for itself, from file_robot_of.cc.in.
#pragma once

#include <string>

#include "bench/robot.h"
#include "mjcf/arm_dynamics.h"

namespace tauext {

template <int N>
Robot file_robot_of(const std::string& path, const Model& model);

}  // namespace tauext

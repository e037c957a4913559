// SPDX-License-Identifier: Apache-2.0
/// @file
/// The robot of a file's model. A program that links tauext_files has it; one without robots from
/// files brings its own.
#pragma once

#include <memory>
#include <string>

#include "bench/roster/robot.h"
#include "mjcf/plant/model.h"

namespace tauext::detail {

// of so many joints, which file_robot() has counted: 1 to kMaxFileJoints
std::unique_ptr<const Robot> tree_robot(int joints, const std::string& name, const Model& model);

}  // namespace tauext::detail

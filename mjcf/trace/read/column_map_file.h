// SPDX-License-Identifier: Apache-2.0
/// @file
/// Maps of columns by their names: presets, and files of TOML.
#pragma once

#include <string>
#include <string_view>

#include "mjcf/trace/read/column_map.h"

namespace tauext {

/// @param name a preset (presets.h), or the path of a TOML file (it ends in .toml)
/// @throws std::invalid_argument for an unknown preset, listing the known ones, and for a map that
/// is none, naming the path, the line and what is wrong; std::runtime_error for a file that cannot
/// be read, and where toml++ was missing at build, naming the package
ColumnMap column_map(const std::string& name);

/// The map of this text.
/// @param name of it, for what is thrown
/// @throws as column_map
ColumnMap column_map_of(std::string_view toml, const std::string& name);

/// The preset that reads messages of a type of ROS 2, like "sensor_msgs/JointState"; "": none.
std::string preset_of_messages(const std::string& type);

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Files that are read whole.
#pragma once

#include <string>

namespace tauext::gate {

/// All bytes of a file.
/// @throws std::runtime_error naming the path, if it cannot be read
std::string read_file(const std::string& path);

}  // namespace tauext::gate

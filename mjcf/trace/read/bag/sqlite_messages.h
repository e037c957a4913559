// SPDX-License-Identifier: Apache-2.0
/// @file
/// Bags of the storage sqlite3.
#pragma once

#include <memory>
#include <string>

#include "mjcf/trace/read/bag/bag_messages.h"

namespace tauext {

/// @throws std::runtime_error as BagRows does
std::unique_ptr<BagMessages> open_sqlite_bag(const std::string& path);

}  // namespace tauext

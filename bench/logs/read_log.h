// SPDX-License-Identifier: Apache-2.0
/// @file
/// A recorded log of either kind.
#pragma once

#include <string>

#include "mjcf/trace/trace.h"

namespace tauext {

/// A recorded log, CSV or LCM; what was skipped goes to standard error.
/// @param channel of an LCM log; "": the only one that holds measurements
/// @throws std::runtime_error naming the path and the reason
Trace read_log_or_csv(const std::string& path, const std::string& channel = "");

}  // namespace tauext

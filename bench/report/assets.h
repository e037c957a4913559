// SPDX-License-Identifier: Apache-2.0
/// @file
/// The files of page/, which are compiled in. Not installed.
#pragma once

#include <map>
#include <string>

namespace tauext::report {

/// What they hold, by their path in page/.
const std::map<std::string, std::string>& assets();

}  // namespace tauext::report

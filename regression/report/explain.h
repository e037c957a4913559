// SPDX-License-Identifier: Apache-2.0
/// @file
/// All that is known of one kernel or entry.
#pragma once

#include <string>

#include "regression/report/layers.h"

namespace tauext::gate {

/// Of a kernel <robot>/<name>: its time, its instructions and the functions that execute them,
/// beside base's if there is one. Of an entry <robot>/<scenario>/<estimator>: every metric and seed
/// beside the committed ones, and the command that scores it at one seed.
/// @throws std::invalid_argument if nothing has that name
std::string explain(const GateOptions& options, const std::string& subject);

}  // namespace tauext::gate

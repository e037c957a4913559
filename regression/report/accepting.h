// SPDX-License-Identifier: Apache-2.0
/// @file
/// Findings that are meant: how they are written down, and what they become.
#pragma once

#include <string>
#include <vector>

#include "regression/report/layers.h"

namespace tauext::gate {

/// Each finding that fails and has a size, as it would be accepted: a time by the upper end of its
/// interval and a tenth, all else by what it is. With a slower step also what its steps after other
/// work and its longer run say, which another run may find to fail. Not what is new or gone, nor a
/// step that waits.
std::vector<Acceptance> acceptable(const GateResult& result, const std::string& base,
                                   const std::string& reason);

/// Turns the findings that are covered into accepted ones. An acceptance for another base is stale,
/// which the result notes.
void accept(const std::vector<Acceptance>& all, const std::string& base, GateResult& result);

}  // namespace tauext::gate

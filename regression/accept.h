// SPDX-License-Identifier: Apache-2.0
/// @file
/// Findings that are meant: how they are written down, what they become, and what else moves then.
#pragma once

#include <string>
#include <vector>

#include "regression/report/layers.h"

namespace tauext::gate {

/// Each finding that fails and has a size, as it would be accepted: a time by the upper end of its
/// interval and a tenth, all else by what it is. With a slower step also what its longer run says,
/// which another run may find to fail. Not what is new or gone, nor a step that waits.
std::vector<Acceptance> acceptable(const GateResult& result, const std::string& base,
                                   const std::string& reason);

/// Turns the findings that are covered into accepted ones. An acceptance for another base is stale,
/// which the result notes.
void accept(const std::vector<Acceptance>& all, const std::string& base, GateResult& result);

/// Applies the acceptances of a folder of baselines to a result. With a reason all that fails and
/// has a size is accepted first, beside that base, and written there; what stands for another base
/// goes. The committed counts and metrics of the accepted findings are replaced by head's, so that
/// the next commit is judged by these.
/// @param options of the run that made the result
/// @param base the commit beside which findings are accepted
/// @param reason "" to accept nothing new
/// @throws std::invalid_argument for a reason of two lines; std::runtime_error as read_acceptances,
/// update_baselines and AtomicFile do
void accept_findings(const GateOptions& options, const std::string& base, const std::string& reason,
                     GateResult& result);

}  // namespace tauext::gate

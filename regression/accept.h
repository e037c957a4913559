// SPDX-License-Identifier: Apache-2.0
/// @file
/// Findings that were accepted, and those that now are.
#pragma once

#include <string>

#include "regression/report/layers.h"

namespace tauext::gate {

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

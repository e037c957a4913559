// SPDX-License-Identifier: Apache-2.0
/// @file
/// tauext-live --listen: any tauext stream, in a terminal.
#pragma once

#include "bench/live/options.h"

namespace tauext::live {

/// Shows what arrives until Ctrl-C or its time is over.
/// @return the exit code: 1 if nothing good was received
int run_listen(const Options& options);

}  // namespace tauext::live

// SPDX-License-Identifier: Apache-2.0
/// @file
/// tauext-live with estimators: playing what was recorded, or on what a robot sends.
#pragma once

#include "bench/live/options.h"

namespace tauext::live {

/// Each runs until its end or Ctrl-C, prints a summary, and returns the exit code: 1 if a stream
/// was asked for and nothing could be sent, or if nothing good was received.
int run_recorded(const Options& options);
int run_subscribed(const Options& options);

}  // namespace tauext::live

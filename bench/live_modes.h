// SPDX-License-Identifier: Apache-2.0
/// @file
/// What tauext-live can do: play, subscribe, listen.
#pragma once

#include <string>
#include <vector>

#include "bench/live.h"
#include "mjcf/model_error.h"
#include "mjcf/record.h"

namespace tauext {

/// What the command line says.
struct LiveOptions {
  std::string robot, scenario, from, channel, subscribe, type = "tauext";
  std::vector<std::string> estimators;
  std::string detector, thresholds;
  bool stream = false;  ///< publish
  std::string url;      ///< "": the default
  double rate = 200;    ///< [1/s] messages of each channel; 0: every sample
  Pace pace;
  Sensors sensors;
  ModelError model_error;
  Recording recording;
};

/// @throws std::invalid_argument for options that are missing, out of range or do not go together
void check(const LiveOptions& options, bool listen);

/// Each runs until its end or Ctrl-C, prints a summary, and returns the exit code: 1 if a stream
/// was asked for and nothing could be sent, or if nothing good was received.
int run_recorded(const LiveOptions& options);
int run_subscribed(const LiveOptions& options);
int run_listen(const LiveOptions& options);

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// What tauext-live's command line says.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/live/live.h"
#include "mjcf/plant/model_error.h"
#include "mjcf/record.h"

namespace tauext::live {

/// What the command line says.
struct Options {
  std::string robot, lock, scenario, from, channel, columns, subscribe, type = "tauext";
  std::vector<std::string> estimators;
  std::string detector, thresholds;
  std::string wrench;       ///< the point at which forces are looked for; "": none
  bool stream = false;      ///< publish
  std::string url;          ///< "": the default
  std::optional<int> page;  ///< port of the live page; 0: any
  std::string plotjuggler;  ///< HOST:PORT; "": none
  double rate = 200;        ///< [1/s] messages of each channel; 0: every sample
  Pace pace;
  std::optional<int> realtime;  ///< [1] priority of the loop; none: an ordinary thread
  Sensors sensors;
  ModelError model_error;
  Recording recording;
};

/// @throws std::invalid_argument for options that are missing, out of range or do not go together
void check(const Options& options, bool listen);

}  // namespace tauext::live

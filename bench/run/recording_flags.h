// SPDX-License-Identifier: Apache-2.0
/// @file
/// Flags of the programs that simulate: how the plant is run, and what its sensors are like.
#pragma once

#include <vector>

#include "mjcf/plant/model_error.h"
#include "mjcf/record.h"
#include "mjcf/trace/sensors.h"

namespace CLI {
class App;
}

namespace tauext {

/// The flags that add_recording_flags() adds, for programs that also read logs, to which they do
/// not apply.
const std::vector<const char*>& recording_flags();

/// Adds the flags of the sensors' faults, the model's errors, a file of both, --seed, --kp and
/// --kd.
void add_recording_flags(CLI::App& app, Sensors& sensors, ModelError& error, Recording& recording);

}  // namespace tauext

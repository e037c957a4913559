// SPDX-License-Identifier: Apache-2.0
/// @file
/// Everything that can stand between an estimator's model and what it gets to see: faults of the
/// sensors and errors of the model, by name, in any combination.
#pragma once

#include <string>
#include <vector>

#include "mjcf/plant/model_error.h"
#include "mjcf/simulation/recording.h"
#include "mjcf/trace/sensors.h"

namespace tauext {

/// A combination of them; the default is none.
struct Degradation {
  Sensors sensors;         ///< what they make of the truth
  ModelError model_error;  ///< what the estimators do not know
  Drives drives;           ///< springs and friction of the joints, of which nobody knows
};

/// A combination that has a name: joints as people have measured them, in shares of what a joint is
/// used to. bench/study/detection/README.md has the sources.
struct NamedDegradation {
  std::string name, description;  ///< a word, and a line
  Degradation degradation;        ///< what is wrong
};

/// light, typical and hard.
const std::vector<NamedDegradation>& named_degradations();

/// Sets what a JSON file names and leaves the rest; or, if `path` is the name of one of
/// named_degradations(), all but the seed to that:
///     { "velocity_noise": 1e-3, "dropped": 0.01, "loadcell": { "hysteresis": 0.002 },
///       "torque": { "gain": 0.05 }, "model_error": { "mass": 1.05, "friction": 2 },
///       "drives": { "stiffness": 300, "coulomb": 0.01 } }
/// The keys are the fields of Sensors, Loadcell, TorqueFaults, ModelError and Drives, in their
/// units.
/// @throws std::runtime_error naming the file and what is wrong: unreadable, not JSON, an unknown
/// key or a value out of range (listing the known ones with their limits), a value that is no
/// number
void read_degradation(const std::string& path, Degradation& d);

/// The same from the text of such a file.
/// @throws std::invalid_argument or std::runtime_error for what is wrong in it
void set_degradation(const std::string& json, Degradation& d);

/// Sets fields from "key=number" items: of Sensors, of a Loadcell, of a ModelError.
/// @throws std::invalid_argument naming the key and the known ones with their units and limits
void set_fields(const std::vector<std::string>& items, Sensors& s);
/// As those of Sensors.
void set_fields(const std::vector<std::string>& items, Loadcell& l);
/// As those of Sensors.
void set_fields(const std::vector<std::string>& items, ModelError& e);
/// As those of Sensors.
void set_fields(const std::vector<std::string>& items, Drives& d);

/// What is not ideal, like "velocity_noise=0.001 model_error.mass=1.05"; "" if all is.
std::string describe(const Degradation& d);

}  // namespace tauext

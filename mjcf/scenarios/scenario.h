// SPDX-License-Identifier: Apache-2.0
/// @file
/// The scenarios of each robot, by name.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mjcf/plant/model.h"
#include "mjcf/plant/model_error.h"
#include "mjcf/scenarios/scenario_type.h"

namespace tauext {

/// All scenarios of a robot, in the order in which they are listed; the generic ones
/// (mjcf/scenarios/generic.h) of a robot for which nobody wrote or registered any.
/// @throws std::invalid_argument for an unknown robot, listing the known ones; and if scenarios
/// were registered for a robot that does not exist
const std::vector<Scenario>& scenarios(std::string_view robot);

/// The scenario of that name.
/// @throws std::invalid_argument for an unknown name, listing the known ones
const Scenario& scenario(std::string_view robot, std::string_view name);

/// Adds a scenario to a robot's list; before a list is first asked for, else std::logic_error. The
/// robot may be registered later; one that does not exist then is refused when the lists are first
/// asked for.
/// @throws std::invalid_argument if the name is empty or taken
void register_scenario(const std::string& robot, const Scenario& scenario);

/// The sensors that were asked for, or, if these are ideal, the scenario's with their seed.
Sensors sensors_for(const Scenario& scenario, const Sensors& asked);
/// The error that was asked for, or, if it is none, the scenario's.
ModelError error_for(const Scenario& scenario, const ModelError& asked);

/// The robot as the scenario needs it: with its scene, and the load as heavy as it says; and with
/// errors that its estimators do not know of.
/// @throws std::invalid_argument for an error out of range
Model load_for(std::string_view robot, const Scenario& scenario, const ModelError& error = {});

}  // namespace tauext

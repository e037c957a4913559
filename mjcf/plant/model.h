// SPDX-License-Identifier: Apache-2.0
/// @file
/// Loading MuJoCo models, with every failure an exception that says what and where.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "mjcf/import/mjcf_text.h"
#include "mjcf/mujoco/handles.h"

namespace tauext {

/// The names of the robots that come with tauext, sorted; then the registered ones.
std::vector<std::string> robot_names();

/// One of these robots. Its MJCF is built into the library, so no file has to be found.
/// @param scene what stands around it: "" for nothing, "load" (a mass on a tether) or "obstacle"
/// @throws std::invalid_argument for an unknown robot or scene, listing the known ones
Model load_robot(std::string_view name, std::string_view scene = "");

/// A robot of your own: an MJCF file, laid out as mjcf/mujoco/layout.h says, or as people have it
/// (mjcf/import/). It is compiled and tried in a child process with limits.
/// @param changes becomes what the import changed and left out, in one line; "" if nothing
/// @throws std::runtime_error naming the path, with MuJoCo's own message, what crashed, or the
/// element whose numbers are not physical
Model load_mjcf(const std::string& path, const ImportOptions& options = {},
                std::string* changes = nullptr);

/// From now on load_robot(name) gives the robot of this MJCF file; it stands in no scene.
/// @throws std::invalid_argument if the name is taken; std::runtime_error as load_mjcf does
void register_mjcf(const std::string& name, const std::string& path);

/// A copy of the model with the changes that `change` makes, and what MuJoCo derives from them.
Model changed(const Model& model, const std::function<void(mjModel&)>& change);

/// A copy of the model whose body has `factor` times its mass and its inertia.
/// @throws std::invalid_argument for an unknown body or a factor that is not positive and finite
Model with_scaled_body(const Model& model, const std::string& body, double factor);

/// A copy of the model without dry friction.
Model without_dry_friction(const Model& model);

/// wallmobot3 with another panel [kg] than the 150 kg of Table II: link 5 weighs 27 kg + panel and
/// its inertia scales with its mass, as WallMoBot3::Parameters::with_panel has it.
Model wallmobot3_with_panel(double panel);

}  // namespace tauext

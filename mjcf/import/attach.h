// SPDX-License-Identifier: Apache-2.0
/// @file
/// MJCF's <attach>: another model within this one.
#pragma once

#include <functional>
#include <string>

#include "mjcf/import/xml.h"

namespace tauext::detail {

/// A file of MJCF, with all that it includes, and the folder that its meshes are in.
struct AttachedModel {
  tinyxml2::XMLDocument doc;
  std::string folder;
};

/// Puts into the place of each <attach> the bodies that it stands for, with all that belongs to
/// them: defaults, meshes, equalities, tendons, actuators. The model's options do not count, as in
/// MuJoCo.
/// @param load reads the file of an <asset><model>, in which nothing is attached any more
/// @throws std::runtime_error for models whose <compiler> reads numbers in another way than that
/// of the file, for defaults that both would have, and as `load` does
void attach_models(XMLElement& mujoco,
                   const std::function<void(const std::string& file, AttachedModel& model)>& load);

}  // namespace tauext::detail

// SPDX-License-Identifier: Apache-2.0
/// @file
/// URDF as MJCF.
#pragma once

#include <map>
#include <string>

namespace tinyxml2 {
class XMLDocument;
class XMLElement;
}  // namespace tinyxml2

namespace tauext::detail {

/// Links, masses and joints with their limits, damping and friction; a mimic joint is an equality.
/// Shapes are left out, with all that is for drawing and for other programs. The root link stands.
/// @throws std::runtime_error naming line, link or joint, and what is wrong with it
void urdf_to_mjcf(const tinyxml2::XMLElement& robot, tinyxml2::XMLDocument& mjcf,
                  std::map<std::string, int>& dropped);

}  // namespace tauext::detail

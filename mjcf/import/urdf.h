// SPDX-License-Identifier: Apache-2.0
/// @file
/// URDF as MJCF.
#pragma once

#include <map>
#include <string>

#include "mjcf/import/measured_terms.h"

namespace tinyxml2 {
class XMLDocument;
class XMLElement;
}  // namespace tinyxml2

namespace tauext::detail {

/// How it is read, and what is counted on the way; as in ImportOptions and ImportedText.
struct UrdfReading {
  const std::string& lock;
  bool balance, masses_unknown;
  const std::map<std::string, MeasuredBody>& bodies;  ///< whose masses the caller puts in
  std::map<std::string, int>&dropped, &changed;
};

/// Links, masses and joints with their limits, damping and friction; a mimic joint is an equality.
/// Links that are fixed to each other are one mass, and only their sum has to be that of a body;
/// what misses that by few digits is mended, or by more, if `balance` says so. Shapes are
/// left out, with all that is for drawing and for other programs. The root link stands. A link
/// whose mass the caller puts in, or that may have none, has no <inertial> here.
/// @throws std::runtime_error naming each line, link or joint, and what is wrong with it
void urdf_to_mjcf(const tinyxml2::XMLElement& robot, tinyxml2::XMLDocument& mjcf,
                  const UrdfReading& how);

}  // namespace tauext::detail

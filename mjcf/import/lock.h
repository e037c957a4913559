// SPDX-License-Identifier: Apache-2.0
/// @file
/// Joints of an arm that are fixed, and what was tied to them.
#pragma once

#include <map>
#include <string>

namespace tinyxml2 {
class XMLElement;
}

namespace tauext::detail {

/// Whether the whole name of a joint matches; none does if the expression is empty.
/// @throws std::runtime_error for one that is none
bool is_locked(const std::string& joint, const std::string& regex);

/// Names the joints that have no name: a free one, which is a robot's base, as its body or "base";
/// another one "joint3" if it is the third of these.
void name_joints(tinyxml2::XMLElement& mujoco);

/// Takes the joints away whose whole name matches, so that their bodies stand as at 0; then
/// the free joint of a body that floats alone beside an arm, like an object to grasp, which stands;
/// and equalities and tendons that have nothing left to tie.
/// @param regex ECMAScript's; none if it is empty
/// @throws std::runtime_error if it is no regular expression or matches no joint, listing them;
/// Mendable for a joint that an equality ties to one that is locked
void lock_joints(tinyxml2::XMLElement& mujoco, const std::string& regex,
                 std::map<std::string, int>& dropped, std::map<std::string, int>& changed);

}  // namespace tauext::detail

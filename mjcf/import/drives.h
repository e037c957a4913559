// SPDX-License-Identifier: Apache-2.0
/// @file
/// What the actuators of an MJCF file say of its joints, beside the forces that they are asked for.
#pragma once

#include <map>
#include <string>

namespace tinyxml2 {
class XMLElement;
}

namespace tauext::detail {

/// Puts what drives can do (put_rated) beside each joint that has an `actuatorfrcrange`, or else an
/// actuator with a `forcerange`, or else a motor with a `ctrlrange`, by itself or by its class.
void keep_rated(tinyxml2::XMLElement& mujoco);

/// Adds the `armature` and the `damping` that actuators have of their own (MuJoCo 4) to those of
/// their joints, times the gear squared, and says so in `changed`.
/// @param lock the joints whose dynamics do not count, as in lock_joints
/// @throws Mendable naming every actuator whose dynamics no joint can have: on tendons, with powers
/// of the speed, with friction or cogging of its own, or with a force that nobody asks for
void keep_drive_dynamics(tinyxml2::XMLElement& mujoco, const std::string& lock,
                         std::map<std::string, int>& changed);

}  // namespace tauext::detail

// SPDX-License-Identifier: Apache-2.0
/// @file
/// A sensor_msgs/msg/JointState of ROS 2 as it is serialized: CDR, that is OMG's Common Data
/// Representation, version 1, of either byte order.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tauext {

/// How many joints a message may name.
inline constexpr std::size_t kMostJoints = 64;

/// Such a message. The names alone say which joint a number belongs to.
struct JointState {
  double stamp = 0;               ///< [s] of its header
  std::vector<std::string> name;  ///< of the joints, each once
  /// [rad], [rad/s] and [N m], with the sign that the driver gives them; as many as names, or none
  std::vector<double> position, velocity, effort;
};

/// Reads one; bytes behind its end do not matter.
/// @returns nullptr, or in words why it cannot be read, when `state` holds anything
const char* read_joint_state(std::string_view bytes, JointState& state);

}  // namespace tauext

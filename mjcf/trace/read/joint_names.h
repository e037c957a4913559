// SPDX-License-Identifier: Apache-2.0
/// @file
/// Which names in a recording are those of the robot's joints.
#pragma once

#include <set>
#include <string>
#include <vector>

namespace tauext {

/// What a recording calls the joints of the robot.
struct JointNames {
  std::vector<std::string>
      called;       ///< each of them, in the robot's order; "": it has no name there
  std::string how;  ///< by which rule, "have the prefix 'left_'"; "": by the robot's own names

  bool all() const;  ///< whether each has a name
  bool any() const;  ///< whether one has
};

/// Finds the robot's joints by their own names, by these with one text before and one behind all of
/// them, or without a prefix that the robot puts before all. Names are whole words. If not all are
/// there, it finds as many as one such text before and behind finds.
/// @param whose names these are, like "the messages on topic /arm", for the error
/// @throws std::runtime_error if there are two ways to find all of them
JointNames find_joint_names(const std::set<std::string>& names,
                            const std::vector<std::string>& joints, const std::string& whose);

/// @throws std::runtime_error with both lists and the remedy
/// @param missing joints of the robot
[[noreturn]] void fail_missing_joints(const std::vector<std::string>& missing,
                                      const std::vector<std::string>& joints,
                                      const std::set<std::string>& names, const std::string& whose);

/// Names for a message to people, as many as a line holds.
std::string listed_names(const std::vector<std::string>& names);

}  // namespace tauext

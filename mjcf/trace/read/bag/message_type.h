// SPDX-License-Identifier: Apache-2.0
/// @file
/// A type of ROS 2's messages, by its definition, and the numbers of such a message as it is
/// serialized: CDR, that is OMG's Common Data Representation, version 1, of either byte order.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace tauext {

/// How many joints a message may name.
inline constexpr std::size_t kMostJoints = 64;

/// "sensor_msgs/JointState" of "sensor_msgs/msg/JointState", as definitions have it.
std::string short_type_name(std::string_view type);

/// Numbers that have a name in a message, one or several.
struct MessageField {
  /// "effort", "arm.q" or, of each element of an array of structures, "motor" and ".q".
  std::string begin, end;
  bool many = false;  ///< there may be several: number i is called "motor[i].q"
  int names = -1;     ///< which list of names says whose number each is; -1: none
};

/// What a message holds. It is kept from one to the next, to save its memory.
struct MessageNumbers {
  std::vector<std::vector<std::string>> names;  ///< of joints, in each list that the type has
  std::vector<std::vector<double>> numbers;  ///< of each field; those of names are as many, or none
};

/// A type of messages.
///
/// Lists of joints' names are `name` of a sensor_msgs/JointState, and `joint_names`. They say whose
/// the numbers are in the arrays beside them and in the structures beside them. Arrays in arrays,
/// and arrays of more than 256 numbers, are no fields.
class RosType {
 public:
  /// @param name of it, like "sensor_msgs/msg/JointState", whose definition is known
  /// @param definition the text of its .msg, and behind it that of each type that it needs, each
  /// below a line "MSG: package/Type"
  /// @throws std::runtime_error naming the type and what is wrong with its definition
  explicit RosType(const std::string& name, std::string_view definition = "");
  ~RosType();

  /// Whether a definition is needed.
  static bool is_joint_state(std::string_view name);

  const std::vector<MessageField>& fields() const { return fields_; }
  std::size_t lists() const { return lists_; }  ///< of joints' names

  /// Reads one.
  /// @returns nullptr, or in words why it cannot be read, when `to` holds anything
  const char* read(std::string_view bytes, MessageNumbers& to) const;

 private:
  friend class MessageCompiler;
  struct Node;

  std::unique_ptr<Node> root_;
  std::vector<MessageField> fields_;
  std::size_t lists_ = 0;
  bool exact_ = true;  // nothing may stand behind a message
};

}  // namespace tauext

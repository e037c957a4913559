// SPDX-License-Identifier: Apache-2.0
/// @file
/// Types of messages, and the numbers of a message. Those of ROS 2 are known by their definition,
/// and serialized as CDR: OMG's Common Data Representation, version 1, of either byte order.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace tauext {

/// How many joints a message may name.
inline constexpr std::size_t kMostJoints = 64;
/// How many numbers an array may have that is a field.
inline constexpr std::size_t kMostOfField = 256;

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

/// A type of messages, however they are written.
class BagMessageType {
 public:
  virtual ~BagMessageType() = default;

  const std::vector<MessageField>& fields() const { return fields_; }
  std::size_t lists() const { return lists_; }  ///< of joints' names
  /// Whether messages alone tell what fields there are: read() finds more of them.
  virtual bool learns() const { return false; }

  /// Reads one.
  /// @returns nullptr, or in words why it cannot be read, when `to` holds anything
  virtual const char* read(std::string_view bytes, MessageNumbers& to) = 0;

 protected:
  /// Makes room for the numbers of a message, of which there are none yet.
  void clear(MessageNumbers& to) const;
  /// Whether lists and the numbers of names are as long as each other, once all are there.
  const char* objection_to(const MessageNumbers& numbers) const;

  std::vector<MessageField> fields_;
  std::size_t lists_ = 0;
};

/// A type of ROS 2.
///
/// Lists of joints' names are `name` of a sensor_msgs/JointState, and `joint_names`. They say whose
/// the numbers are in the arrays beside them and in the structures beside them. Arrays in arrays,
/// and arrays of more than 256 numbers, are no fields.
class RosType final : public BagMessageType {
 public:
  /// @param name of it, like "sensor_msgs/msg/JointState", whose definition is known
  /// @param definition the text of its .msg, and behind it that of each type that it needs, each
  /// below a line "MSG: package/Type"
  /// @throws std::runtime_error naming the type and what is wrong with its definition
  explicit RosType(const std::string& name, std::string_view definition = "");
  ~RosType() override;

  /// Whether a definition is needed.
  static bool is_joint_state(std::string_view name);

  const char* read(std::string_view bytes, MessageNumbers& to) override;

 private:
  friend class MessageCompiler;
  struct Node;

  std::unique_ptr<Node> root_;
  bool exact_ = true;  // nothing may stand behind a message
};

}  // namespace tauext

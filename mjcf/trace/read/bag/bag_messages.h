// SPDX-License-Identifier: Apache-2.0
/// @file
/// The messages of some topics in a bag, in the order in which they were recorded.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tauext {

/// The types of our own messages, in JSON: bench/logs/mcap_samples.h writes them.
inline constexpr std::string_view kMeasuredType = "tauext.Measured", kTruthType = "tauext.Truth";

/// A message as it lies in the bag, until the next one is read.
struct BagMessage {
  double received = 0;       ///< [s] when it was recorded
  std::string_view bytes;    ///< "" if there are too many
  std::int64_t size = 0;     ///< [bytes] even so
  std::int64_t channel = 0;  ///< by which those of several topics differ
};

/// A topic of a bag.
struct BagTopic {
  std::string name, type, format;  ///< of its messages the type, and how they are serialized
  std::string language = "",
              definition = "";  ///< of the type, where the bag has it: "ros2msg", or IDL
};

/// Those of some topics, which choose() or take() says first: of one type or, in JSON, of any.
class BagMessages {
 public:
  /// How long a message may be, and a definition.
  static constexpr std::int64_t kMost = 1 << 20;  // [bytes]

  virtual ~BagMessages() = default;

  /// All that there are, without the definitions of their types.
  const std::vector<BagTopic>& topics() const { return topics_; }
  /// Chooses some of them. "": the only one of sensor_msgs/msg/JointState or, where there is none,
  /// of the types that presets.h knows, and with our own /measured its /truth; else names apart by
  /// commas, of topics of one type.
  /// @throws std::runtime_error naming the path, and the topics that there are
  void choose(const std::string& path, const std::string& wanted);
  void take(const BagTopic& topic);
  const std::string& path() const { return path_; }  ///< of choose()
  /// Of several the names apart by commas, and the type of the first.
  const BagTopic& topic() const { return topic_; }

  /// @returns false at the end
  /// @throws std::runtime_error naming the path, where the file is damaged
  virtual bool next(BagMessage& message) = 0;
  /// The first one is the next again.
  virtual void rewind() = 0;
  /// At the end what a reader should know; else "".
  virtual std::string note() const { return ""; }

 protected:
  /// Those that are not there yet.
  void add_topics(const std::vector<BagTopic>& topics);
  /// Goes to the first message of topic(), and says the definition of its type.
  virtual void select() = 0;
  /// Whether topic() is this one, or this one among others.
  bool is_chosen(const BagTopic& topic) const;
  void set_definition(const std::string& language, const std::string& definition);

 private:
  std::string path_;
  std::vector<BagTopic> topics_;
  BagTopic topic_;
};

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// The messages of some topics in a bag, in the order in which they were recorded.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tauext {

/// A message as it lies in the bag, until the next one is read.
struct BagMessage {
  double received = 0;     ///< [s] when it was recorded
  std::string_view bytes;  ///< "" if there are too many
  std::int64_t size = 0;   ///< [bytes] even so
};

/// A topic of a bag.
struct BagTopic {
  std::string name, type, format;  ///< of its messages the type, and how they are serialized
};

/// Those of topics of sensor_msgs/msg/JointState.
class BagMessages {
 public:
  /// How long a message may be.
  static constexpr std::int64_t kMost = 1 << 20;  // [bytes]

  virtual ~BagMessages() = default;

  /// @returns false at the end
  /// @throws std::runtime_error naming the path, where the file is damaged
  virtual bool next(BagMessage& message) = 0;
  /// The first one is the next again.
  virtual void rewind() = 0;
  /// At the end what a reader should know; else "".
  virtual std::string note() const { return ""; }
  const std::string& path() const { return path_; }
  /// Their names, apart by commas.
  const std::string& topic() const { return topic_; }

 protected:
  /// Chooses them among these. "": the only one of that type; else names apart by commas.
  /// @throws std::runtime_error naming the path, and the topics that there are
  void set_topics(const std::string& path, const std::vector<BagTopic>& topics,
                  const std::string& wanted);
  bool is_chosen(std::string_view topic) const;

 private:
  std::string path_, topic_;
};

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// The messages of one topic in a bag of the storage sqlite3, in the order in which they were
/// recorded.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace tauext {

/// A message as it lies in the bag, until the next one is read.
struct BagMessage {
  double received = 0;     ///< [s] when it was recorded
  std::string_view bytes;  ///< "" if there are too many
  std::int64_t size = 0;   ///< [bytes] even so
};

/// Those of a topic of sensor_msgs/msg/JointState.
class BagMessages {
 public:
  /// How long a message may be.
  static constexpr std::int64_t kMost = 1 << 20;  // [bytes]

  /// @param topic "": the only one of that type
  /// @throws std::runtime_error as BagRows does
  BagMessages(const std::string& path, const std::string& topic);
  ~BagMessages();

  /// @returns false at the end
  /// @throws std::runtime_error naming the path, where the file is damaged
  bool next(BagMessage& message);
  /// The first one is the next again.
  void rewind();
  const std::string& path() const { return path_; }
  const std::string& topic() const { return topic_; }

 private:
  struct Database;
  std::string path_, topic_;
  std::unique_ptr<Database> database_;
};

}  // namespace tauext

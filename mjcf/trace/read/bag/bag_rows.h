// SPDX-License-Identifier: Apache-2.0
/// @file
/// Recordings of ROS 2: bags of the storages sqlite3 and mcap, that is .db3 and .mcap files.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "mjcf/trace/read/row_source.h"

namespace tauext {

class BagMessages;
struct JointState;

/// The messages of a topic of sensor_msgs/msg/JointState in a bag, each a row.
///
/// The first column is "t" [s], the stamp of the header or, where that is 0 throughout, the time at
/// which the message was recorded. Then follow "position.NAME" [rad], "velocity.NAME" [rad/s] and
/// "effort.NAME" [N m], of each joint of the robot in its order or, where nobody says what these
/// are, of each that the first good message names and in its order. Where the messages have the
/// robot's names with one text before all of them, or without one that the robot's begin with,
/// these are its joints; a note says so. Messages may have another order; what one does not have is
/// NaN, and a quantity that none has of these joints has no columns. A message without any of these
/// joints is no row; where messages name other joints, a note names them once, at the end.
///
/// The file is not believed: it is opened to be read alone, nothing is written beside it, a message
/// may have 1 MB and 64 joints. Messages that are longer, cut off, or no CDR are skipped, and are
/// counted in SkippedRows::wrong_field_count.
class BagRows : public RowSource {
 public:
  /// @param topic "": the only one of that type
  /// @param joints the robot's, by name; empty: unknown
  /// @throws std::runtime_error naming the path and what is wrong: unreadable, no such bag, no such
  /// topic, several to choose from, no good message, a joint of the robot that no message names; or
  /// that SQLite was missing at build
  explicit BagRows(const std::string& path, const std::string& topic = "",
                   std::vector<std::string> joints = {});
  ~BagRows() override;

  const std::vector<std::string>& columns() const override { return columns_; }
  /// @throws std::runtime_error naming the path, where the file is damaged
  bool next(std::vector<double>& row, SkippedRows& skipped) override;
  /// Which message of the topic it was.
  long number() const override { return number_; }

 private:
  void look_ahead();
  void look_for_quantities();
  bool find_by_prefix(const std::set<std::string>& named);
  [[noreturn]] void fail_missing(const std::vector<std::string>& missing,
                                 const std::set<std::string>& named) const;
  bool fill(std::vector<double>& row, const JointState& state);
  void note_strangers(SkippedRows& skipped);

  std::unique_ptr<BagMessages> messages_;
  std::vector<std::string> joints_, columns_;
  std::vector<std::string> called_;  // these joints, in the messages
  std::string note_;                 // of how they were found
  std::array<bool, 3> has_{};        // position, velocity and effort of these joints
  bool use_stamps_ = false;
  long number_ = 0, with_strangers_ = 0;
  std::set<std::string> strangers_;  // joints that are not ours, the first few
};

}  // namespace tauext

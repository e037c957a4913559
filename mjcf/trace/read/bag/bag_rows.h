// SPDX-License-Identifier: Apache-2.0
/// @file
/// Recordings of ROS 2: bags of the storages sqlite3 and mcap, that is .db3 and .mcap files,
/// folders of them, and both of them compressed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "mjcf/trace/read/bag/message_type.h"
#include "mjcf/trace/read/row_source.h"

namespace tauext {

class BagMessages;
struct BagTopic;

/// The topic that BagRows would read.
/// @throws std::runtime_error as BagRows does
BagTopic topic_of_bag(const std::string& path, const std::string& topic);

/// The messages of a topic in a bag, each a row.
///
/// The first column is "t" [s], the stamp of the header or, where there is none or it is 0
/// throughout, the time at which the message was recorded. Then follow the numbers of the message
/// by their paths in it: "tau", "wrench.force.x"; of an array "q[0]", "q[1]", "motor[0].q". Arrays
/// that names of joints stand beside (RosType) have these in the place of numbers:
/// "effort.NAME", of each joint of the robot in its order or, where nobody says what these are, of
/// each that the first good message names and in its order. So a sensor_msgs/msg/JointState is
/// "position.NAME" [rad], "velocity.NAME" [rad/s] and "effort.NAME" [N m]. Where the messages have
/// the robot's names with other text around them (joint_names.h), these are its joints; a note says
/// so. Messages may have another order; what one does not have is NaN, and a field of which none
/// has a number has no columns. A message that names joints, and none of these, is no row; where
/// messages name other joints, a note names them once, at the end.
///
/// Types other than JointState are read where the bag has their definition, as bags of ROS 2 Iron
/// and later do, and all of mcap. Messages that are written as JSON (JsonType) need none. Those of
/// several topics at one time are one row, unless they contradict each other.
///
/// The file is not believed: it is opened to be read alone, nothing is written beside it, a message
/// may have 1 MB and 64 joints. Messages that are longer, cut off, or no CDR are skipped, and are
/// counted in SkippedRows::wrong_field_count.
class BagRows : public RowSource {
 public:
  /// @param topic "": the only one of JointState or, where there is none, of a type that one of
  /// the presets reads
  /// @param joints the robot's, by name; empty: unknown
  /// @throws std::runtime_error naming the path and what is wrong: unreadable, no such bag, no such
  /// topic, several to choose from, no definition of its type, no good message, a joint of the
  /// robot that no message names; or that SQLite was missing at build
  explicit BagRows(const std::string& path, const std::string& topic = "",
                   std::vector<std::string> joints = {});
  ~BagRows() override;

  const std::vector<std::string>& columns() const override { return columns_; }
  /// @throws std::runtime_error naming the path, where the file is damaged
  bool next(std::vector<double>& row, SkippedRows& skipped) override;
  /// Which message of the topic it was.
  long number() const override { return number_; }
  std::string_view unit() const override { return "message"; }

 private:
  void read_type();
  void note_fields();
  void count_numbers(const MessageNumbers& message);
  void look_ahead();
  void look_for_numbers();
  void name_columns();
  void find_by_other_names(const std::vector<std::string>& missing,
                           const std::set<std::string>& named);
  bool find_joints(const MessageNumbers& message);
  bool is_stamp(std::size_t field) const;
  double stamp_of(const MessageNumbers& message) const;
  void fill(std::vector<double>& row, const MessageNumbers& message) const;
  bool next_message(std::vector<double>& row, SkippedRows& skipped);
  bool take_into(std::vector<double>& row) const;
  std::string note_of_end() const;
  void note_strangers(SkippedRows& skipped);

  std::unique_ptr<BagMessages> messages_;
  std::unique_ptr<BagMessageType> type_;
  int seconds_ = -1, nanoseconds_ = -1;  // the fields of the header's stamp
  std::vector<std::string> joints_, columns_;
  std::vector<std::string> called_;  // these joints, in the messages
  std::string note_;                 // of how they were found
  // of each field: how many numbers of ours there are, and where its columns begin
  std::vector<std::size_t> counts_, begins_;
  std::vector<std::vector<int>> at_;  // of each list of names the joints, or -1
  bool use_stamps_ = false;
  long number_ = 0, read_ = 0, with_strangers_ = 0;
  double last_ = 0;           // [s] of the message that was read last
  MessageNumbers numbers_;    // of the message that was read last
  std::int64_t channel_ = 0;  // likewise
  // of several topics of JSON: its row, which the next ones may add to
  std::vector<double> ahead_;
  bool joins_ = false, ended_ = false, noted_ = false;
  std::set<std::string> strangers_;  // joints that are not ours, the first few
};

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/bag/bag_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>

#include "mjcf/trace/printable.h"
#include "mjcf/trace/read/bag/bag_messages.h"
#include "mjcf/trace/read/bag/json_type.h"
#include "mjcf/trace/read/bag/parts.h"
#include "mjcf/trace/read/joint_names.h"

namespace tauext {
namespace {

constexpr std::size_t kMostColumns = 4096;

// nullptr, or why not
const char* read_message(BagMessageType& type, const BagMessage& message, MessageNumbers& to) {
  if (message.size > BagMessages::kMost) return "it is longer than 1 MB";
  return type.read(message.bytes, to);
}

// for messages to people
void keep_some(std::set<std::string>& names, const std::string& name) {
  if (names.size() < kMostJoints) names.insert(name);
}

}  // namespace

BagTopic topic_of_bag(const std::string& path, const std::string& topic) {
  return open_bag(path, topic)->topic();
}

BagRows::BagRows(const std::string& path, const std::string& topic, std::vector<std::string> joints)
    : messages_(open_bag(path, topic)), joints_(std::move(joints)) {
  read_type();
  look_ahead();
  look_for_numbers();
  name_columns();
}

BagRows::~BagRows() = default;

void BagRows::read_type() {
  const BagTopic& t = messages_->topic();
  const auto fail = [&](const std::string& why) {
    throw std::runtime_error(
        one_line(fmt::format("{}: topic {}, {}: {}", messages_->path(), printable_name(t.name),
                             printable_name(t.type), why)));
  };
  if (t.format == "json") {
    type_ = std::make_unique<JsonType>();
    joins_ = t.name.find(',') != std::string::npos;
    return;
  }
  if (!RosType::is_joint_state(t.type)) {
    if (t.definition.empty())
      fail(
          "the bag has no definition of its type, as those of ROS 2 Iron and later have: where "
          "its package is installed, ros2 bag convert to the storage mcap adds it");
    if (t.language != "ros2msg")
      fail(fmt::format("its type is defined in '{}', and not in 'ros2msg'",
                       printable_name(t.language)));
  }
  try {
    type_ = std::make_unique<RosType>(t.type, t.definition);
  } catch (const std::runtime_error& e) {
    fail(e.what());
  }
  note_fields();
}

// those that are known by now
void BagRows::note_fields() {
  for (std::size_t i = counts_.size(); i < type_->fields().size(); ++i) {
    if (type_->fields()[i].many) continue;
    const std::string& name = type_->fields()[i].begin;
    if (name == "header.stamp.sec") seconds_ = static_cast<int>(i);
    if (name == "header.stamp.nanosec") nanoseconds_ = static_cast<int>(i);
  }
  counts_.resize(type_->fields().size());
  begins_.resize(type_->fields().size());
}

// whether it is in t
bool BagRows::is_stamp(std::size_t field) const {
  return static_cast<int>(field) == seconds_ || static_cast<int>(field) == nanoseconds_;
}

// [s] 0: it has none; NaN: its type has one
double BagRows::stamp_of(const MessageNumbers& message) const {
  if (seconds_ < 0 || nanoseconds_ < 0) return 0;
  const auto& seconds = message.numbers[static_cast<std::size_t>(seconds_)];
  const auto& nanoseconds = message.numbers[static_cast<std::size_t>(nanoseconds_)];
  if (seconds.empty() || nanoseconds.empty()) return std::numeric_limits<double>::quiet_NaN();
  return seconds[0] + 1e-9 * nanoseconds[0];
}

// for all joints, and for the first stamp that is not 0; where a type learns its fields, for these
void BagRows::look_ahead() {
  BagMessage message;
  MessageNumbers numbers;
  const char* first = "there is none";
  std::vector<std::string> missing;
  const bool learns = type_->learns();
  if (type_->lists() > 0 || learns) missing = joints_;
  std::set<std::string> named;
  bool any = false;
  for (bool begin = true; (learns || !any || !missing.empty() || (!use_stamps_ && seconds_ >= 0)) &&
                          messages_->next(message);
       begin = false) {
    const char* const why = read_message(*type_, message, numbers);
    if (begin && why != nullptr) first = why;
    if (why != nullptr) continue;
    any = true;
    if (learns) note_fields(), count_numbers(numbers);
    const double stamp = stamp_of(numbers);
    use_stamps_ = use_stamps_ || (stamp != 0 && !std::isnan(stamp));
    for (const auto& names : numbers.names) {
      if (joints_.empty()) joints_ = names;
      for (const std::string& name : names) {
        std::erase(missing, name);
        keep_some(named, name);
      }
    }
  }
  const std::string end = messages_->note();
  messages_->rewind();
  if (type_->lists() == 0) missing.clear();
  called_ = joints_;
  if (any && !missing.empty()) find_by_other_names(missing, named);
  if (any) return;
  throw std::runtime_error(fmt::format("{}: no message on topic {} can be read; of the first: {}{}",
                                       messages_->path(), printable_name(messages_->topic().name),
                                       first, end.empty() ? "" : "; " + end));
}

// of joints that are not all there by the robot's names
void BagRows::find_by_other_names(const std::vector<std::string>& missing,
                                  const std::set<std::string>& named) {
  const std::string whose = fmt::format("{}: the messages on topic {}", messages_->path(),
                                        printable_name(messages_->topic().name));
  JointNames found = find_joint_names(named, joints_, whose);
  if (!found.all()) fail_missing_joints(missing, joints_, named, whose);
  called_ = std::move(found.called);
  note_ = "its joints' names " + found.how;
}

// of the fields without names how many there are, if any is finite
void BagRows::count_numbers(const MessageNumbers& message) {
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    if (is_stamp(i) || type_->fields()[i].names >= 0) continue;
    const std::vector<double>& all = message.numbers[i];
    const bool some =
        std::any_of(all.begin(), all.end(), [](double x) { return std::isfinite(x); });
    if (some) counts_[i] = std::max(counts_[i], all.size());
  }
}

// drivers leave fields empty, or NaN, at first
void BagRows::look_for_numbers() {
  BagMessage message;
  MessageNumbers numbers;
  const auto& fields = type_->fields();
  const bool learnt = type_->learns();  // all that has no names
  for (std::size_t i = 0; i < counts_.size(); ++i)
    if (fields[i].names >= 0) counts_[i] = 0;
  const auto found = [&] {
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      const bool named = fields[i].names >= 0;
      if (!is_stamp(i) && (named || !learnt) && (counts_[i] == 0 || (fields[i].many && !named)))
        return false;
    }
    return true;
  };
  while (!found() && messages_->next(message)) {
    if (read_message(*type_, message, numbers) != nullptr) continue;
    find_joints(numbers);
    count_numbers(numbers);
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      if (fields[i].names < 0) continue;
      const std::vector<double>& all = numbers.numbers[i];
      const std::vector<int>& at = at_[static_cast<std::size_t>(fields[i].names)];
      for (std::size_t k = 0; k < all.size(); ++k)
        if (at[k] >= 0 && std::isfinite(all[k])) counts_[i] = joints_.size();
    }
  }
  messages_->rewind();
  strangers_.clear(), with_strangers_ = 0;
}

void BagRows::name_columns() {
  columns_.emplace_back("t");
  std::set<std::string> names{"t"};
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    const MessageField& f = type_->fields()[i];
    begins_[i] = columns_.size();
    for (std::size_t k = 0; k < counts_[i]; ++k) {
      std::string name = f.names >= 0     ? fmt::format("{}.{}", f.begin, joints_[k])
                         : f.many         ? fmt::format("{}[{}]{}", f.begin, k, f.end)
                         : f.begin == "t" ? "message.t"
                                          : f.begin;
      for (int n = 2; !names.insert(name).second; ++n)  // keys of JSON may have any letters
        name = fmt::format("{}#{}", name.substr(0, name.find('#')), n);
      columns_.push_back(std::move(name));
    }
    if (columns_.size() > kMostColumns)
      throw std::runtime_error(fmt::format("{}: the messages on topic {} have more than {} numbers",
                                           messages_->path(),
                                           printable_name(messages_->topic().name), kMostColumns));
  }
}

bool BagRows::next(std::vector<double>& row, SkippedRows& skipped) {
  if (!joins_) {
    const bool any = next_message(row, skipped);
    number_ = read_;
    return any;
  }
  if (ahead_.empty()) ended_ = ended_ || !next_message(ahead_, skipped);
  if (ended_) return false;
  row.swap(ahead_);
  number_ = read_;
  for (std::set<std::int64_t> from{channel_};;) {
    ended_ = !next_message(ahead_, skipped);
    if (ended_ || !from.insert(channel_).second || !take_into(row)) return true;
  }
}

// whether the row that was read ahead is of the same time, and has something else
bool BagRows::take_into(std::vector<double>& row) const {
  if (ahead_[0] != row[0]) return false;
  for (std::size_t i = 1; i < row.size(); ++i)
    if (std::isfinite(row[i]) && std::isfinite(ahead_[i]) && row[i] != ahead_[i]) return false;
  for (std::size_t i = 1; i < row.size(); ++i)
    if (std::isfinite(ahead_[i])) row[i] = ahead_[i];
  return true;
}

bool BagRows::next_message(std::vector<double>& row, SkippedRows& skipped) {
  BagMessage message;
  while (messages_->next(message)) {
    ++read_;
    const char* const why = read_message(*type_, message, numbers_);
    if (why != nullptr) {
      ++skipped.wrong_field_count;
      skipped.say(read_, why);
      continue;
    }
    if (!find_joints(numbers_)) continue;
    fill(row, numbers_);
    last_ = row[0] = use_stamps_ ? stamp_of(numbers_) : message.received;
    channel_ = message.channel;
    return true;
  }
  note_strangers(skipped);
  return false;
}

// whether the message has any of our joints, or names none
bool BagRows::find_joints(const MessageNumbers& message) {
  const auto is_empty = [](const auto& names) { return names.empty(); };
  bool ours = std::all_of(message.names.begin(), message.names.end(), is_empty), others = false;
  at_.resize(message.names.size());
  for (std::size_t list = 0; list < message.names.size(); ++list) {
    at_[list].clear();
    for (const std::string& name : message.names[list]) {
      const auto joint = std::find(called_.begin(), called_.end(), name);
      const bool known = joint != called_.end();
      at_[list].push_back(known ? static_cast<int>(joint - called_.begin()) : -1);
      if (!known) keep_some(strangers_, name);
      (known ? ours : others) = true;
    }
  }
  if (others) ++with_strangers_;
  return ours;
}

void BagRows::fill(std::vector<double>& row, const MessageNumbers& message) const {
  row.assign(columns_.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    const std::vector<double>& all = message.numbers[i];
    const int list = type_->fields()[i].names;
    double* const to = row.data() + begins_[i];
    for (std::size_t k = 0; k < all.size() && counts_[i] > 0; ++k) {
      const int at = list < 0 ? static_cast<int>(k) : at_[static_cast<std::size_t>(list)][k];
      if (at >= 0 && static_cast<std::size_t>(at) < counts_[i]) to[at] = all[k];
    }
  }
}

// of a bag without its end: how far it goes
std::string BagRows::note_of_end() const {
  const std::string note = messages_->note();
  if (note.empty()) return "";
  return fmt::format("{}; {} messages were read, the last of t = {:.3f} s", note, read_, last_);
}

void BagRows::note_strangers(SkippedRows& skipped) {
  if (std::exchange(noted_, true)) return;
  for (std::string note : {note_, note_of_end()})
    if (!note.empty()) skipped.notes.push_back(std::move(note));
  if (with_strangers_ == 0) return;
  skipped.notes.push_back(fmt::format("{} messages name other joints, which are left out: {}",
                                      with_strangers_,
                                      listed_names({strangers_.begin(), strangers_.end()})));
}

}  // namespace tauext

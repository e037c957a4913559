// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/bag/bag_rows.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include "mjcf/trace/printable.h"
#include "mjcf/trace/read/bag/bag_messages.h"
#include "mjcf/trace/read/bag/joint_state.h"
#include "mjcf/trace/read/bag/mcap_messages.h"
#include "mjcf/trace/read/bag/sqlite_messages.h"
#include "mjcf/trace/read/numpy/byte_file.h"

namespace tauext {
namespace {

// of the storage that its first bytes say
std::unique_ptr<BagMessages> open_bag(const std::string& path, const std::string& topic) {
  if (std::filesystem::is_directory(path))
    throw std::runtime_error(fmt::format("{}: is a folder: name the bag's file in it", path));
  const ByteFile file(path);
  std::string begin(std::min<std::uint64_t>(file.size(), 16), '\0');
  file.read(0, begin.data(), begin.size());
  if (begin.starts_with("\x89MCAP0\r\n")) return std::make_unique<McapMessages>(path, topic);
  if (begin == std::string("SQLite format 3\0", 16)) return open_sqlite_bag(path, topic);
  file.fail("begins as no bag of ROS 2 does (.db3, .mcap)");
}

// nullptr, or why not
const char* read_message(const BagMessage& message, JointState& state) {
  if (message.size > BagMessages::kMost) return "it is longer than 1 MB";
  return read_joint_state(message.bytes, state);
}

// for messages to people
void keep_some(std::set<std::string>& names, const std::string& name) {
  if (names.size() < kMostJoints) names.insert(name);
}

template <class Names>
std::string listed(const Names& names) {
  return printable_name(fmt::format("{}", fmt::join(names, ", ")), 400);
}

}  // namespace

BagRows::BagRows(const std::string& path, const std::string& topic, std::vector<std::string> joints)
    : messages_(open_bag(path, topic)), joints_(std::move(joints)) {
  look_ahead();
  look_for_quantities();
  columns_.emplace_back("t");
  constexpr std::array kQuantities{"position", "velocity", "effort"};
  for (std::size_t i = 0; i < kQuantities.size(); ++i)
    for (const std::string& joint : joints_)
      if (has_[i]) columns_.push_back(fmt::format("{}.{}", kQuantities[i], joint));
}

BagRows::~BagRows() = default;

// for all joints, and for the first stamp that is not 0
void BagRows::look_ahead() {
  BagMessage message;
  JointState state;
  const char* first = "there is none";
  std::vector<std::string> missing = joints_;
  std::set<std::string> named;
  bool any = false;
  for (bool begin = true; !(any && missing.empty() && use_stamps_) && messages_->next(message);
       begin = false) {
    const char* const why = read_message(message, state);
    if (begin && why != nullptr) first = why;
    if (why != nullptr) continue;
    if (joints_.empty()) joints_ = state.name;
    any = true;
    use_stamps_ = use_stamps_ || state.stamp != 0;
    for (const std::string& name : state.name) {
      std::erase(missing, name);
      keep_some(named, name);
    }
  }
  messages_->rewind();
  called_ = joints_;
  if (any && (missing.empty() || find_by_prefix(named))) return;
  if (any) fail_missing(missing, named);
  throw std::runtime_error(fmt::format("{}: no message on topic {} can be read; of the first: {}",
                                       messages_->path(), printable_name(messages_->topic()),
                                       first));
}

// drivers leave fields empty, or NaN, at first
void BagRows::look_for_quantities() {
  BagMessage message;
  JointState state;
  while (has_ != std::array{true, true, true} && messages_->next(message)) {
    if (read_message(message, state) != nullptr) continue;
    for (std::size_t i = 0; i < state.name.size(); ++i) {
      if (std::find(called_.begin(), called_.end(), state.name[i]) == called_.end()) continue;
      std::size_t quantity = 0;
      for (const auto* numbers : {&state.position, &state.velocity, &state.effort}) {
        has_[quantity] = has_[quantity] || (!numbers->empty() && std::isfinite((*numbers)[i]));
        ++quantity;
      }
    }
  }
  messages_->rewind();
}

// whether one text, put before each of the robot's names or taken from it, gives names of messages
bool BagRows::find_by_prefix(const std::set<std::string>& named) {
  std::map<std::string, std::vector<std::string>> found;  // by the words of the note
  const auto attempt = [&](const std::string& how, auto&& call) {
    std::vector<std::string> names;
    for (const std::string& joint : joints_) names.push_back(call(joint));
    const bool all = std::all_of(names.begin(), names.end(),
                                 [&](const std::string& n) { return named.count(n) > 0; });
    if (all) found.emplace(how, std::move(names));
  };
  for (const std::string& name : named) {
    if (!name.ends_with(joints_[0]) || name == joints_[0]) continue;
    const std::string before = name.substr(0, name.size() - joints_[0].size());
    attempt(fmt::format("have the prefix '{}'", printable_name(before)),
            [&](const std::string& joint) { return before + joint; });
  }
  for (std::size_t end = joints_[0].find_first_of("_/"); end != std::string::npos;
       end = joints_[0].find_first_of("_/", end + 1)) {
    const std::string before = joints_[0].substr(0, end + 1);
    attempt(fmt::format("do not have the robot's prefix '{}'", printable_name(before)),
            [&](const std::string& joint) {
              return joint.starts_with(before) ? joint.substr(before.size()) : "";
            });
  }
  if (found.empty()) return false;
  if (found.size() > 1)
    throw std::runtime_error(fmt::format(
        "{}: the messages on topic {} match the robot's joints in more than one way: their names "
        "{}, or they {}; name the columns in a map (--columns): [q] columns = [\"position.NAME\", "
        "..]",
        messages_->path(), printable_name(messages_->topic()), found.begin()->first,
        std::next(found.begin())->first));
  called_ = found.begin()->second;
  note_ = "its joints' names " + found.begin()->first;
  return true;
}

void BagRows::fail_missing(const std::vector<std::string>& missing,
                           const std::set<std::string>& named) const {
  throw std::runtime_error(fmt::format(
      "{}: the messages on topic {} never name {}; the robot has {}, and they name {}. Where a "
      "joint has another name there, --columns FILE.toml says which it is: [q] columns = "
      "[\"position.NAME\", ..], and [qd] and [tau_instant] likewise",
      messages_->path(), printable_name(messages_->topic()), listed(missing), listed(joints_),
      listed(named)));
}

bool BagRows::next(std::vector<double>& row, SkippedRows& skipped) {
  BagMessage message;
  JointState state;
  while (messages_->next(message)) {
    ++number_;
    const char* const why = read_message(message, state);
    if (why != nullptr) {
      ++skipped.wrong_field_count;
      skipped.say(number_, why);
      continue;
    }
    if (!fill(row, state)) continue;
    row[0] = use_stamps_ ? state.stamp : message.received;
    return true;
  }
  note_strangers(skipped);
  return false;
}

// whether the message has any of our joints
bool BagRows::fill(std::vector<double>& row, const JointState& state) {
  row.assign(columns_.size(), std::numeric_limits<double>::quiet_NaN());
  std::size_t ours = 0;
  for (std::size_t i = 0; i < state.name.size(); ++i) {
    const auto joint = std::find(called_.begin(), called_.end(), state.name[i]);
    if (joint == called_.end()) {
      keep_some(strangers_, state.name[i]);
      continue;
    }
    ++ours;
    auto at = row.begin() + 1 + (joint - called_.begin());
    std::size_t quantity = 0;
    for (const auto* numbers : {&state.position, &state.velocity, &state.effort}) {
      if (!has_[quantity++]) continue;
      if (!numbers->empty()) *at = (*numbers)[i];
      at += static_cast<std::ptrdiff_t>(joints_.size());
    }
  }
  if (ours < state.name.size()) ++with_strangers_;
  return ours > 0;
}

void BagRows::note_strangers(SkippedRows& skipped) {
  for (std::string note : {std::exchange(note_, ""), messages_->note()})
    if (!note.empty()) skipped.notes.push_back(std::move(note));
  if (with_strangers_ == 0) return;
  skipped.notes.push_back(fmt::format("{} messages name other joints, which are left out: {}",
                                      with_strangers_, listed(strangers_)));
  with_strangers_ = 0;
}

}  // namespace tauext

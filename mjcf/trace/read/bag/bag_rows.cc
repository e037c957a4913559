// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/bag/bag_rows.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "mjcf/trace/printable.h"
#include "mjcf/trace/read/bag/bag_messages.h"
#include "mjcf/trace/read/bag/joint_state.h"

namespace tauext {
namespace {

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
    : messages_(std::make_unique<BagMessages>(path, topic)), joints_(std::move(joints)) {
  look_ahead();
  columns_.emplace_back("t");
  for (const char* what : {"position", "velocity", "effort"}) {
    for (const std::string& joint : joints_) columns_.push_back(fmt::format("{}.{}", what, joint));
  }
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
  if (any && missing.empty()) return;
  if (any) fail_missing(missing, named);
  throw std::runtime_error(fmt::format("{}: no message on topic {} can be read; of the first: {}",
                                       messages_->path(), printable_name(messages_->topic()),
                                       first));
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
    const auto joint = std::find(joints_.begin(), joints_.end(), state.name[i]);
    if (joint == joints_.end()) {
      keep_some(strangers_, state.name[i]);
      continue;
    }
    ++ours;
    auto at = row.begin() + 1 + (joint - joints_.begin());
    for (const auto* numbers : {&state.position, &state.velocity, &state.effort}) {
      if (!numbers->empty()) *at = (*numbers)[i];
      at += static_cast<std::ptrdiff_t>(joints_.size());
    }
  }
  if (ours < state.name.size()) ++with_strangers_;
  return ours > 0;
}

void BagRows::note_strangers(SkippedRows& skipped) {
  if (with_strangers_ == 0) return;
  skipped.notes.push_back(fmt::format("{} messages name other joints, which are left out: {}",
                                      with_strangers_, listed(strangers_)));
  with_strangers_ = 0;
}

}  // namespace tauext

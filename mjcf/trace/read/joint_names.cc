// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/joint_names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

// what stands before and behind a joint's name
using Texts = std::pair<std::string, std::string>;

// whether a word goes on from one letter to the other: neither "joint1|0" nor "f|elbow" are two
bool is_within_word(char a, char b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto lower = [](char c) { return c >= 'a' && c <= 'z'; };
  const auto upper = [](char c) { return c >= 'A' && c <= 'Z'; };
  return (digit(a) && digit(b)) || (lower(b) && (lower(a) || upper(a))) || (upper(a) && upper(b));
}

// of a joint that is a word of its own in one of the names
std::set<Texts> texts_around(const std::string& joint, const std::set<std::string>& names) {
  std::set<Texts> all;
  for (const std::string& name : names) {
    for (std::size_t at = name.find(joint); at != name.npos; at = name.find(joint, at + 1)) {
      const std::size_t end = at + joint.size();
      if (at > 0 && is_within_word(name[at - 1], name[at])) continue;
      if (end < name.size() && is_within_word(name[end - 1], name[end])) continue;
      all.emplace(name.substr(0, at), name.substr(end));
    }
  }
  return all;
}

JointNames names_with(const Texts& around, const std::vector<std::string>& joints,
                      const std::set<std::string>& names) {
  JointNames found;
  for (const std::string& joint : joints) {
    std::string name = around.first + joint + around.second;
    found.called.push_back(names.count(name) > 0 ? std::move(name) : "");
  }
  const auto part = [](const char* what, const std::string& text) {
    return text.empty() ? "" : fmt::format("the {} '{}'", what, printable_name(text));
  };
  const std::string prefix = part("prefix", around.first), suffix = part("suffix", around.second);
  const char* const both = !prefix.empty() && !suffix.empty() ? " and " : "";
  if (!prefix.empty() || !suffix.empty()) found.how = "have " + prefix + both + suffix;
  return found;
}

// "l_" and "r_" are two ways; where the joints have their own names, those behind "old_" are others
void refuse_two_ways(const std::vector<std::pair<Texts, JointNames>>& found,
                     const std::string& whose) {
  const Texts& first = found.front().first;
  for (const auto& [texts, way] : found) {
    if (texts.first.starts_with(first.first) && texts.second.ends_with(first.second)) continue;
    throw std::runtime_error(fmt::format(
        "{} match the robot's joints in more than one way: their names {}, or they {}; name the "
        "columns in a map (--columns): [q] columns = [\"position.NAME\", ..], and [qd] and "
        "[tau_instant] likewise",
        whose, found.front().second.how, way.how));
  }
}

JointNames without_prefix(const std::vector<std::string>& joints,
                          const std::set<std::string>& names) {
  const std::string& first = joints[0];
  for (std::size_t at = 0; (at = first.find_first_of("_/", at)) != first.npos;) {
    const std::string prefix = first.substr(0, ++at);
    std::vector<std::string> bare;
    for (const std::string& joint : joints)
      bare.push_back(joint.starts_with(prefix) ? joint.substr(at) : "");
    JointNames found = names_with({}, bare, names);
    found.how = fmt::format("do not have the robot's prefix '{}'", printable_name(prefix));
    if (found.all()) return found;
  }
  return {};
}

// by the rule by which most are found
JointNames most_of(const std::vector<std::string>& joints, const std::set<std::string>& names) {
  JointNames best;
  std::ptrdiff_t least = static_cast<std::ptrdiff_t>(joints.size());  // that are missing
  for (const std::string& joint : joints) {
    for (const Texts& around : texts_around(joint, names)) {
      JointNames way = names_with(around, joints, names);
      const std::ptrdiff_t missing = std::count(way.called.begin(), way.called.end(), "");
      if (missing < least) best = std::move(way), least = missing;
    }
  }
  return best;
}

}  // namespace

bool JointNames::all() const {
  return any() && std::find(called.begin(), called.end(), "") == called.end();
}

bool JointNames::any() const {
  return std::any_of(called.begin(), called.end(), [](const auto& name) { return !name.empty(); });
}

JointNames find_joint_names(const std::set<std::string>& names,
                            const std::vector<std::string>& joints, const std::string& whose) {
  const auto nameless = [](const std::string& joint) { return joint.empty(); };
  if (joints.empty() || std::any_of(joints.begin(), joints.end(), nameless)) return {};
  std::vector<std::pair<Texts, JointNames>> found;
  for (const Texts& around : texts_around(joints[0], names)) {
    JointNames way = names_with(around, joints, names);
    if (way.all()) found.emplace_back(around, std::move(way));
  }
  if (!found.empty()) {
    const auto size = [](const auto& way) {
      return way.first.first.size() + way.first.second.size();
    };
    std::stable_sort(found.begin(), found.end(),
                     [&](const auto& a, const auto& b) { return size(a) < size(b); });
    refuse_two_ways(found, whose);
    return std::move(found.front().second);
  }
  JointNames bare = without_prefix(joints, names);
  return bare.any() ? bare : most_of(joints, names);
}

void fail_missing_joints(const std::vector<std::string>& missing,
                         const std::vector<std::string>& joints, const std::set<std::string>& names,
                         const std::string& whose) {
  throw std::runtime_error(fmt::format(
      "{} never name {}; the robot has {}, and they name {}. Where a joint has another name there, "
      "--columns FILE.toml says which it is: [q] columns = [\"position.NAME\", ..], and [qd] and "
      "[tau_instant] likewise",
      whose, listed_names(missing), listed_names(joints),
      listed_names({names.begin(), names.end()})));
}

std::string listed_names(const std::vector<std::string>& names) {
  return printable_name(fmt::format("{}", fmt::join(names, ", ")), 400);
}

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/bag/bag_messages.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "mjcf/trace/printable.h"

namespace tauext {

namespace {

// the second spelling is that of the first bags; no topic of ROS has a comma
bool is_joint_state(const BagTopic& t) {
  return (t.type == "sensor_msgs/msg/JointState" || t.type == "sensor_msgs/JointState") &&
         t.name.find(',') == std::string::npos;
}

std::string listed(const std::vector<BagTopic>& topics, bool with_types) {
  std::vector<std::string> names;
  for (const BagTopic& t : topics) {
    names.push_back(printable_name(t.name));
    if (with_types) names.back() += fmt::format(" ({})", printable_name(t.type));
  }
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

std::string choose_topic(const std::vector<BagTopic>& topics, const std::string& wanted,
                         const std::string& path) {
  std::vector<BagTopic> fitting, chosen;
  std::copy_if(topics.begin(), topics.end(), std::back_inserter(fitting), is_joint_state);
  std::copy_if(fitting.begin(), fitting.end(), std::back_inserter(chosen),
               [&](const BagTopic& t) { return wanted.empty() || wanted == t.name; });
  const auto fail = [&](const std::string& why) {
    throw std::runtime_error(fmt::format("{}: {}", path, one_line(why)));
  };
  if (fitting.empty()) {
    fail("has no topic of sensor_msgs/msg/JointState; it has " + listed(topics, true));
  }
  std::sort(chosen.begin(), chosen.end(),
            [](const BagTopic& a, const BagTopic& b) { return a.name < b.name; });
  const auto same = [](const BagTopic& a, const BagTopic& b) { return a.name == b.name; };
  chosen.erase(std::unique(chosen.begin(), chosen.end(), same), chosen.end());
  const std::string known = listed(fitting, false);
  if (chosen.empty())
    fail(fmt::format("has no joint states on topic {}; known: {}", wanted, known));
  if (chosen.size() > 1)
    fail("choose one of its topics of joint states, or several apart by commas (--channel): " +
         known);
  if (chosen[0].format != "cdr") {
    fail(
        fmt::format("topic {} is serialized as '{}', and not as 'cdr': write it anew by ros2 bag "
                    "convert",
                    printable_name(chosen[0].name), printable_name(chosen[0].format)));
  }
  return chosen[0].name;
}

}  // namespace

void BagMessages::set_topics(const std::string& path, const std::vector<BagTopic>& topics,
                             const std::string& wanted) {
  path_ = path;
  for (std::size_t at = 0, end = 0; end != wanted.npos; at = end + 1) {
    end = wanted.find(',', at);
    const std::string topic = choose_topic(topics, wanted.substr(at, end - at), path);
    topic_ += (at == 0 ? "" : ",") + topic;
  }
}

bool BagMessages::is_chosen(std::string_view topic) const {
  return fmt::format(",{},", topic_).find(fmt::format(",{},", topic)) != std::string::npos;
}

}  // namespace tauext

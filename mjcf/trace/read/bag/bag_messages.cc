// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/bag/bag_messages.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "mjcf/trace/printable.h"
#include "mjcf/trace/read/bag/message_type.h"
#include "mjcf/trace/read/column_map_file.h"

namespace tauext {

namespace {

std::string listed(const std::vector<BagTopic>& topics, bool with_types) {
  std::vector<std::string> names;
  for (const BagTopic& t : topics) {
    names.push_back(printable_name(t.name));
    if (with_types) names.back() += fmt::format(" ({})", printable_name(t.type));
  }
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

template <class Fits>
std::vector<BagTopic> those(const std::vector<BagTopic>& topics, Fits&& fits) {
  std::vector<BagTopic> some;
  std::copy_if(topics.begin(), topics.end(), std::back_inserter(some), fits);
  return some;
}

// a bag may have one several times, of several writers
std::vector<BagTopic> each_once(std::vector<BagTopic> topics) {
  const auto key = [](const BagTopic& t) { return std::tie(t.name, t.type); };
  std::sort(topics.begin(), topics.end(),
            [&](const BagTopic& a, const BagTopic& b) { return key(a) < key(b); });
  const auto same = [&](const BagTopic& a, const BagTopic& b) { return key(a) == key(b); };
  topics.erase(std::unique(topics.begin(), topics.end(), same), topics.end());
  return topics;
}

BagTopic choose_topic(const std::vector<BagTopic>& all, const std::string& wanted,
                      const std::string& path) {
  // no topic of ROS has a comma
  const std::vector<BagTopic> topics = each_once(
      those(all, [](const BagTopic& t) { return t.name.find(',') == std::string::npos; }));
  const auto fail = [&](const std::string& why) {
    throw std::runtime_error(fmt::format("{}: {}", path, one_line(why)));
  };
  std::vector<BagTopic> chosen = those(topics, [&](const BagTopic& t) { return t.name == wanted; });
  if (!wanted.empty() && chosen.empty())
    fail(fmt::format("has no topic {}; it has {}", wanted, listed(topics, true)));
  if (chosen.empty())
    chosen = those(topics, [](const BagTopic& t) { return MessageType::is_joint_state(t.type); });
  if (chosen.empty())
    chosen = those(topics, [](const BagTopic& t) {
      return !preset_of_messages(short_type_name(t.type)).empty();
    });
  if (chosen.empty())
    fail(
        "has no topic of sensor_msgs/msg/JointState, or of another type that a preset reads; it "
        "has " +
        listed(topics, true));
  if (chosen.size() > 1)
    fail("choose one of its topics, or several apart by commas (--channel): " +
         listed(chosen, true));
  if (chosen[0].format != "cdr") {
    fail(
        fmt::format("topic {} is serialized as '{}', and not as 'cdr': write it anew by ros2 bag "
                    "convert",
                    printable_name(chosen[0].name), printable_name(chosen[0].format)));
  }
  return chosen[0];
}

}  // namespace

void BagMessages::set_topics(const std::string& path, const std::vector<BagTopic>& topics,
                             const std::string& wanted) {
  path_ = path;
  for (std::size_t at = 0, end = 0; end != wanted.npos; at = end + 1) {
    end = wanted.find(',', at);
    BagTopic topic = choose_topic(topics, wanted.substr(at, end - at), path);
    if (at == 0) {
      topic_ = std::move(topic);
      continue;
    }
    if (short_type_name(topic.type) != short_type_name(topic_.type))
      throw std::runtime_error(
          one_line(fmt::format("{}: topics of two types: {} ({}), {} ({})", path, topic_.name,
                               topic_.type, topic.name, topic.type)));
    topic_.name += "," + topic.name;
  }
}

bool BagMessages::is_chosen(std::string_view topic) const {
  return fmt::format(",{},", topic_.name).find(fmt::format(",{},", topic)) != std::string::npos;
}

void BagMessages::set_definition(std::string language, std::string definition) {
  topic_.language = std::move(language), topic_.definition = std::move(definition);
}

}  // namespace tauext

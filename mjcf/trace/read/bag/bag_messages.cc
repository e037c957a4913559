// SPDX-License-Identifier: Apache-2.0
#include "mjcf/trace/read/bag/bag_messages.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <tuple>

#include "mjcf/trace/printable.h"
#include "mjcf/trace/read/bag/message_type.h"
#include "mjcf/trace/read/column_map_file.h"

namespace tauext {

namespace {

constexpr const char* kJson = "json";

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

BagTopic choose_topic(const std::vector<BagTopic>& topics, const std::string& wanted,
                      const std::string& path) {
  const auto fail = [&](const std::string& why) {
    throw std::runtime_error(fmt::format("{}: {}", path, one_line(why)));
  };
  std::vector<BagTopic> chosen = those(topics, [&](const BagTopic& t) { return t.name == wanted; });
  if (!wanted.empty() && chosen.empty())
    fail(fmt::format("has no topic {}; it has {}", wanted, listed(topics, true)));
  if (chosen.empty())
    chosen = those(topics, [](const BagTopic& t) { return RosType::is_joint_state(t.type); });
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
  if (chosen[0].format != "cdr" && chosen[0].format != kJson) {
    fail(
        fmt::format("topic {} is serialized as '{}', and not as 'cdr' or 'json': write it anew by "
                    "ros2 bag convert",
                    printable_name(chosen[0].name), printable_name(chosen[0].format)));
  }
  return chosen[0];
}

// of several the names apart by commas
BagTopic choose_topics(const std::vector<BagTopic>& topics, const std::string& wanted,
                       const std::string& path) {
  BagTopic all;
  for (std::size_t at = 0, end = 0; end != wanted.npos; at = end + 1) {
    end = wanted.find(',', at);
    BagTopic topic = choose_topic(topics, wanted.substr(at, end - at), path);
    if (at == 0) {
      all = std::move(topic);
      continue;
    }
    const bool any_type = topic.format == kJson && all.format == kJson;
    if (!any_type &&
        (short_type_name(topic.type) != short_type_name(all.type) || topic.format != all.format))
      throw std::runtime_error(
          one_line(fmt::format("{}: topics of two types: {} ({}), {} ({})", path, all.name,
                               all.type, topic.name, topic.type)));
    all.name += "," + topic.name;
  }
  return all;
}

// of "/measured" the topic "/truth"; "" if there is none
std::string truth_beside(const BagTopic& measured, const std::vector<BagTopic>& topics) {
  constexpr std::string_view kEnd = "measured";
  if (measured.type != kMeasuredType || !measured.name.ends_with(kEnd)) return "";
  const std::string name = measured.name.substr(0, measured.name.size() - kEnd.size()) + "truth";
  const auto fits = [&](const BagTopic& t) {
    return t.name == name && t.type == kTruthType && t.format == measured.format;
  };
  return std::any_of(topics.begin(), topics.end(), fits) ? name : "";
}

}  // namespace

bool BagMessages::is_chosen(const BagTopic& topic) const {
  const bool fits = short_type_name(topic.type) == short_type_name(topic_.type) ||
                    (topic.format == kJson && topic_.format == kJson);
  return fits && topic.format == topic_.format &&
         fmt::format(",{},", topic_.name).find(fmt::format(",{},", topic.name)) !=
             std::string::npos;
}

// a bag may have one several times, of several writers; no topic of ROS has a comma
void BagMessages::add_topics(const std::vector<BagTopic>& topics) {
  const auto key = [](const BagTopic& t) { return std::tie(t.name, t.type, t.format); };
  const auto named =
      those(topics, [](const BagTopic& t) { return t.name.find(',') == std::string::npos; });
  topics_.insert(topics_.end(), named.begin(), named.end());
  std::sort(topics_.begin(), topics_.end(),
            [&](const BagTopic& a, const BagTopic& b) { return key(a) < key(b); });
  const auto same = [&](const BagTopic& a, const BagTopic& b) { return key(a) == key(b); };
  topics_.erase(std::unique(topics_.begin(), topics_.end(), same), topics_.end());
}

void BagMessages::choose(const std::string& path, const std::string& wanted) {
  path_ = path;
  BagTopic chosen = choose_topics(topics_, wanted, path);
  if (const std::string truth = wanted.empty() ? truth_beside(chosen, topics_) : ""; !truth.empty())
    chosen.name += "," + truth;
  take(chosen);
}

void BagMessages::take(const BagTopic& topic) {
  topic_ = topic;
  select();
}

void BagMessages::set_definition(const std::string& language, const std::string& definition) {
  topic_.language = language, topic_.definition = definition;
}

}  // namespace tauext

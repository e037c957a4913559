// SPDX-License-Identifier: Apache-2.0
#include "mjcf/import/lock.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <regex>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include "mjcf/import/xml.h"
#include "mjcf/trace/printable.h"

namespace tauext::detail {
namespace {

// GCC's library tries all ways one after the other, which may take for ever, unless it is told to
// go them together; then it knows no \1
#ifdef __GLIBCXX__
constexpr auto kTogether = std::regex::ECMAScript | std::regex_constants::__polynomial;
#else
constexpr auto kTogether = std::regex::ECMAScript;
#endif

const std::regex& compiled(const std::string& regex) {
  thread_local std::pair<std::string, std::regex> last;
  if (last.first != regex) {
    if (regex.size() > 10000)  // it is read as deep as it is long
      throw std::runtime_error("--lock: an expression of more than 10000 letters");
    last.second = std::regex(regex, kTogether);
    last.first = regex;
  }
  return last.second;
}

// a joint that is taken away stays at its `ref`
bool stays_in_range(const XMLElement& joint) {
  const std::vector<double> range = numbers_in(text(joint, "range"));
  const double ref = joint.DoubleAttribute("ref", 0);
  return range.size() < 2 || (range[0] <= ref && ref <= range[1]);
}

std::set<std::string> remove_joints(XMLElement& root, const std::string& lock,
                                    std::map<std::string, int>& changed) {
  std::set<std::string> locked;
  if (lock.empty()) return locked;
  std::vector<std::string> names;
  each(root, [&](XMLElement& e) {
    if (!is_joint(e)) return true;
    names.push_back(text(e, "name"));
    if (!is_locked(names.back(), lock)) return true;
    locked.insert(names.back());
    return drop(e, stays_in_range(e) ? "joint locked" : "joint locked outside its range", changed);
  });
  if (locked.empty()) {
    throw std::runtime_error(one_line(
        fmt::format("--lock '{}' matches no joint; there are: {}", lock, fmt::join(names, ", "))));
  }
  return locked;
}

// for each body the nearest one with a joint, itself or above: bodies that have the same do not
// move against each other
using Carriers = std::map<std::string, const XMLElement*>;
void find_carriers(const XMLElement& at, const XMLElement* carrier, Carriers& all) {
  for (const XMLElement* b = at.FirstChildElement("body"); b != nullptr;
       b = b->NextSiblingElement("body")) {
    const XMLElement* const own = has_joint(*b) ? b : carrier;
    all[text(*b, "name")] = own;
    find_carriers(*b, own, all);
  }
}

bool is_idle(const XMLElement& e, const std::set<std::string>& locked, Carriers& carriers) {
  if (name_of(e) == "tendon") return false;  // it goes with its tendons
  if (name_of(e) != "joint") return carriers[text(e, "body1")] == carriers[text(e, "body2")];
  const std::string one = text(e, "joint1"), two = text(e, "joint2");
  const bool first = locked.count(one) > 0, second = two.empty() || locked.count(two) > 0;
  if (!two.empty() && first != second) {
    throw Mendable(
        one_line(fmt::format("joint '{}' is locked and an equality ties '{}' to it: lock both",
                             first ? one : two, first ? two : one)),
        {.lock = {first ? two : one}, .balance = false});
  }
  return first;
}

bool moves_inside(XMLElement& body) {
  bool moves = false;
  each(body, [&](XMLElement& e) {
    moves = moves || (is_joint(e) && !is_free(e));
    return true;
  });
  return moves;
}

// a body that floats alone beside an arm, like an object to grasp, has no part in its dynamics
void settle(XMLElement& mujoco, std::map<std::string, int>& dropped) {
  bool arm = false;
  std::vector<XMLElement*> free;
  each(mujoco, [&](XMLElement& e) {
    arm = arm || (is_joint(e) && !is_free(e));
    if (is_joint(e) && is_free(e)) free.push_back(&e);
    return true;
  });
  for (XMLElement* joint : free) {
    if (arm && !moves_inside(*joint->Parent()->ToElement()))
      drop(*joint, "body that floats beside the arm, and stands now", dropped);
  }
}

// MuJoCo has free joints at the top alone, where a body of a <frame> does not stand any more
void refuse_carried(XMLElement& mujoco) {
  Problems problems;
  each(mujoco, [&](XMLElement& e) {
    if (is_joint(e) && is_free(e) && parent_name(*e.Parent()->ToElement()) != "worldbody")
      problems.add(at_line(e,
                           "joint '{}' is free, within another body or a <frame>; --lock REGEX "
                           "fixes such joints",
                           text(e, "name")),
                   {.lock = {text(e, "name")}, .balance = false});
    return true;
  });
  problems.raise();
}

}  // namespace

void name_joints(XMLElement& mujoco) {
  std::set<std::string> taken;
  each(mujoco, [&](XMLElement& e) {
    if (is_joint(e)) taken.insert(text(e, "name"));
    return true;
  });
  int number = 0;
  each(mujoco, [&](XMLElement& e) {
    if (!is_joint(e)) return true;
    if (!is_free(e)) ++number;
    if (!text(e, "name").empty()) return true;
    std::string name = is_free(e) ? text(*e.Parent()->ToElement(), "name") : "";
    if (name.empty()) name = is_free(e) ? "base" : fmt::format("joint{}", number);
    while (!taken.insert(name).second) name += '_';
    e.SetAttribute("name", name.c_str());
    return true;
  });
}

bool is_locked(const std::string& joint, const std::string& regex) {
  if (regex.empty()) return false;
  try {
    return std::regex_match(joint, compiled(regex));
  } catch (const std::regex_error& e) {
    throw std::runtime_error(
        fmt::format("--lock '{}': {}{}", printable_name(regex), e.what(),
                    regex.starts_with('*') || regex.starts_with('?')
                        ? ": it is a regular expression, in which .* stands for any letters"
                        : ""));
  }
}

void lock_joints(XMLElement& mujoco, const std::string& regex, std::map<std::string, int>& dropped,
                 std::map<std::string, int>& changed) {
  const std::set<std::string> locked = remove_joints(mujoco, regex, changed);
  settle(mujoco, dropped);
  refuse_carried(mujoco);
  Carriers carriers;
  each(mujoco, [&](XMLElement& e) {
    if (name_of(e) == "worldbody") find_carriers(e, nullptr, carriers);
    return true;
  });
  each(mujoco, [&](XMLElement& e) {
    if (parent_name(e) == "fixed" && locked.count(text(e, "joint")) > 0)
      return drop(e, "locked joint of a tendon", dropped);
    if (parent_name(e) == "equality" && is_idle(e, locked, carriers))
      return drop(e, "equality of what is locked", dropped);
    return true;
  });
  std::set<std::string> gone = {""};
  each(mujoco, [&](XMLElement& e) {
    if (name_of(e) != "fixed" || e.FirstChildElement() != nullptr) return true;
    gone.insert(text(e, "name"));
    return drop(e, "tendon of locked joints", dropped);
  });
  each(mujoco, [&](XMLElement& e) {
    if (name_of(e) != "tendon" || parent_name(e) != "equality" ||
        gone.count(text(e, "tendon1")) == 0 || gone.count(text(e, "tendon2")) == 0)
      return true;
    return drop(e, "equality of what is locked", dropped);
  });
}

}  // namespace tauext::detail

// SPDX-License-Identifier: Apache-2.0
#include "mjcf/import/drives.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "mjcf/import/lock.h"
#include "mjcf/import/measured_terms.h"
#include "mjcf/import/xml.h"

namespace tauext::detail {
namespace {

// the larger end of a range; 0 without one
double most(const std::string& range) {
  const std::vector<double> ends = numbers_in(range);
  return ends.size() < 2 ? 0 : std::max(-ends[0], ends[1]);
}

double gear_of(XMLElement& mujoco, const XMLElement& actuator) {
  const std::vector<double> gear = numbers_in(with_defaults(mujoco, actuator, "gear"));
  return gear.empty() ? 1 : gear.front();
}

// the joint that it acts on, or none
std::string joint_of(const XMLElement& actuator) {
  const std::string joint = text(actuator, "joint");
  return joint.empty() ? text(actuator, "jointinparent") : joint;
}

std::set<std::string> joints_of_tendon(XMLElement& mujoco, const std::string& tendon) {
  std::set<std::string> joints;
  each(mujoco, [&](XMLElement& e) {
    const XMLElement* const around = e.Parent()->ToElement();
    if (name_of(e) == "joint" && parent_name(e) == "fixed" && text(*around, "name") == tendon)
      joints.insert(text(e, "joint"));
    return true;
  });
  return joints;
}

// what no joint of ours can have in its place; "" if there is nothing
std::string strange_force(XMLElement& mujoco, const XMLElement& actuator) {
  const auto numbers = [&](const char* attribute) {
    return numbers_in(with_defaults(mujoco, actuator, attribute));
  };
  const auto begins = [&](const char* attribute) {
    const std::vector<double> all = numbers(attribute);
    return !all.empty() && all.front() != 0;
  };
  if (begins("lugre"))
    return "friction (lugre): write its coulomb torque times the gear into the joint as "
           "frictionloss, and take it out";
  if (begins("cogging")) return "cogging, which no estimator here knows: take it out";
  if (with_defaults(mujoco, actuator, "input") == "none")
    return "a force that nobody asks for (input=\"none\"): write it into the joint as damping, and "
           "take it out";
  const std::vector<double> damping = numbers("damping");
  if (std::any_of(damping.begin() + (damping.empty() ? 0 : 1), damping.end(),
                  [](double x) { return x != 0; }))
    return "damping of higher powers, and only straight lines are known: take them out";
  return "";
}

class Drives {
 public:
  Drives(XMLElement& mujoco, const std::string& lock, std::map<std::string, int>& changed)
      : mujoco_(mujoco), lock_(lock), changed_(changed) {
    each(mujoco_, [&](XMLElement& e) {
      if (parent_name(e) == "actuator") problems_.attempt([&] { keep(e); });
      return parent_name(e) != "actuator";
    });
    problems_.raise();
  }

 private:
  void keep(const XMLElement& actuator) {
    const std::string name = text(actuator, "name"), tendon = text(actuator, "tendon");
    std::set<std::string> joints =
        tendon.empty() ? std::set{joint_of(actuator)} : joints_of_tendon(mujoco_, tendon);
    joints.erase("");
    const bool locked = std::all_of(joints.begin(), joints.end(),
                                    [&](const std::string& j) { return is_locked(j, lock_); });
    if (locked && !joints.empty()) return;
    const std::string who = fmt::format("<{}>{}{}", name_of(actuator), name.empty() ? "" : " ",
                                        name.empty() ? "" : "'" + name + "'");
    if (const std::string force = strange_force(mujoco_, actuator); !force.empty())
      throw Mendable(at_line(actuator, "{} has {}", who, force),
                     {.lock = joints, .balance = false});
    for (const char* const term : {"armature", "damping"}) {
      const std::vector<double> own = numbers_in(with_defaults(mujoco_, actuator, term));
      if (own.empty() || own.front() == 0) continue;
      if (!tendon.empty())
        throw Mendable(at_line(actuator,
                               "{} on the tendon '{}' has {}, which no estimator here knows: write "
                               "it into the joints that it moves, and take it out",
                               who, tendon, term),
                       {.lock = joints, .balance = false});
      const double gear = gear_of(mujoco_, actuator);
      add(actuator, joint_of(actuator), term, gear * gear * own.front());
    }
  }

  void add(const XMLElement& actuator, const std::string& joint, const char* term, double more) {
    XMLElement* found = nullptr;
    each(mujoco_, [&](XMLElement& e) {
      if (is_joint(e) && text(e, "name") == joint) found = &e;
      return found == nullptr;
    });
    if (found == nullptr || joint.empty())
      fail(actuator, "<{}> has {}, and acts on no joint of the file ('{}')", name_of(actuator),
           term, joint);
    const std::vector<double> own = numbers_in(with_defaults(mujoco_, *found, term));
    const double sum = (own.empty() ? 0 : own.front()) + more;
    found->SetAttribute(term, fmt::format("{:.17g}", sum).c_str());
    ++changed_[fmt::format("{} of '{}' by {:.4g}, its actuator's", term, joint, more)];
  }

  XMLElement& mujoco_;
  const std::string& lock_;
  std::map<std::string, int>& changed_;
  Problems problems_;
};

}  // namespace

void keep_rated(XMLElement& mujoco) {
  std::map<std::string, double> rated;
  each(mujoco, [&](XMLElement& e) {
    if (parent_name(e) != "actuator" || e.Attribute("joint") == nullptr) return true;
    const std::string forces = with_defaults(mujoco, e, "forcerange");
    const double force = most(
        forces.empty() && name_of(e) == "motor" ? with_defaults(mujoco, e, "ctrlrange") : forces);
    double& of_joint = rated[text(e, "joint")];
    of_joint = std::max(of_joint, std::abs(gear_of(mujoco, e)) * force);
    return true;
  });
  each(mujoco, [&](XMLElement& e) {
    if (!is_joint(e)) return true;
    const double range = most(with_defaults(mujoco, e, "actuatorfrcrange"));
    if (range > 0) rated[text(e, "name")] = range;
    return true;
  });
  for (const auto& [name, torque] : rated) put_rated(mujoco, name, torque, 0);
}

void keep_drive_dynamics(XMLElement& mujoco, const std::string& lock,
                         std::map<std::string, int>& changed) {
  Drives(mujoco, lock, changed);
}

}  // namespace tauext::detail

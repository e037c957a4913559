// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/robots.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <set>
#include <stdexcept>
#include <typeindex>
#include <utility>

#include "bench/roster/detector_list.h"
#include "bench/roster/file_robot.h"
#include "bench/roster/make_robot.h"
#include "mjcf/import/robot_file.h"
#include "mjcf/plant/tree.h"
#include "mjcf/scenarios/generic.h"
#include "mjcf/trace/known.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/table_writer.h"

namespace tauext {

namespace {

std::vector<detail::MakeRobot>& registered_robots() {
  static std::vector<detail::MakeRobot> all;
  return all;
}

bool in_use = false;  // whether the list of robots has been made

bool is_by_mjcf(std::string_view name) {
  return std::count(kRobotsByMjcf.begin(), kRobotsByMjcf.end(), name) > 0;
}

// the robot of a file, or of an MJCF of ours, read the first time that it is asked for
const Robot& robot_of_file(const std::string& name) {
  static std::mutex mutex;
  static std::map<std::string, std::unique_ptr<const Robot>> all;
  const std::lock_guard alone(mutex);
  std::unique_ptr<const Robot>& r = all[name];
  if (!r) r = file_robot(name);
  return *r;
}

// the remedy of a file of another kind than is read here
void refuse_other_kind(std::string_view name) {
  const std::string why = why_other_kind(std::string(name.substr(0, name.find(kLock))));
  if (!why.empty()) throw std::invalid_argument(why);
}

const Robot& find_robot(const std::vector<std::unique_ptr<const Robot>>& all,
                        std::string_view name) {
  for (const auto& r : all) {
    if (r->name() == name) return *r;
  }
  refuse_other_kind(name);
  std::vector<std::string> known;
  for (const auto& r : all) known.push_back(r->name());
  known.insert(known.end(), kRobotsByMjcf.begin(), kRobotsByMjcf.end());
  throw std::invalid_argument(fmt::format("{}, and files: MJCF, .xml, URDF, .urdf, or ours, .json",
                                          unknown("robot", name, known).what()));
}

std::string list_of(const Robot& r) {
  TableWriter table({{"  scenario", "", true}, {"what happens", "", true}});
  for (const Scenario& s : r.scenarios()) table.add({"  " + s.name, s.description});
  return fmt::format("robot {}, {} joints\n  estimators  {}\n  detectors   {}\n{}", r.name(),
                     r.dof(), fmt::join(r.estimators(), ", "), fmt::join(r.detectors(), ", "),
                     table.format());
}

// what its scenarios and detectors are scaled by
std::string list_scale(const Robot& r) {
  const Model model = r.load_for(quiet());
  const ArmScale scale = scale_of(model);
  const ArmTree arm = tree_of(model);
  TableWriter table({{"  joint", ""},
                     {"name", "", true},
                     {"range", "rad, m"},
                     {"home", "rad, m"},
                     {"amplitude", "rad, m"},
                     {"load", "N m, N"},
                     {"used to", "N m, N"}});
  for (int i = 0; i < r.dof(); ++i) {
    const auto leader = static_cast<std::size_t>(arm.leaders[static_cast<std::size_t>(i)]);
    const bool free = std::isinf(arm.lower[i]) && std::isinf(arm.upper[i]);
    table.add({fmt::format("{}", i + 1), printable_name(arm.names[leader]),
               free ? "none" : fmt::format("{:.3f} to {:.3f}", arm.lower[i], arm.upper[i]),
               fmt::format("{:.3f}", scale.home[i]), fmt::format("{:.3f}", scale.amplitude[i]),
               fmt::format("{:.3g}", scale.torque[i]),
               fmt::format("{:.3g}", scale.usual_torque[i])});
  }
  return fmt::format(
      "{}  its end effector is {}\n  it weighs {:.3g} kg where it gives way, and is hit by {:.3g} "
      "N{}{}\n",
      table.format(), arm.end_effector, scale.mass, scale.blow,
      scale.gives_way ? ", as a joint would give way to more" : "",
      scale.by_effort ? "; loads and blows are by the file's effort" : "");
}

}  // namespace

namespace detail {

std::vector<Registered>& registered_specifications() {
  static std::vector<Registered> all;
  return all;
}

std::shared_ptr<void>& registered_of(const std::type_info& functions) {
  static std::map<std::type_index, std::shared_ptr<void>> all;
  return all[functions];
}

void require_unused() {
  if (!in_use) return;
  throw std::logic_error("register at the begin of main(), before the robots are asked for");
}

void add_robot(MakeRobot make) {
  registered_robots().push_back(std::move(make));
}

}  // namespace detail

template <>
std::unique_ptr<const Robot> make_robot(const std::string& name, const WallMoBot3& arm,
                                        const Model& file) {
  return detail::robot_of_roster(name, arm, file);
}
template <>
std::unique_ptr<const Robot> make_robot(const std::string& name, const Testbed1& arm,
                                        const Model& file) {
  return detail::robot_of_roster(name, arm, file);
}

const std::vector<std::unique_ptr<const Robot>>& robots() {
  static const std::vector<std::unique_ptr<const Robot>> all = [] {
    in_use = true;
    std::vector<std::unique_ptr<const Robot>> list;
    for_each_robot(
        [&](const char* name, const auto& model) { list.push_back(make_robot(name, model)); });
    for (const auto& make : registered_robots()) list.push_back(make());
    for (const auto& [robot, text] : detail::registered_specifications()) {
      if (!is_robot_file(robot) && !is_by_mjcf(robot)) find_robot(list, robot);
    }
    return list;
  }();
  return all;
}

const Robot& robot(std::string_view name, std::string_view lock) {
  const bool file = is_robot_file(name);
  if (!lock.empty() && !file) {
    refuse_other_kind(name);
    throw std::invalid_argument(
        fmt::format("--lock fixes joints of a robot from a file, and {} is none", name));
  }
  if (!lock.empty()) return robot_of_file(fmt::format("{}{}{}", name, kLock, lock));
  return file || is_by_mjcf(name) ? robot_of_file(std::string(name)) : find_robot(robots(), name);
}

std::unique_ptr<const Robot> wallmobot3_believing(double panel) {
  return make_robot("wallmobot3", WallMoBot3(WallMoBot3::Parameters::with_panel(panel)));
}

const Scenario& scenario_of(const Robot& r, std::string_view name) {
  return find_known(
      r.scenarios(), "scenario", name,
      [](const Scenario& s) -> const std::string& { return s.name; }, r.name());
}

std::string level() {
  return TAUEXT_ARCH;
}

bool study_only(std::string_view detector) {
  const std::string_view name = name_of_specification(detector);
  bool found = false;
  for_each_study_detector(
      [&]<class D>(std::type_identity<D>) { found = found || D::kName == name; });
  return found;
}

std::string list_known(const std::string& name, const std::string& lock) {
  if (!name.empty() || !lock.empty()) {
    const Robot& r = robot(name, lock);
    const bool by_mjcf = is_robot_file(name) || is_by_mjcf(name);
    return list_of(r) + (by_mjcf ? list_scale(r) : "") + "\n" + list_fields(&r);
  }
  std::string out;
  for (const auto& r : robots()) out += list_of(*r);
  for (const std::string_view r : kRobotsByMjcf)
    out += fmt::format("robot {}: --list --robot {} shows it\n", r, r);
  return out + "\nrobot FILE.xml or FILE.urdf: any arm of 1 to 8 joints, hinges and slides\n\n" +
         list_fields();
}

std::string list_fields(const Robot* of) {
  TableWriter table(
      {{"what can be set", "", true}, {"limits", "", true}, {"what larger does", "", true}});
  std::set<std::string> told;
  const auto add = [&](const std::string& name, const std::vector<FieldHelp>& fields) {
    if (fields.empty() || !told.insert(name).second) return;
    table.add_note(name);
    for (const FieldHelp& f : fields) {
      table.add({"  :" + f.key, f.range + (f.unit.empty() ? "" : " " + f.unit), f.effect});
    }
  };
  const auto add_all = [&](const Robot& r) {
    for (const std::string& e : r.estimators())
      add(std::string(name_of_specification(e)), r.estimator_fields(e));
    for (const std::string& d : r.detectors()) add(d, r.detector_fields(d));
  };
  if (of != nullptr) {
    add_all(*of);
  } else {
    for (const auto& r : robots()) add_all(*r);
  }
  return "keys of specifications, NAME:KEY=VALUE:KEY=VALUE; a value for each joint is 1/2/3\n" +
         table.format();
}

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
#include "mjcf/scenarios/scenario.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <stdexcept>

#include "mjcf/scenarios/generic.h"
#include "mjcf/scenarios/testbed1.h"
#include "mjcf/scenarios/wallmobot3.h"
#include "mjcf/trace/known.h"

namespace tauext {
namespace {

using Lists = std::map<std::string, std::vector<Scenario>, std::less<>>;

Lists& lists() {
  static Lists all = {{"testbed1", scenarios_of_testbed1()},
                      {"wallmobot3", scenarios_of_wallmobot3()}};
  return all;
}

bool in_use = false;  // whether references into the lists have been given away

// the lists, from the first use on, when every robot should be there
const Lists& final_lists() {
  static const Lists& all = []() -> const Lists& {
    in_use = true;
    const std::vector<std::string> robots = robot_names();
    for (const auto& [robot, list] : lists()) {
      find_known(robots, "robot", robot, [](const std::string& name) { return name; });
    }
    for (const std::string& robot : robots) {
      if (!lists().contains(robot)) lists()[robot] = generic_scenarios(load_robot(robot));
    }
    return lists();
  }();
  return all;
}

}  // namespace

void register_scenario(const std::string& robot, const Scenario& s) {
  if (in_use) {
    throw std::logic_error("register scenarios at the begin of main(), before any is asked for");
  }
  std::vector<Scenario>& list = lists()[robot];
  const bool taken =
      std::any_of(list.begin(), list.end(), [&](const Scenario& x) { return x.name == s.name; });
  if (s.name.empty() || taken) {
    throw std::invalid_argument(
        fmt::format("the name '{}' of a scenario of {} is taken, or empty", s.name, robot));
  }
  list.push_back(s);
}

const std::vector<Scenario>& scenarios(std::string_view robot) {
  return find_known(final_lists(), "robot", robot,
                    [](const auto& list) -> const std::string& { return list.first; })
      .second;
}

const Scenario& scenario(std::string_view robot, std::string_view name) {
  const auto name_of = [](const Scenario& s) -> const std::string& { return s.name; };
  return find_known(scenarios(robot), "scenario", name, name_of, robot);
}

Sensors sensors_for(const Scenario& s, const Sensors& asked) {
  if (!asked.ideal()) return asked;
  Sensors own = s.sensors;
  own.seed = asked.seed;
  return own;
}

ModelError error_for(const Scenario& s, const ModelError& asked) {
  return asked.none() ? s.model_error : asked;
}

Model load_for(std::string_view robot, const Scenario& s, const ModelError& error) {
  const Model m = with_errors(load_robot(robot, s.scene), error_for(s, error));
  return s.load ? with_scaled_body(m, "load", s.load->mass) : m;  // it weighs 1 kg in the scene
}

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
#include "mjcf/scenario.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <stdexcept>

#include "mjcf/scenario_lists.h"

namespace tauext {

Scenario quiet() {
  Scenario s;
  s.reference = [](double) { return Reference{}; };
  s.tau_ext = [](double) { return 0; };
  s.force = [](double, const Point&) -> Eigen::Vector3d { return Eigen::Vector3d::Zero(); };
  s.contact = [](double) { return false; };
  return s;
}

const std::vector<Scenario>& scenarios(std::string_view robot) {
  static const std::map<std::string_view, std::vector<Scenario>> all = {
      {"testbed1", scenarios_of_testbed1()},
      {"wallmobot3", scenarios_of_wallmobot3()},
  };
  const auto it = all.find(robot);
  if (it != all.end()) return it->second;
  throw std::invalid_argument(fmt::format("no scenarios for robot '{}'", robot));
}

const Scenario& scenario(std::string_view robot, std::string_view name) {
  std::vector<std::string_view> known;
  for (const Scenario& s : scenarios(robot)) {
    if (s.name == name) return s;
    known.push_back(s.name);
  }
  throw std::invalid_argument(
      fmt::format("unknown scenario '{}' of {}; known: {}", name, robot, fmt::join(known, ", ")));
}

Model load_for(std::string_view robot, const Scenario& s, const ModelError& error) {
  const Model m = with_errors(load_robot(robot, s.scene), error);
  return s.load ? with_scaled_body(m, "load", s.load->mass) : m;  // it weighs 1 kg in the scene
}

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// A robot of a model of your own, with the roster's estimators and the registered ones. Include
/// bench/registry.h to make one; bench/roster/robots.h has the built-in ones.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <typeinfo>
#include <utility>
#include <vector>

#include "bench/roster/detectors.h"
#include "bench/roster/estimators.h"
#include "bench/roster/robot.h"
#include "bench/roster/roster.h"

namespace tauext {
namespace detail {

// what bench/registry.h has put beside the roster: robot and specification
using Registered = std::pair<std::string, std::string>;
std::vector<Registered>& registered_specifications();
// the list of registered functions of this type; the first call makes it
std::shared_ptr<void>& registered_of(const std::type_info& functions);
template <class Add>
std::vector<std::function<Add>>& registered() {
  using List = std::vector<std::function<Add>>;
  std::shared_ptr<void>& all = registered_of(typeid(Add));
  if (!all) all = std::make_shared<List>();
  return *static_cast<List*>(all.get());
}

template <RobotModel M>
auto& registered_estimators() {
  return registered<EstimatorType(const M&)>();
}
inline auto& registered_detectors() {
  return registered<DetectorType(const JointVec<>& torques)>();
}

template <RobotModel M>
std::unique_ptr<const Robot> robot_of_roster(const std::string& name, const M& model,
                                             const Model& file) {
  static_assert(M::kDof <= kMostDof, "detectors watch 1 to 8 joints");
  std::vector<EstimatorType> all;
  for_each_estimator(model, [&](const auto& entry) { all.push_back(roster_type(entry)); });
  for (const auto& type : registered_estimators<M>()) all.push_back(type(model));
  auto robot = std::make_unique<Robot>(name, M::kDof, std::move(all), file);
  for (const DetectorType& d : roster_detectors(robot->torques())) robot->add_detector(d);
  for (const auto& type : registered_detectors()) robot->add_detector(type(robot->torques()));
  for (const auto& [of, text] : registered_specifications())
    if (of == name) robot->add_specification(text);
  return robot;
}

}  // namespace detail

/// A robot with every estimator that for_each_estimator has for its model, and every detector.
/// @param file the simulated robot, if it is from a file
template <RobotModel M>
std::unique_ptr<const Robot> make_robot(const std::string& name, const M& model,
                                        const Model& file = nullptr) {
  return detail::robot_of_roster(name, model, file);
}

/// Compiled in the library for wallmobot3.
template <>
std::unique_ptr<const Robot> make_robot(const std::string&, const WallMoBot3&, const Model&);
/// Compiled in the library for testbed1.
template <>
std::unique_ptr<const Robot> make_robot(const std::string&, const Testbed1&, const Model&);

}  // namespace tauext

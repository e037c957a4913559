// SPDX-License-Identifier: Apache-2.0
/// @file
/// Yours beside ours, without a change to tauext: in a program of your own, register what you have
/// and call bench_main; the tables, the studies and the JSON then hold it like any other.
///
///     int main(int argc, char** argv) {
///       tauext::register_estimator<tauext::WallMoBot3>([](const auto& arm) { return Mine(arm); });
///       return tauext::bench_main(argc, argv);
///     }
/// All of it before the robots are first asked for, else std::logic_error.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>

#include "bench/roster/estimator_type.h"
#include "bench/roster/file_robot.h"
#include "bench/roster/make_robot.h"
#include "bench/roster/robots.h"
#include "estimators/tree/tree_model.h"
#include "mjcf/plant/any_tree.h"
#include "mjcf/plant/model.h"
#include "mjcf/scenarios/scenario.h"
#include "mjcf/trace/printable.h"

namespace tauext {

namespace detail {
// once, in the program that registers; static: each source may be compiled otherwise
[[maybe_unused]] static void say_if_unoptimised() {
#ifndef __OPTIMIZE__
  [[maybe_unused]] static const bool said =
      (say("yours is compiled without optimisation, which makes it slow: "
           "cmake -DCMAKE_BUILD_TYPE=Release"),
       true);
#endif
}
}  // namespace detail

/// An estimator for every robot of model M; make(model) builds one. With a constructor E(model,
/// parameters) and E::Parameters::fields() (estimators/parameters.h) it is set by specifications,
/// `name:key=value`; with E::Parameters::for_bandwidth(model, w), too, it takes part in
/// --equal-bandwidth and --pareto. Keys change E::Parameters{}, whatever parameters make gives it:
/// where they are others, register a specification instead. A name that is taken is refused when
/// the robots are first asked for (std::invalid_argument).
template <RobotModel M, class Make>
void register_estimator(Make make) {
  detail::require_unused();
  detail::say_if_unoptimised();
  detail::registered_estimators<M>().push_back([make](const M& model) {
    return estimator_type(model, [make, model] { return make(model); });
  });
}

/// A detector for every robot: D(), or D(joints) where there is no such constructor; with
/// D::Parameters D(joints, parameters), of which a specification sets what fields() lists. A name
/// that is taken is refused likewise.
template <CollisionDetector D>
void register_detector() {
  detail::require_unused();
  detail::say_if_unoptimised();
  detail::registered_detectors().push_back(detector_type<D>);
}

/// An estimator for every robot from a file, whatever its number of joints: make takes any
/// AnyTree<N>, which is a RobotModel.
template <class Make>
void register_file_estimator(Make make) {
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (register_estimator<AnyTree<I + 1>>(make), ...);
  }
  (std::make_index_sequence<kMaxFileJoints>());
}

/// A specification as an estimator of that robot: a row `mo2:bandwidth=50` beside `mo2`. One that
/// means nothing there or is listed already is refused likewise, and so is an unknown robot.
inline void register_specification(const std::string& robot, const std::string& specification) {
  detail::require_unused();
  detail::registered_specifications().emplace_back(robot, specification);
}

/// A robot: its model for the estimators, and an MJCF file laid out as mjcf/mujoco/layout.h says.
/// It has the estimators that every arm has (for_each_common_estimator), and the scenarios that you
/// register.
/// @throws std::runtime_error naming the file if MuJoCo cannot read it
template <RobotModel M>
void register_robot(const std::string& name, const M& model, const std::string& mjcf_path) {
  detail::require_unused();
  register_mjcf(name, mjcf_path);
  detail::add_robot([name, model] { return make_robot(name, model); });
}

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
/// @file
/// Yours beside ours, without a change to tauext: in a program of your own, register what you have and
/// call bench_main; the tables, the studies and the JSON then hold it like any other.
///
///     int main(int argc, char** argv) {
///       tauext::register_estimator<tauext::WallMoBot3>([](const auto& arm) { return Mine(arm); });
///       return tauext::bench_main(argc, argv);
///     }
/// All of it before the robots are first asked for, else std::logic_error.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "bench/robot_of.h"
#include "mjcf/model.h"
#include "mjcf/scenario.h"

namespace tauext {

namespace detail {
void require_unused();
void add_robot(std::function<Robot()> make);
}  // namespace detail

/// An estimator for every robot of model M; make(model) builds one. With
/// E::Parameters::for_bandwidth(model, w) and a constructor E(model, parameters) it takes part in
/// --equal-bandwidth and --pareto.
template <RobotModel M, class Make>
void register_estimator(Make make) {
  detail::require_unused();
  detail::registered_estimators<M>().push_back(
      [make](const M& model, detail::StagesOf<M::kDof>& stages) {
        stages.add_estimator(model, [make, model](const Trace&) { return make(model); });
      });
}

/// A detector for every robot of D::kDof joints, with its default parameters.
template <CollisionDetector D>
void register_detector() {
  detail::require_unused();
  detail::registered_detectors<D::kDof>().push_back(
      [](detail::StagesOf<D::kDof>& stages) { stages.template add_detector<D>(); });
}

/// A robot: its model for the estimators, and an MJCF file laid out as mjcf/layout.h says. It has the
/// estimators that every arm has (for_each_common_estimator), and the scenarios that you register.
/// @throws std::runtime_error naming the file if MuJoCo cannot read it
template <RobotModel M>
void register_robot(const std::string& name, const M& model, const std::string& mjcf_path) {
  detail::require_unused();
  register_mjcf(name, mjcf_path);
  detail::add_robot([name, model] { return make_robot(name, model); });
}

}  // namespace tauext

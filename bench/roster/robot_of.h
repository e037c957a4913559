// SPDX-License-Identifier: Apache-2.0
/// @file
/// From the roster's types to a Robot that is asked by name. Include this to make a robot of your
/// own model; else bench/roster/robots.h is enough.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "bench/roster/detectors.h"
#include "bench/roster/making.h"
#include "bench/roster/session/session_of.h"
#include "estimators/runs/runs.h"
#include "mjcf/record_plain.h"
#include "mjcf/trace/known.h"

namespace tauext {
namespace detail {

template <int N>
class RobotOf;

// what bench/registry.h has put beside the roster
template <RobotModel M>
auto& registered_estimators() {
  return registered<void(const M&, RobotOf<M::kDof>&)>();
}
inline auto& registered_detectors() {
  return registered<DetectorType(const JointVec<>& torques)>();
}

// a robot of N joints: its factories, by name
template <int N>
class RobotOf final : public Robot {
 public:
  template <RobotModel M>
  RobotOf(const std::string& name, const M& model, const Model& file) : Robot(name, N, file) {
    static_assert(N <= kMostDof, "detectors watch 1 to 8 joints");
    for_each_estimator(model, [&](auto make) {
      add_estimator(model, make);
      if constexpr (std::is_same_v<M, WallMoBot3> || kLarge) add_runs(model, make);
    });
    for (const DetectorType& d : roster_detectors(torques())) add_detector(d);
    for (const auto& add : registered_estimators<M>()) add(model, *this);
    for (const auto& type : registered_detectors()) add_detector(type(torques()));
    for (const auto& [robot, text] : registered_specifications()) {
      if (robot == name) add_specification(text);
    }
  }

  /// make(trace) builds one; make.parameters, if it has them, are what a specification begins with.
  /// @throws std::invalid_argument if the name is taken
  template <RobotModel M, class Make>
  void add_estimator(const M& model, Make make) {
    using E = std::decay_t<decltype(make(std::declval<const Trace&>()))>;
    using Stage = EstimatorStageOf<E>;
    for (const auto& e : estimators_)
      if (e.name == E::kName) fail_taken("estimator", E::kName, name());
    EstimatorEntry<N> entry{.name = E::kName};
    entry.make = [make](const MadeFor<N>& of, const Specification& s) -> EstimatorPtr {
      refuse_keys(s);
      return std::make_unique<Stage>(make(of.trace));
    };
    if constexpr (requires { E(model, std::declval<typename E::Parameters>()); }) {
      entry.tunable = is_tunable<E, M>();
      entry.fields = fields_of(parameters_of<E>(make, model, {}), entry.tunable);
      entry.make = [make, model](const MadeFor<N>& of, const Specification& s) -> EstimatorPtr {
        if (s.keys.empty()) return std::make_unique<Stage>(make(of.trace));
        return std::make_unique<Stage>(E(model_of(make, model), parameters_of<E>(make, model, s)));
      };
    }
    estimators_.push_back(std::move(entry));
  }

  /// Lists a specification among the estimators.
  /// @throws std::invalid_argument if it means nothing here, or is listed already
  void add_specification(const std::string& text) {
    for (const std::string& e : estimators()) {
      if (e == text) fail_taken("estimator", text, name());
    }
    estimator_of(text, {Trace()});
    specifications_.push_back(text);
  }

  std::vector<Trace> simulate(const Model& arm, std::span<const Scenario> scenarios,
                              const Recording& recording) const override {
    return simulate_plain<N>(arm, scenarios, recording);
  }

  std::vector<std::string> estimators() const override {
    std::vector<std::string> all = names([](const auto&) { return true; });
    all.insert(all.end(), specifications_.begin(), specifications_.end());
    return all;
  }
  std::vector<std::string> tunable() const override {
    return names([](const auto& e) { return e.tunable; });
  }
  std::vector<FieldHelp> estimator_fields(std::string_view name) const override {
    return find(name).fields;
  }

  std::unique_ptr<Runner> runner(std::string_view estimator, std::string_view detector,
                                 const Trace& trace, const DetectorSettings& s) const override {
    require_joints(trace.dof());
    return std::make_unique<RunnerOf<N>>(estimator_of(estimator, {trace}), detector_of(detector, s),
                                         trace);
  }

  std::unique_ptr<Stepper> stepper(std::string_view estimator, std::string_view detector,
                                   const Trace& trace, const DetectorSettings& s) const override {
    if (trace.size() > 0) require_joints(trace.dof());
    return std::make_unique<StepperOf<N>>(estimator_of(estimator, {trace}),
                                          detector_of(detector, s));
  }

  std::unique_ptr<Session> session(std::span<const Trace> traces) const override {
    for (const Trace& t : traces) require_joints(t.dof());
    Makers<N, kRuns> make;
    make.estimator = [this](std::string_view e, const MadeFor<N>& of) {
      return estimator_of(e, of);
    };
    make.detector = [this](const Asked& d) { return detector_of(d.detector, d.settings); };
    make.estimator_of_runs = [this](std::string_view e, const MadeFor<N>& of) {
      return estimator_of_runs(e, of);
    };
    make.detector_of_runs = [this](const Asked& d) { return runs_detector(d); };
    return std::make_unique<SessionOf<N>>(traces, std::move(make));
  }
  int runs_at_once() const override { return kRuns; }

 private:
  // arms for whose algebra lanes are worth their compiling; Eigen's of 8 joints branches by numbers
  static constexpr bool kLarge = N == 6 || N == 7;
  using Lanes = Pack<kRuns>;
  using EstimatorPtr = std::unique_ptr<EstimatorStage<N>>;

  const EstimatorEntry<N>& find(std::string_view specification) const {
    return find_known(estimators_, "estimator", name_of_specification(specification),
                      [](const auto& e) { return e.name; });
  }

  template <class Wanted>
  std::vector<std::string> names(const Wanted& wanted) const {
    std::vector<std::string> all;
    for (const auto& e : estimators_) {
      if (wanted(e)) all.push_back(e.name);
    }
    return all;
  }

  std::unique_ptr<DetectorStage<Lanes>> runs_detector(const Asked& asked) const {
    return made(asked.detector, detector_fields(asked.detector), [&](const Specification& s) {
      return detector_of_runs<kRuns>(s, asked.settings, torques());
    });
  }

  EstimatorPtr estimator_of(std::string_view text, const MadeFor<N>& of) const {
    const EstimatorEntry<N>& e = find(text);
    if (needs_truth(text) && !of.trace.has_truth()) fail_truth(e.name);
    return made(at_instants(e.fields, text, of.trace), e.fields,
                [&](const Specification& s) { return e.make(of, s); });
  }
  // null for one that cannot
  auto estimator_of_runs(std::string_view text, const MadeFor<N>& of) const {
    const EstimatorEntry<N>& e = find(text);
    return made(at_instants(e.fields, text, of.trace), e.fields,
                [&](const Specification& s) { return e.make_runs ? e.make_runs(of, s) : nullptr; });
  }

  // lets the estimator that was added last do several runs at once, if it can
  template <RobotModel M, class Make>
  void add_runs(const M& model, const Make& make) {
    using E = std::decay_t<decltype(make(std::declval<const Trace&>()))>;
    using Same = typename ComputesAs<E>::type;
    if constexpr (ForRuns<Same>) {
      using Stage = EstimatorStageOf<Runs<Same>, Lanes>;
      estimators_.back().make_runs = [make, model](const MadeFor<N>& of, const Specification& s) {
        const auto arm = model_of(make, model);
        const auto p = parameters_of<E>(make, model, s);
        auto of_all = arm.template with<Lanes>();
        if constexpr (requires { of_all.within(*of.terms); }) {
          if (of.terms) of_all = of_all.within(*of.terms);
        }
        return std::make_unique<Stage>(Runs<Same>(arm, of_all, p));
      };
    }
  }

  std::vector<EstimatorEntry<N>> estimators_;
  std::vector<std::string> specifications_;  // that are listed beside the estimators
};

// compiled in the library
extern template class RobotOf<1>;
extern template class RobotOf<2>;
extern template class RobotOf<3>;
#if TAUEXT_FILE_JOINTS >= 8
extern template class RobotOf<4>;
extern template class RobotOf<5>;
extern template class RobotOf<6>;
extern template class RobotOf<7>;
extern template class RobotOf<8>;
#endif

}  // namespace detail

/// A robot with every estimator that for_each_estimator has for its model, and every detector.
/// @param file the simulated robot, if it is from a file
template <RobotModel M>
std::unique_ptr<const Robot> make_robot(const std::string& name, const M& model,
                                        const Model& file = nullptr) {
  return std::make_unique<detail::RobotOf<M::kDof>>(name, model, file);
}

/// That of wallmobot3 is compiled in the library.
template <>
std::unique_ptr<const Robot> make_robot(const std::string&, const WallMoBot3&, const Model&);
/// That of testbed1, likewise.
template <>
std::unique_ptr<const Robot> make_robot(const std::string&, const Testbed1&, const Model&);

}  // namespace tauext

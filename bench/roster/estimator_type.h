// SPDX-License-Identifier: Apache-2.0
/// @file
/// From an estimator to its EstimatorType: for its own source in estimators/, and for what
/// bench/registry.h has put beside the roster.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "bench/roster/estimators.h"
#include "bench/roster/specification.h"
#include "estimators/parameters.h"
#include "estimators/runs/runs.h"
#include "estimators/testbed1.h"
#include "estimators/wallmobot3.h"
#include "mjcf/plant/any_tree.h"

namespace tauext {

#if defined TAUEXT_FOR_TREES && TAUEXT_FILE_JOINTS == 8  // by shared_code.cc.in
extern template class TreeModel<1>;
extern template class Sampling<1>;
extern template class TreeModel<2>;
extern template class Sampling<2>;
extern template class TreeModel<3>;
extern template class Sampling<3>;
extern template class TreeModel<4>;
extern template class Sampling<4>;
extern template class TreeModel<5>;
extern template class Sampling<5>;
extern template class TreeModel<6>;
extern template class Sampling<6>;
extern template class TreeModel<7>;
extern template class Sampling<7>;
extern template class TreeModel<8>;
extern template class Sampling<8>;
extern template class TreeOfRuns<6, kRuns>;
extern template class TreeOfRuns<7, kRuns>;
#endif

namespace detail {

// whether it can be designed for a bandwidth
template <class E, class M>
constexpr bool is_tunable() {
  return requires(const M& model) {
    E::Parameters::for_bandwidth(model, 1.);
  }
  &&!requires {
    E::kFixedTuning;
  };
}

// the class that an estimator of the roster only gives other parameters: itself, or E::ComputesAs
template <class E>
constexpr auto computes_as() {
  if constexpr (requires { typename E::ComputesAs; })
    return std::type_identity<typename E::ComputesAs>();
  else
    return std::type_identity<E>();
}

// whether it may be told when the torque acted
template <class P>
concept TellsTorqueSampling = requires(P p) {
  p.torque = TorqueSampling::kInstant;
};

// whether one that is made can be made again, and told when the torque acted
template <class E, class M>
concept KnowsItsParameters = requires(const E& e, const M& model, typename E::Parameters p) {
  p = e.parameters();
  p.torque = TorqueSampling::kInstant;
  E(model, p);
};

// the entry's parameters, or those of a bandwidth, as the specification's other keys change them
template <class E, class M>
[[gnu::cold]] typename E::Parameters parameters_of(const RosterEntry<E, M>& entry, Specification s,
                                                   bool torque_at_instants) {
  typename E::Parameters p = entry.parameters;
  if constexpr (is_tunable<E, M>()) {
    if (const std::optional<double> w = take_bandwidth(s))
      p = E::Parameters::for_bandwidth(entry.model, *w);
  }
  if constexpr (TellsTorqueSampling<typename E::Parameters>)
    if (torque_at_instants) p.torque = TorqueSampling::kInstant;
  set_parameters(s.keys, p);
  return p;
}

// arms for whose algebra lanes are worth their compiling; Eigen's of 8 joints branches by numbers
template <class M>
constexpr bool kDoesRuns = std::is_same_v<M, WallMoBot3> || M::kDof == 6 || M::kDof == 7;

// of an estimator that is made of a model and Parameters
template <class E, RobotModel M>
[[gnu::cold]] EstimatorType parametric_type(const std::shared_ptr<const RosterEntry<E, M>>& entry) {
  EstimatorType type{.name = E::kName};
  type.tunable = is_tunable<E, M>();
  type.fields = field_help(&entry->parameters);
  if (type.tunable) type.fields = with_bandwidth(std::move(type.fields));
  type.make = [entry](const Specification& s, const Trace& trace) __attribute__((cold)) {
    return std::make_unique<EstimatorStageOf<E>>(
        std::in_place, entry->model, parameters_of(*entry, s, trace.torque_at_instants));
  };
  return type;
}

}  // namespace detail

/// The type of an estimator of arms of model M: make() builds one, and keys of a specification
/// change E::Parameters{}.
template <RobotModel M, class Make>
EstimatorType estimator_type(const M& model, const Make& make) {
  using E = std::decay_t<decltype(make())>;
  EstimatorType type{.name = E::kName};
  bool keyed = false, told = false;  // whether there are parameters, and among them the torque's
  if constexpr (requires { E(model, std::declval<typename E::Parameters>()); }) {
    using Keyed = RosterEntry<E, M>;
    type = detail::parametric_type<E, M>(
        std::make_shared<const Keyed>(Keyed{model, typename E::Parameters()}));
    keyed = true;
    told = detail::TellsTorqueSampling<typename E::Parameters>;
  }
  type.make = [=, with_keys = std::move(type.make)](
                  const Specification& s, const Trace& trace) -> std::unique_ptr<EstimatorStage<>> {
    if (!keyed) detail::refuse_keys(s);
    const bool as_made = s.keys.empty() && !(told && trace.torque_at_instants);
    if (as_made) return std::make_unique<EstimatorStageOf<E>>(make());
    if constexpr (detail::KnowsItsParameters<E, M>) {
      if (s.keys.empty()) {
        typename E::Parameters p = make().parameters();
        p.torque = TorqueSampling::kInstant;
        return std::make_unique<EstimatorStageOf<E>>(std::in_place, model, p);
      }
    }
    return with_keys(s, trace);
  };
  return type;
}

template <class E, RobotModel M>
[[gnu::cold]] EstimatorType roster_type(const RosterEntry<E, M>& of) {
  const auto entry = std::make_shared<const RosterEntry<E, M>>(of);
  EstimatorType type = detail::parametric_type(entry);
  using Same = typename decltype(detail::computes_as<E>())::type;
  if constexpr (detail::kDoesRuns<M> && ForRuns<Same>) {
    type.make_runs = [entry](const Specification& s, const Trace& trace, SharedTerms* terms)
        __attribute__((cold)) {
      auto of_all = entry->model.template with<EstimatorType::Lanes>();
      if constexpr (requires { of_all.within(terms->of<M::kDof>()); }) {
        if (terms) of_all = of_all.within(terms->of<M::kDof>());
      }
      return std::make_unique<EstimatorStageOf<Runs<Same>, EstimatorType::Lanes>>(
          std::in_place, entry->model, of_all,
          detail::parameters_of(*entry, s, trace.torque_at_instants));
    };
  }
  return type;
}

namespace detail {

// that of E for these models, compiled where it is asked for
template <template <DifferentiableModel> class E, class... M>
constexpr auto types_for() {
  return std::tuple(&roster_type<E<M>, M>...);
}
template <template <DifferentiableModel> class E, std::size_t... I>
constexpr auto types_for_trees(std::index_sequence<I...>) {
  return types_for<E, AnyTree<static_cast<int>(I) + 1>...>();
}

}  // namespace detail

/// Compiles the roster's type of E for the arms of this library: closed forms, or trees, all of
/// which are differentiable.
template <template <DifferentiableModel> class E>
constexpr auto compiled_types() {
#ifdef TAUEXT_FOR_TREES
  return detail::types_for_trees<E>(std::make_index_sequence<TAUEXT_FILE_JOINTS>());
#else
  return detail::types_for<E, WallMoBot3, Testbed1>();
#endif
}

}  // namespace tauext

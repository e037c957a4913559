// SPDX-License-Identifier: Apache-2.0
/// @file
/// How a specification becomes an estimator.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <typeinfo>
#include <utility>
#include <vector>

#include "bench/roster/robot.h"
#include "bench/roster/roster.h"
#include "bench/roster/stages.h"
#include "estimators/math/pack.h"

namespace tauext::detail {

// what does not depend on types, compiled once
[[noreturn]] void fail_truth(const std::string& estimator);
std::optional<double> take_bandwidth(Specification& s);
FieldHelp bandwidth_help();

// what bench/registry.h has put beside the roster: robot and specification
using Registered = std::pair<std::string, std::string>;
std::vector<Registered>& registered_specifications();
// and functions of a type, one list whatever level asks for it; who first asks makes it
std::shared_ptr<void>& registered_of(const std::type_info& functions);
template <class Add>
std::vector<std::function<Add>>& registered() {
  using List = std::vector<std::function<Add>>;
  std::shared_ptr<void>& all = registered_of(typeid(Add));
  if (!all) all = std::make_shared<List>();
  return *static_cast<List*>(all.get());
}

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

// the roster's own parameters, or those of a bandwidth, and what the other keys change
template <class E, class Make, class M>
typename E::Parameters parameters_of(const Make& make, const M& model, Specification s) {
  using P = typename E::Parameters;
  const auto start = [&]() -> P {
    if constexpr (is_tunable<E, M>()) {
      if (const std::optional<double> w = take_bandwidth(s)) return P::for_bandwidth(model, *w);
    }
    if constexpr (requires { make.parameters; }) {
      return make.parameters;
    } else if constexpr (std::is_default_constructible_v<P>) {
      return P();
    }
  };
  P p = start();
  set_parameters(s.keys, p);
  return p;
}

// some estimators believe in a model of their own
template <class Make, class M>
const M& model_of(const Make& make, const M& model) {
  if constexpr (requires { make.model; }) {
    return make.model;
  } else {
    return model;
  }
}

template <class P>
std::vector<FieldHelp> fields_of(const P& p, bool tunable) {
  std::vector<FieldHelp> all = field_help(&p);
  if (!tunable) return all;
  FieldHelp bandwidth = bandwidth_help();
  std::erase_if(all, [&](const FieldHelp& f) {
    if (f.key == bandwidth.key) bandwidth.value = f.value;
    return f.key == bandwidth.key;
  });
  all.insert(all.begin(), std::move(bandwidth));
  return all;
}

// how a robot makes an estimator; make_runs makes one for several runs, and only
// those of the roster have it, because it must be compiled with the flags of RobotOf

template <int N>
struct EstimatorEntry {
  template <class Scalar>
  using Make = std::function<std::unique_ptr<EstimatorStage<N, Scalar>>(const MadeFor<N>&,
                                                                        const Specification&)>;
  std::string name;
  Make<double> make;
  Make<Pack<kRuns>> make_runs;
  std::vector<FieldHelp> fields;
  bool tunable = false;
};

// the estimator as the trace's torques want it
inline std::string at_instants(const std::vector<FieldHelp>& fields, std::string_view text,
                               const Trace& trace) {
  std::string as_it_is(text);
  return trace.torque_at_instants ? with_key(as_it_is, "torque", "instant", fields) : as_it_is;
}

}  // namespace tauext::detail

// SPDX-License-Identifier: Apache-2.0
/// @file
/// How a specification becomes an estimator or a detector.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <typeinfo>
#include <utility>
#include <vector>

#include "bench/roster/robot.h"
#include "bench/roster/roster.h"

namespace tauext::detail {

// what does not depend on types, compiled once
[[noreturn]] void fail_taken(const char* what, const std::string& taken, const std::string& robot);
[[noreturn]] void fail_truth(const std::string& estimator);
void refuse_keys(const Specification& s);
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

// sets what is known of Parameters p
template <class P>
void set_trained(P& p, const char* name, const DetectorThresholds& known) {
  const auto it = known.find(name);
  if (it == known.end()) return;
  p.threshold = it->second.threshold;
  if constexpr (requires { p.metric; }) {
    if (it->second.metric.size() > 0) p.metric = it->second.metric;
  }
}

// one that is made of two others is trained as they are
template <class D>
concept OfTrainedParts = requires(typename D::Parameters p) {
  p.collision.threshold;
  p.clamping.threshold;
};

// the detectors whose thresholds it takes
template <class D>
std::vector<std::string> trained_parts_of() {
  if constexpr (OfTrainedParts<D>) {
    return {PanTompkins<D::kDof>::kName, Clamping<D::kDof>::kName};
  } else if constexpr (CalibratableDetector<D>) {
    return {D::kName};
  } else {
    return {};
  }
}

// times what the torques in detectors' defaults are right for this arm
template <int N>
Vec<N> torques_of(const Eigen::VectorXd& usual) {
  constexpr double kUsualTorque = 1200;  // [N m] that the defaults fit
  if (usual.size() == 0) return Vec<N>::Ones();
  return usual / kUsualTorque;
}

// the arm's defaults, then what training says, then what the specification says
template <class D>
D make_detector(const DetectorSettings& settings, const Specification& s,
                const Vec<D::kDof>& torques) {
  constexpr int N = D::kDof;
  if constexpr (requires { typename D::Parameters; }) {
    typename D::Parameters p;
    scale_torques(p, torques);
    if constexpr (OfTrainedParts<D>) {
      set_trained(p.collision, PanTompkins<N>::kName, settings.thresholds);
      set_trained(p.clamping, Clamping<N>::kName, settings.thresholds);
      p.collision.start_up = p.clamping.start_up = settings.start_up;
    } else {
      if constexpr (requires { p.threshold; }) set_trained(p, D::kName, settings.thresholds);
      if constexpr (requires { p.start_up; }) p.start_up = settings.start_up;
    }
    set_parameters(s.keys, p);
    return D(p);
  } else {
    refuse_keys(s);
    return D();
  }
}

// what the keys change: the roster's own parameters, or those of a bandwidth, whose key is taken
// out
template <class E, bool tunable, class Make, class M>
typename E::Parameters start_of(const Make& make, const M& model, Specification& s) {
  using P = typename E::Parameters;
  if constexpr (tunable) {
    if (const std::optional<double> w = take_bandwidth(s)) return P::for_bandwidth(model, *w);
  }
  if constexpr (requires { make.parameters; }) {
    return make.parameters;
  } else if constexpr (std::is_default_constructible_v<P>) {
    return P();
  }
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

template <class D>
std::optional<Calibration> calibration_of(const Vec<D::kDof>& torques) {
  if constexpr (CalibratableDetector<D>) {
    typename D::Parameters p;
    scale_torques(p, torques);
    constexpr bool kMetric = requires(D d) {
      p.metric, d.change();
    };
    return Calibration{D::kDegree, p.threshold, kMetric};
  } else {
    return std::nullopt;
  }
}

template <class D>
std::vector<FieldHelp> fields_of_detector(const Vec<D::kDof>& torques) {
  if constexpr (requires { typename D::Parameters; }) {
    typename D::Parameters p;
    scale_torques(p, torques);
    return field_help(&p);
  } else {
    return {};
  }
}

}  // namespace tauext::detail

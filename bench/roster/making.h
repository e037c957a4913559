// SPDX-License-Identifier: Apache-2.0
/// @file
/// How a specification becomes an estimator or a detector.
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

// a detector whose thresholds another one takes, and what stands before its keys there
struct TrainedPart {
  std::string name, prefix;
};

// the detectors whose thresholds it takes
template <class D>
std::vector<TrainedPart> trained_parts_of() {
  if constexpr (OfTrainedParts<D>) {
    return {{PanTompkins<D::kDof>::kName, "collision."}, {Clamping<D::kDof>::kName, "clamping."}};
  } else if constexpr (CalibratableDetector<D>) {
    return {{D::kName, ""}};
  } else {
    return {};
  }
}

// their specifications, with the keys that are theirs
std::vector<std::string> specifications_of(const std::vector<TrainedPart>& parts,
                                           const Specification& whole);

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
      if constexpr (requires { p.most_score; })
        p.most_score = settings.most_score.value_or(p.most_score);
    }
    set_parameters(s.keys, p);
    return D(p);
  } else {
    refuse_keys(s);
    return D();
  }
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

// how a robot makes an estimator or a detector; make_runs makes one for several runs, and only
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

template <int N>
struct DetectorEntry {
  template <class Scalar>
  using Make = std::function<std::unique_ptr<DetectorStage<N, Scalar>>(const DetectorSettings&,
                                                                       const Specification&)>;
  std::string name;
  Make<double> make;
  Make<Pack<kRuns>> make_runs;
  std::vector<FieldHelp> fields;
  std::vector<TrainedPart> trained_parts;
  std::optional<Calibration> calibration;
};

// what `make` makes of an entry's specification; null where nothing makes it
template <class Make, class Entry, class Behind>
typename Make::result_type made(const Make& make, const Entry& e, std::string_view text,
                                const Behind& behind) {
  if (!make) return nullptr;
  const Specification s = parse_specification(text);
  if (s.keys.empty()) return make(behind, s);
  return explaining_keys(text, e.fields, [&] { return make(behind, s); });
}

// the estimator as the trace's torques want it
inline std::string at_instants(const std::vector<FieldHelp>& fields, std::string_view text,
                               const Trace& trace) {
  std::string as_it_is(text);
  return trace.torque_at_instants ? with_key(as_it_is, "torque", "instant", fields) : as_it_is;
}

// what a detector says of these estimates of the trace
template <int N>
std::vector<Detection> said_by(DetectorStage<N>& detector, const Trace& trace,
                               const Output& estimates) {
  std::vector<Detection> said(trace.t.size());
  for (int k = 0; k < trace.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Measurement<N> y = trace.measurement<N>(k);
    const Estimate<N> e{estimates.tau_ext.col(k), estimates.status[at]};
    detector.run({&y, 1}, {&e, 1}, {&said[at], 1});
  }
  return said;
}

}  // namespace tauext::detail

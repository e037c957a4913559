// SPDX-License-Identifier: Apache-2.0
/// @file
/// From the roster's types to a Robot that is asked by name. Include this to make a robot of your own
/// model; else bench/robot.h is enough.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stdexcept>

#include "bench/robot.h"
#include "bench/roster.h"

namespace tauext {
namespace detail {

template <class List>
const auto& find(const List& list, const char* what, std::string_view name) {
  std::vector<std::string> known;
  for (const auto& [key, make] : list) {
    if (key == name) return make;
    known.push_back(key);
  }
  throw std::invalid_argument(
      fmt::format("unknown {} '{}'; known: {}", what, name, fmt::join(known, ", ")));
}

template <class List>
std::vector<std::string> names_of(const List& list) {
  std::vector<std::string> names;
  for (const auto& entry : list) names.push_back(entry.first);
  return names;
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

template <class D>
D make_detector(const DetectorSettings& settings) {
  constexpr int N = D::kDof;
  if constexpr (requires { typename D::Parameters; }) {
    typename D::Parameters p;
    if constexpr (requires { p.collision.threshold, p.clamping.threshold; }) {
      set_trained(p.collision, PanTompkins<N>::kName, settings.thresholds);
      set_trained(p.clamping, Clamping<N>::kName, settings.thresholds);
      p.collision.start_up = p.clamping.start_up = settings.start_up;
    } else {
      if constexpr (requires { p.threshold; }) set_trained(p, D::kName, settings.thresholds);
      if constexpr (requires { p.start_up; }) p.start_up = settings.start_up;
    }
    return D(p);
  } else {
    return D();
  }
}

}  // namespace detail

// one robot's factories, for its N joints
struct Robot::Stages {
  virtual ~Stages() = default;
  virtual std::unique_ptr<Runner> runner(std::string_view estimator, std::string_view detector,
                                         const Trace& trace, const DetectorSettings& s) const = 0;
  virtual std::unique_ptr<Stepper> stepper(std::string_view estimator, std::string_view detector,
                                           const Trace& trace, const DetectorSettings& s) const = 0;
  virtual std::unique_ptr<Runner> tuned(std::string_view estimator, double w,
                                        const Trace& trace) const = 0;
  virtual Supervisor supervisor(std::string_view estimator, std::string_view detector,
                                const DetectorSettings& s) const = 0;
  virtual std::vector<Detection> detect(std::string_view detector, const Trace& trace,
                                        const Output& estimates,
                                        const DetectorSettings& s) const = 0;
  virtual Eigen::VectorXd largest_statistic(std::string_view detector, const Trace& trace,
                                            const Output& estimates, const DetectorSettings& s,
                                            double from) const = 0;
  virtual Eigen::MatrixXd covariance(std::string_view detector, const Trace& trace,
                                     const Output& estimates, const DetectorSettings& s,
                                     double from) const = 0;
  virtual const Calibration& calibration(std::string_view detector) const = 0;
};

namespace detail {

template <class Make>
using Named = std::vector<std::pair<std::string, Make>>;

template <int N>
struct StagesOf;

// what bench/registry.h has put beside the roster
template <RobotModel M>
auto& registered_estimators() {
  static std::vector<std::function<void(const M&, StagesOf<M::kDof>&)>> all;
  return all;
}
template <int N>
auto& registered_detectors() {
  static std::vector<std::function<void(StagesOf<N>&)>> all;
  return all;
}

template <int N>
struct StagesOf final : Robot::Stages {
  using EstimatorPtr = std::unique_ptr<EstimatorStage<N>>;
  using DetectorPtr = std::unique_ptr<DetectorStage<N>>;

  std::string robot;
  Named<std::function<EstimatorPtr(const Trace&)>> estimators;
  Named<std::function<EstimatorPtr(double)>> tunable;
  Named<std::function<DetectorPtr(const DetectorSettings&)>> detectors;
  Named<Calibration> calibratable;

  template <RobotModel M>
  StagesOf(const std::string& name, const M& model) : robot(name) {
    for_each_estimator(model, [&](auto make) { add_estimator(model, make); });
    for_each_detector<N>([&](auto make) { add_detector<decltype(make())>(); });
    for (const auto& add : registered_estimators<M>()) add(model, *this);
    for (const auto& add : registered_detectors<N>()) add(*this);
  }

  // make(trace) builds one
  template <RobotModel M, class Make>
  void add_estimator(const M& model, Make make) {
    using E = decltype(make(std::declval<const Trace&>()));
    using Stage = EstimatorStageOf<E>;
    estimators.emplace_back(
        E::kName, [make](const Trace& trace) { return std::make_unique<Stage>(make(trace)); });
    if constexpr (requires { E(model, E::Parameters::for_bandwidth(model, 1.)); }) {
      tunable.emplace_back(E::kName, [model](double w) {
        return std::make_unique<Stage>(E(model, E::Parameters::for_bandwidth(model, w)));
      });
    }
  }

  template <CollisionDetector D>
  void add_detector() {
    detectors.emplace_back(D::kName, [](const DetectorSettings& s) {
      return std::make_unique<DetectorStageOf<D>>(make_detector<D>(s));
    });
    if constexpr (CalibratableDetector<D>) {
      const typename D::Parameters p;
      constexpr bool kMetric = requires(D d) {
        p.metric, d.change();
      };
      calibratable.emplace_back(D::kName, Calibration{D::kDegree, p.threshold, kMetric});
    }
  }

  void check(const Trace& trace) const {
    if (trace.dof() == N) return;
    throw std::invalid_argument(
        fmt::format("{} has {} joints, the samples have {}", robot, int{N}, trace.dof()));
  }

  DetectorPtr detector(std::string_view name, const DetectorSettings& s) const {
    return name.empty() ? nullptr : find(detectors, "detector", name)(s);
  }

  EstimatorPtr estimator(std::string_view name, const Trace& trace) const {
    const auto& make = find(estimators, "estimator", name);
    if (needs_truth(name) && !trace.has_truth()) {
      throw std::invalid_argument(
          fmt::format("estimator '{}' copies the truth: it needs columns tau_ext1..", name));
    }
    return make(trace);
  }

  std::unique_ptr<Runner> runner(std::string_view estimator_name, std::string_view detector_name,
                                 const Trace& trace, const DetectorSettings& s) const override {
    check(trace);
    return std::make_unique<RunnerOf<N>>(estimator(estimator_name, trace),
                                         detector(detector_name, s), trace);
  }

  std::unique_ptr<Stepper> stepper(std::string_view estimator_name, std::string_view detector_name,
                                   const Trace& trace, const DetectorSettings& s) const override {
    if (trace.size() > 0) check(trace);
    return std::make_unique<StepperOf<N>>(estimator(estimator_name, trace),
                                          detector(detector_name, s));
  }

  std::unique_ptr<Runner> tuned(std::string_view estimator, double w,
                                const Trace& trace) const override {
    check(trace);
    return std::make_unique<RunnerOf<N>>(find(tunable, "tunable estimator", estimator)(w), nullptr,
                                         trace);
  }

  Supervisor supervisor(std::string_view estimator, std::string_view detector_name,
                        const DetectorSettings& s) const override {
    if (needs_truth(estimator)) {
      throw std::invalid_argument(
          fmt::format("estimator '{}' copies the truth: it cannot stop a motor", estimator));
    }
    const std::shared_ptr<Stepper> pair =
        std::make_shared<StepperOf<N>>(find(estimators, "estimator", estimator)(Trace()),
                                       find(detectors, "detector", detector_name)(s));
    return [pair](const Sample& y) {
      Vec<N> tau_ext;
      return pair->step(y.t, y.q.data(), y.qd.data(), y.tau.data(), tau_ext.data()).detection.mark;
    };
  }

  std::vector<Detection> detect(std::string_view name, const Trace& trace, const Output& estimates,
                                const DetectorSettings& s) const override {
    const DetectorPtr d = find(detectors, "detector", name)(s);
    const auto [samples, values] = in_order(trace, estimates);
    std::vector<Detection> out(samples.size());
    d->run(samples, values, out);
    return out;
  }

  Eigen::VectorXd largest_statistic(std::string_view name, const Trace& trace,
                                    const Output& estimates, const DetectorSettings& s,
                                    double from) const override {
    const DetectorPtr d = find(detectors, "detector", name)(s);
    const auto [samples, values] = in_order(trace, estimates);
    Vec<N> largest = Vec<N>::Zero();
    for (std::size_t k = 0; k < samples.size(); ++k) {
      Detection ignored;
      d->run({&samples[k], 1}, {&values[k], 1}, {&ignored, 1});
      if (samples[k].t >= from) largest = largest.cwiseMax(d->statistic());
    }
    return largest;
  }

  Eigen::MatrixXd covariance(std::string_view name, const Trace& trace, const Output& estimates,
                             const DetectorSettings& s, double from) const override {
    const DetectorPtr d = find(detectors, "detector", name)(s);
    const auto [samples, values] = in_order(trace, estimates);
    Mat<N> sum = Mat<N>::Zero();
    int count = 0;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      Detection ignored;
      d->run({&samples[k], 1}, {&values[k], 1}, {&ignored, 1});
      if (samples[k].t < from) continue;
      sum += d->change() * d->change().transpose();
      ++count;
    }
    return sum / std::max(count, 1);
  }

  const Calibration& calibration(std::string_view detector_name) const override {
    return find(calibratable, "calibratable detector", detector_name);
  }

  std::pair<std::vector<Measurement<N>>, std::vector<Estimate<N>>> in_order(
      const Trace& trace, const Output& estimates) const {
    check(trace);
    std::vector<Measurement<N>> samples;
    std::vector<Estimate<N>> values;
    for (int k = 0; k < trace.size(); ++k) {
      samples.push_back(trace.measurement<N>(k));
      values.push_back({estimates.tau_ext.col(k), estimates.status[k]});
    }
    return {std::move(samples), std::move(values)};
  }
};

}  // namespace detail

/// A robot with every estimator that for_each_estimator has for its model, and every detector.
template <RobotModel M>
Robot make_robot(const std::string& name, const M& model) {
  auto stages = std::make_shared<detail::StagesOf<M::kDof>>(name, model);
  Robot r;
  r.name = name;
  r.dof = M::kDof;
  r.estimators = detail::names_of(stages->estimators);
  r.tunable = detail::names_of(stages->tunable);
  r.detectors = detail::names_of(stages->detectors);
  r.calibratable = detail::names_of(stages->calibratable);
  r.stages = std::move(stages);
  return r;
}

}  // namespace tauext

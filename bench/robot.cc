// SPDX-License-Identifier: Apache-2.0
#include "bench/robot.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stdexcept>
#include <utility>

#include "bench/roster.h"

namespace tauext {
namespace {

template <int N>
struct Factories {
  std::vector<
      std::pair<std::string, std::function<std::unique_ptr<EstimatorStage<N>>(const Trace&)>>>
      estimators;
  std::vector<std::pair<std::string, std::function<std::unique_ptr<DetectorStage<N>>()>>> detectors;
};

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

template <RobotModel M>
Robot make_robot(const char* name, const M& model) {
  constexpr int N = M::kDof;
  Factories<N> f;
  for_each_estimator(model, [&](auto make) {
    using E = decltype(make(std::declval<const Trace&>()));
    f.estimators.emplace_back(E::kName, [make](const Trace& trace) {
      return std::make_unique<EstimatorStageOf<E>>(make(trace));
    });
  });
  for_each_detector<N>([&](auto make) {
    using D = decltype(make());
    f.detectors.emplace_back(D::kName,
                             [make] { return std::make_unique<DetectorStageOf<D>>(make()); });
  });

  Robot r;
  r.name = name;
  r.dof = N;
  for (const auto& [key, make] : f.estimators) r.estimators.push_back(key);
  for (const auto& [key, make] : f.detectors) r.detectors.push_back(key);
  r.supervisor = [f](std::string_view estimator, std::string_view detector) -> Supervisor {
    if (needs_truth(estimator)) {
      throw std::invalid_argument(
          fmt::format("estimator '{}' copies the truth: it cannot stop a motor", estimator));
    }
    const std::shared_ptr<EstimatorStage<N>> e =
        find(f.estimators, "estimator", estimator)(Trace());
    const std::shared_ptr<DetectorStage<N>> d = find(f.detectors, "detector", detector)();
    return [=](const Sample& y) {
      const Measurement<N> in{y.t, y.q, y.qd, y.tau};
      Estimate<N> estimate;
      Detection detection;
      e->run({&in, 1}, {&estimate, 1});
      d->run({&in, 1}, {&estimate, 1}, {&detection, 1});
      return detection.mark;
    };
  };
  r.runner = [f = std::move(f), robot = r.name](std::string_view estimator,
                                                std::string_view detector,
                                                const Trace& trace) -> std::unique_ptr<Runner> {
    if (trace.dof() != N) {
      throw std::invalid_argument(
          fmt::format("{} has {} joints, the samples have {}", robot, int{N}, trace.dof()));
    }
    const auto& make = find(f.estimators, "estimator", estimator);
    if (needs_truth(estimator) && !trace.has_truth()) {
      throw std::invalid_argument(
          fmt::format("estimator '{}' copies the truth: it needs columns tau_ext1..", estimator));
    }
    std::unique_ptr<DetectorStage<N>> stage;
    if (!detector.empty()) stage = find(f.detectors, "detector", detector)();
    return std::make_unique<RunnerOf<N>>(make(trace), std::move(stage), trace);
  };
  return r;
}

}  // namespace

const std::vector<Robot>& robots() {
  static const std::vector<Robot> all = [] {
    std::vector<Robot> list;
    for_each_robot(
        [&](const char* name, const auto& model) { list.push_back(make_robot(name, model)); });
    return list;
  }();
  return all;
}

const Robot& robot(std::string_view name) {
  std::vector<std::string> known;
  for (const Robot& r : robots()) {
    if (r.name == name) return r;
    known.push_back(r.name);
  }
  throw std::invalid_argument(
      fmt::format("unknown robot '{}'; known: {}", name, fmt::join(known, ", ")));
}

bool needs_truth(std::string_view estimator) {
  return estimator == Truth<1>::kName || estimator == DelayedTruth<1>::kName;
}

bool is_baseline(std::string_view estimator) {
  return estimator == Zero<1>::kName || needs_truth(estimator);
}

}  // namespace tauext

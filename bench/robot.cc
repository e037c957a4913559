// SPDX-License-Identifier: Apache-2.0
#include "bench/robot.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stdexcept>

#include "bench/registry.h"
#include "bench/robot_of.h"

namespace tauext {
namespace {

std::vector<std::function<Robot()>>& registered_robots() {
  static std::vector<std::function<Robot()>> all;
  return all;
}

bool in_use = false;  // whether the list of robots has been made

}  // namespace

void detail::require_unused() {
  if (!in_use) return;
  throw std::logic_error("register at the begin of main(), before the robots are asked for");
}

void detail::add_robot(std::function<Robot()> make) {
  registered_robots().push_back(std::move(make));
}

std::unique_ptr<Runner> Robot::runner(std::string_view estimator, std::string_view detector,
                                      const Trace& trace, const DetectorSettings& s) const {
  return stages->runner(estimator, detector, trace, s);
}

std::unique_ptr<Stepper> Robot::stepper(std::string_view estimator, std::string_view detector,
                                        const Trace& trace, const DetectorSettings& s) const {
  return stages->stepper(estimator, detector, trace, s);
}

std::unique_ptr<Runner> Robot::tuned(std::string_view estimator, double w,
                                     const Trace& trace) const {
  return stages->tuned(estimator, w, trace);
}

Supervisor Robot::supervisor(std::string_view estimator, std::string_view detector,
                             const DetectorSettings& s) const {
  return stages->supervisor(estimator, detector, s);
}

std::vector<Detection> Robot::detect(std::string_view detector, const Trace& trace,
                                     const Output& estimates, const DetectorSettings& s) const {
  return stages->detect(detector, trace, estimates, s);
}

Eigen::VectorXd Robot::largest_statistic(std::string_view detector, const Trace& trace,
                                         const Output& estimates, const DetectorSettings& s,
                                         double from) const {
  return stages->largest_statistic(detector, trace, estimates, s, from);
}

Eigen::MatrixXd Robot::covariance(std::string_view detector, const Trace& trace,
                                  const Output& estimates, const DetectorSettings& s,
                                  double from) const {
  return stages->covariance(detector, trace, estimates, s, from);
}

const Calibration& Robot::calibration(std::string_view detector) const {
  return stages->calibration(detector);
}

const std::vector<Robot>& robots() {
  static const std::vector<Robot> all = [] {
    in_use = true;
    std::vector<Robot> list;
    for_each_robot(
        [&](const char* name, const auto& model) { list.push_back(make_robot(name, model)); });
    for (const auto& make : registered_robots()) list.push_back(make());
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

Robot wallmobot3_believing(double panel) {
  return make_robot("wallmobot3", WallMoBot3(WallMoBot3::Parameters::with_panel(panel)));
}

bool needs_truth(std::string_view estimator) {
  return estimator == Truth<1>::kName || estimator == DelayedTruth<1>::kName;
}

bool is_baseline(std::string_view estimator) {
  return estimator == Zero<1>::kName || needs_truth(estimator);
}

}  // namespace tauext

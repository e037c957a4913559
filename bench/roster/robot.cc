// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/robot.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <stdexcept>
#include <utility>

#include "bench/roster/baselines.h"
#include "mjcf/plant/tree.h"
#include "mjcf/scenarios/generic.h"
#include "mjcf/scenarios/scenario.h"

namespace tauext {
namespace {

// scenarios that somebody added to a file's robot
std::vector<Scenario>& registered_for(const std::string& robot) {
  static std::map<std::string, std::vector<Scenario>> all;
  return all[robot];
}

}  // namespace

Robot::Robot(std::string name, int dof, const Model& file) : name_(std::move(name)), dof_(dof) {
  if (!file) return;
  file_ = simulated(file);
  usual_torque_ = scale_of(file_).usual_torque;
}

std::string Robot::label() const {
  if (!file_) return name_;
  return std::filesystem::path(name_.substr(0, name_.find(kLock))).stem().string();
}

Eigen::VectorXd Robot::small_torque() const {
  return file_ ? Eigen::VectorXd(usual_torque_ / 240) : Eigen::VectorXd::Constant(dof_, 5);
}

const std::vector<Scenario>& Robot::scenarios() const {
  if (!file_) return tauext::scenarios(name_);
  std::call_once(listed_, [&] {
    scenarios_ = generic_scenarios(file_);
    for (const Scenario& s : registered_for(name_)) scenarios_.push_back(s);
  });
  return scenarios_;
}

Model Robot::load_for(const Scenario& s, const ModelError& error) const {
  return file_ ? with_errors(file_, error_for(s, error)) : tauext::load_for(name_, s, error);
}

Eigen::VectorXd Robot::home() const {
  return file_ ? scale_of(file_).home : Eigen::VectorXd::Zero(dof_);
}

void register_scenario_of(const Robot& r, const Scenario& s) {
  if (!r.is_from_file()) return register_scenario(r.name(), s);
  const auto refuse_taken = [&](const std::vector<Scenario>& all) {
    for (const Scenario& known : all) {
      if (known.name != s.name) continue;
      throw std::invalid_argument(fmt::format("{} has a scenario '{}' already", r.label(), s.name));
    }
  };
  refuse_taken(generic_scenarios(r.load_for(quiet())));
  refuse_taken(registered_for(r.name()));
  registered_for(r.name()).push_back(s);
}

void Robot::check(std::string_view estimator, std::string_view detector) const {
  Trace one;  // copies of the truth need a sample of it
  one.t = {0};
  one.q = one.qd = one.tau = one.tau_ext = Eigen::MatrixXd::Zero(dof_, 1);
  stepper(estimator, detector, one, {});
}

Supervisor Robot::supervisor(std::string_view estimator, std::string_view detector,
                             const DetectorSettings& s) const {
  if (needs_truth(estimator)) {
    throw std::invalid_argument(
        fmt::format("estimator '{}' copies the truth: it cannot stop a motor", estimator));
  }
  if (detector.empty()) throw std::invalid_argument("a detector is wanted that stops the motor");
  const std::shared_ptr<Stepper> pair = stepper(estimator, detector, Trace(), s);
  return [pair,
          tau_ext = std::vector<double>(static_cast<std::size_t>(dof_))](const Sample& y) mutable {
    return pair->step(y.t, y.q.data(), y.qd.data(), y.tau.data(), tau_ext.data()).detection.mark;
  };
}

}  // namespace tauext

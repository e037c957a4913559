// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/robot.h"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>
#include <utility>

#include "bench/roster/baselines.h"
#include "mjcf/plant/tree.h"
#include "mjcf/scenarios/generic.h"
#include "mjcf/scenarios/scenario.h"

namespace tauext {

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
  std::call_once(listed_, [&] { scenarios_ = generic_scenarios(file_); });
  return scenarios_;
}

Model Robot::load_for(const Scenario& s, const ModelError& error) const {
  return file_ ? with_errors(file_, error) : tauext::load_for(name_, s, error);
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

// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/robot.h"

#include <fmt/format.h>

#include <stdexcept>

#include "bench/roster/baselines.h"

namespace tauext {

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

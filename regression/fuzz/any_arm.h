// SPDX-License-Identifier: Apache-2.0
/// @file
/// The robot whose thresholds are read while fuzzing: the roster would take minutes to compile.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "bench/roster/robot.h"
#include "bench/roster/specification.h"

namespace tauext {

/// "arm", of three joints, which runs nothing.
class AnyArm final : public Robot {
 public:
  AnyArm() : Robot("arm", 3) {}
  std::vector<std::string> estimators() const override { return {"mo1"}; }
  std::vector<std::string> detectors() const override { return {"threshold"}; }
  std::vector<std::string> tunable() const override { return {}; }
  std::vector<std::string> calibratable() const override { return detectors(); }
  std::vector<std::string> trained_parts(std::string_view) const override { return detectors(); }
  std::vector<FieldHelp> estimator_fields(std::string_view) const override { return {}; }
  std::vector<FieldHelp> detector_fields(std::string_view) const override { return {}; }
  std::unique_ptr<Runner> runner(std::string_view, std::string_view, const Trace&,
                                 const DetectorSettings&) const override {
    return nullptr;
  }
  std::unique_ptr<Stepper> stepper(std::string_view estimator, std::string_view, const Trace&,
                                   const DetectorSettings&) const override {
    parse_specification(estimator);
    return nullptr;
  }
  std::vector<Detection> detect(std::string_view, const Trace&, const Output&,
                                const DetectorSettings&) const override {
    return {};
  }
  Eigen::VectorXd largest_statistic(std::string_view, const Trace&, const Output&,
                                    const DetectorSettings&, double) const override {
    return {};
  }
  Eigen::MatrixXd covariance(std::string_view, const Trace&, const Output&, const DetectorSettings&,
                             double) const override {
    return {};
  }
  const Calibration& calibration(std::string_view) const override { throw std::logic_error(""); }
};

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
#include "bench/roster/robot.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <utility>

#include "bench/roster/baselines.h"
#include "mjcf/plant/any_tree.h"
#include "mjcf/plant/coordinates.h"
#include "mjcf/plant/simulated.h"
#include "mjcf/plant/tree.h"
#include "mjcf/record_plain.h"
#include "mjcf/scenarios/generic.h"
#include "mjcf/scenarios/scenario.h"
#include "mjcf/trace/digest.h"
#include "mjcf/trace/known.h"

namespace tauext {
namespace {

template <class Type, class Wanted>
std::vector<std::string> names_of(const std::vector<Type>& types, const Wanted& wanted) {
  std::vector<std::string> all;
  for (const Type& t : types)
    if (wanted(t)) all.push_back(t.name);
  return all;
}

// scenarios that somebody added to a file's robot
std::vector<Scenario>& registered_for(const std::string& robot) {
  static std::map<std::string, std::vector<Scenario>> all;
  return all[robot];
}

// of what an estimator knows of it, to nine digits
std::string fingerprint_of(const ArmTree& arm) {
  std::string text =
      fmt::format("{:.9g}", fmt::join(arm.gravity.data(), arm.gravity.data() + 3, " "));
  for (const TreeJoint& j : arm.joints) {
    text += fmt::format(" {} {} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}", j.parent,
                        static_cast<int>(j.kind), j.zero, j.mass, j.armature, j.viscous, j.dry);
    if (j.offset != 0 || j.viscous_skew != 0)
      text += fmt::format(" {:.9g} {:.9g}", j.offset, j.viscous_skew);
    for (const Vec<3>& v : {j.axis, j.position, j.center})
      text += fmt::format(" {:.9g}", fmt::join(v.data(), v.data() + v.size(), " "));
    for (const Mat<3>& m : {j.rotation, j.inertia})
      text += fmt::format(" {:.9g}", fmt::join(m.data(), m.data() + m.size(), " "));
  }
  if (arm.drho.rows() != arm.drho.cols() || !arm.drho.isIdentity(0) || !arm.rho0.isZero(0)) {
    text += fmt::format(" {:.9g} {:.9g}", fmt::join(arm.drho.reshaped(), " "),
                        fmt::join(arm.rho0.data(), arm.rho0.data() + arm.rho0.size(), " "));
  }
  return fmt::format("{:016x}", fnv1a(text));
}

}  // namespace

bool is_robot_file(std::string_view name) {
  std::string path(name.substr(0, name.find(kLock)));
  std::transform(path.begin(), path.end(), path.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return path.ends_with(".xml") || path.ends_with(".mjcf") || path.ends_with(".urdf") ||
         path.ends_with(".json");
}

Robot::Robot(std::string name, int dof, std::vector<EstimatorType> estimators, const Model& file)
    : name_(std::move(name)), dof_(dof), torques_(JointVec<>::Ones(dof)) {
  if (file) {
    file_ = simulated(file);
    unfit_ = too_stiff(file_);
    usual_torque_ = scale_of(file_).usual_torque;
    constexpr double kUsualTorque = 1200;  // [N m] that detectors' defaults fit
    torques_ = usual_torque_ / kUsualTorque;
    const ArmTree arm = tree_of(file_);
    fingerprint_ = fingerprint_of(arm);
    for (int i = 0; i < dof; ++i) slides_ = slides_ || arm.slides(i);
  }
  for (EstimatorType& e : baseline_types(dof)) add_estimator(std::move(e));
  for (EstimatorType& e : estimators) add_estimator(std::move(e));
}

std::string Robot::label() const {
  if (!is_robot_file(name_)) return name_;
  const std::filesystem::path path = name_.substr(0, name_.find(kLock));
  const std::vector<std::string> known = robot_names();
  const bool taken = path.extension() == ".json" ||  // beside the file that it is about
                     std::count(known.begin(), known.end(), path.stem().string()) > 0;
  return (taken ? path.filename() : path.stem()).string();
}

std::vector<std::string> Robot::joints() const {
  return file_ ? tree_of(file_).joint_names() : std::vector<std::string>();
}

Eigen::VectorXd Robot::small_torque() const {
  return file_ ? Eigen::VectorXd(usual_torque_ / 240) : Eigen::VectorXd::Constant(dof_, 5);
}

ModelError Robot::hidden_friction() const {
  return file_ ? ModelError{.friction_share = 0.05} : ModelError{.friction = 5};
}

std::string Robot::hidden_friction_in_words() const {
  if (!file_) return "5 N m of dry friction";
  const Eigen::VectorXd dry = hidden_friction().friction_share * usual_torque_;
  return fmt::format("{:.2g} to {:.2g} N m of dry friction", dry.minCoeff(), dry.maxCoeff());
}

const std::vector<Scenario>& Robot::scenarios() const {
  if (!is_robot_file(name_)) return tauext::scenarios(name_);
  require_fit();
  std::call_once(listed_, [&] {
    scenarios_ = generic_scenarios(file_);
    for (const Scenario& s : registered_for(name_)) scenarios_.push_back(s);
  });
  return scenarios_;
}

Model Robot::load_for(const Scenario& s, const ModelError& error) const {
  if (!is_robot_file(name_)) return tauext::load_for(name_, s, error);
  require_fit();
  return with_errors(file_, error_for(s, error));
}

std::unique_ptr<const ArmForces> Robot::forces_at(const std::string& site, bool moment) const {
  return arm_forces(model(), {.site = site, .moment = moment, .limits = small_torque()});
}

void Robot::make_torques(Trace& trace) const {
  if (trace.tau_is_current)
    tauext::make_torques(trace, gains());
  else if (file_)
    trace.tau = torque_gains_of(file_).asDiagonal() * trace.tau;
  if (trace.tau_without_gravity) add_gravity(trace, tree_of(model()));
}

void Robot::require_joints(int joints, const std::string& log) const {
  if (joints != dof_)
    throw std::invalid_argument(fmt::format("{}{}{} has {} joints, the samples have {}", log,
                                            log.empty() ? "" : ": ", name_, dof_, joints));
}

void Robot::require_range(const Eigen::VectorXd& least, const Eigen::VectorXd& most,
                          const std::string& log) const {
  if (!file_) return;
  const ArmTree arm = tree_of(file_);
  for (int j = 0; j < dof_; ++j) {
    const double width = arm.upper[j] - arm.lower[j];  // infinite without both ends
    const double slack = std::isfinite(width) ? width / 4 : 1.5;
    if (least[j] < arm.lower[j] - slack || most[j] > arm.upper[j] + slack)
      throw std::invalid_argument(fmt::format(
          "{}: q{} goes from {:.3g} to {:.3g}, and that joint of {} from {:.3g} to {:.3g} rad (or "
          "m): are both in these units, with the same zero, and in the same order?",
          log, j + 1, least[j], most[j], name_, arm.lower[j], arm.upper[j]));
  }
}

void Robot::require_joints(const Trace& trace, const std::string& log) const {
  require_joints(trace.dof(), log);
  if (log.empty() || trace.size() == 0) return;
  require_range(trace.q.rowwise().minCoeff(), trace.q.rowwise().maxCoeff(), log);
}

Eigen::VectorXd Robot::gains() const {
  return file_ ? tree_of(file_).gain : Eigen::VectorXd::Zero(dof_);
}

Model Robot::model() const {
  return file_ ? file_ : load_robot(name_);
}

void Robot::require_fit() const {
  if (!unfit_.empty()) throw std::invalid_argument(fmt::format("{}: {}", name_, unfit_));
}

Eigen::VectorXd Robot::home() const {
  return file_ ? scale_of(file_).home : Eigen::VectorXd::Zero(dof_);
}

void register_scenario_of(const Robot& r, const Scenario& s) {
  if (!is_robot_file(r.name())) return register_scenario(r.name(), s);
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

std::vector<Trace> Robot::simulate(const Model& arm, std::span<const Scenario> scenarios,
                                   const Recording& recording) const {
  return simulate_plain(arm, scenarios, recording);
}

void Robot::add_estimator(EstimatorType type) {
  for (const EstimatorType& e : estimators_)
    if (e.name == type.name) detail::fail_taken("estimator", type.name, name_);
  estimators_.push_back(std::move(type));
}

void Robot::add_specification(const std::string& text) {
  for (const std::string& e : estimators())
    if (e == text) detail::fail_taken("estimator", text, name_);
  estimator(text, Trace());
  specifications_.push_back(text);
}

const EstimatorType& Robot::estimator_type(std::string_view specification) const {
  return find_known(estimators_, "estimator", name_of_specification(specification),
                    [](const EstimatorType& e) { return e.name; });
}

std::vector<std::string> Robot::estimators() const {
  std::vector<std::string> all = names_of(estimators_, [](const auto&) { return true; });
  all.insert(all.end(), specifications_.begin(), specifications_.end());
  return all;
}

std::vector<std::string> Robot::tunable() const {
  return names_of(estimators_, [](const EstimatorType& e) { return e.tunable; });
}

const std::vector<FieldHelp>& Robot::estimator_fields(std::string_view name) const {
  return estimator_type(name).fields;
}

std::unique_ptr<EstimatorStage<>> Robot::estimator(std::string_view specification,
                                                   const Trace& trace) const {
  const EstimatorType& e = estimator_type(specification);
  if (e.copies_truth && !trace.has_truth())
    throw std::invalid_argument(
        fmt::format("estimator '{}' copies the truth: it needs columns tau_ext1..", e.name));
  return detail::made(specification, e.fields,
                      [&](const Specification& s) { return e.make(s, trace); });
}

std::unique_ptr<EstimatorStage<EstimatorType::Lanes>> Robot::estimator_of_runs(
    std::string_view specification, const Trace& trace, SharedTerms* terms) const {
  const EstimatorType& e = estimator_type(specification);
  if (!e.make_runs) return nullptr;
  return detail::made(specification, e.fields,
                      [&](const Specification& s) { return e.make_runs(s, trace, terms); });
}

std::vector<std::string> Robot::detectors() const {
  return names_of(detectors_, [](const auto&) { return true; });
}

std::vector<std::string> Robot::calibratable() const {
  return names_of(detectors_, [](const DetectorType& d) { return d.calibration.has_value(); });
}

void Robot::add_detector(const DetectorType& type) {
  for (const DetectorType& d : detectors_)
    if (d.name == type.name) detail::fail_taken("detector", type.name, name_);
  detectors_.push_back(type);
}

const DetectorType& Robot::detector_type(std::string_view specification) const {
  return find_known(detectors_, "detector", name_of_specification(specification),
                    [](const DetectorType& d) { return d.name; });
}

std::vector<std::string> Robot::trained_parts(std::string_view detector) const {
  const Specification whole = parse_specification(detector);
  std::vector<std::string> all;
  for (const detail::TrainedPart& part : detector_type(detector).trained_parts) {
    all.push_back(part.name);
    for (const auto& [key, value] : whole.keys) {
      if (key.starts_with(part.prefix))
        all.back() += fmt::format(":{}={}", key.substr(part.prefix.size()), value);
    }
  }
  return all;
}

const std::vector<FieldHelp>& Robot::detector_fields(std::string_view name) const {
  return detector_type(name).fields;
}

const Calibration& Robot::calibration(std::string_view detector) const {
  const DetectorType& d = detector_type(detector);
  if (d.calibration) return *d.calibration;
  throw unknown("calibratable detector", detector, calibratable());
}

std::unique_ptr<DetectorStage<>> Robot::detector(std::string_view specification,
                                                 const DetectorSettings& settings) const {
  const DetectorType& d = detector_type(specification);
  return detail::made(specification, d.fields,
                      [&](const Specification& s) { return d.make(s, settings, torques_); });
}

std::unique_ptr<DetectorStage<EstimatorType::Lanes>> Robot::detector_of_runs(
    std::string_view specification, const DetectorSettings& settings) const {
  return detail::made(specification, detector_fields(specification), [&](const Specification& s) {
    return detail::detector_of_runs<kRuns>(s, settings, torques_);
  });
}

Pair Robot::pair(std::string_view estimator, std::string_view detector, const Trace& trace,
                 const DetectorSettings& settings) const {
  if (trace.size() > 0) require_joints(trace.dof());
  return {this->estimator(estimator, trace),
          detector.empty() ? nullptr : this->detector(detector, settings)};
}

int Robot::runs_at_once() {
  return kRuns;
}

std::vector<Detection> Robot::detect(std::string_view detector, const Trace& trace,
                                     const Output& estimates,
                                     const DetectorSettings& settings) const {
  require_joints(trace.dof());
  std::vector<Detection> all(trace.t.size());
  this->detector(detector, settings)
      ->run({columns_of(trace), estimates.tau_ext.data(), estimates.status.data()}, all);
  return all;
}

void Robot::check(std::string_view estimator, std::string_view detector) const {
  Trace one;  // copies of the truth need a sample of it
  one.t = {0};
  one.q = one.qd = one.tau = one.tau_ext = Eigen::MatrixXd::Zero(dof_, 1);
  pair(estimator, detector, one);
}

Supervisor Robot::supervisor(std::string_view estimator, std::string_view detector,
                             const Drives& drives, const DetectorSettings& s) const {
  if (needs_truth(estimator)) {
    throw std::invalid_argument(
        fmt::format("estimator '{}' copies the truth: it cannot stop a motor", estimator));
  }
  if (detector.empty()) throw std::invalid_argument("a detector is wanted that stops the motor");
  Trace measured;
  measured.torque_at_instants = drives.elastic();
  return [both = std::make_shared<Pair>(pair(estimator, detector, measured, s)),
          tau_ext = std::vector<double>(static_cast<std::size_t>(dof_))](const Sample& y) mutable {
    return both->step(y.t, y.q.data(), y.qd.data(), y.tau.data(), tau_ext.data()).detection.mark;
  };
}

}  // namespace tauext

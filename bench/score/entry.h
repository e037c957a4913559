// SPDX-License-Identifier: Apache-2.0
/// @file
/// The rows of the suite, resolved once.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/roster/robots.h"
#include "mjcf/scenarios/scenario.h"

namespace tauext {

/// Which estimators and detectors run, as specifications, and on which robot. None means those of
/// the roster.
struct Selection {
  const Robot* robot = nullptr;         ///< else every one
  std::vector<std::string> estimators;  ///< by specification
  std::vector<std::string> detectors;   ///< also such as the studies alone run otherwise

  /// Nobody asked for estimators or detectors.
  bool empty() const { return estimators.empty() && detectors.empty(); }
};

/// The robots that run.
std::vector<const Robot*> robots_of(const Selection& selection);

/// One row of the suite: a robot, what happens to it, and the specifications of the estimator and
/// the detector (bench/roster/specification.h) that it runs.
class Entry {
 public:
  /// @param detector "" for none
  /// @throws std::invalid_argument for an unknown name or key or a value out of range, listing what
  /// is known
  Entry(std::string_view robot, std::string_view scenario, std::string_view estimator,
        std::string_view detector = "");

  /// One whose estimates were made elsewhere: it has a name, and cannot be run.
  /// @param group ROBOT/SCENARIO, or the log's name
  /// @param robot nullptr if nobody knows it
  static Entry made_elsewhere(const std::string& group, const std::string& estimator,
                              const std::string& detector, const Robot* robot);

  const Robot& robot() const { return *robot_; }           ///< that it runs on, if it has_robot()
  const Scenario& scenario() const { return *scenario_; }  ///< what happens to it, likewise
  bool has_robot() const { return robot_ != nullptr; }     ///< whether it is known
  const std::string& estimator() const { return estimator_; }  ///< its specification
  const std::string& detector() const { return detector_; }    ///< its specification; "" for none

  std::string name() const;   ///< ROBOT/SCENARIO/ESTIMATOR[+DETECTOR], by the robot's label
  std::string group() const;  ///< ROBOT/SCENARIO: the entries that compete

  /// Whether its own marks stop its motor.
  bool closed_loop() const { return !detector_.empty() && scenario_->reacts; }

  /// The same entry with another detector, which the robot is known to have; "" for none.
  Entry with_detector(const std::string& detector) const;

 private:
  friend std::vector<Entry> entries(const Selection& selection);
  Entry(const Robot& robot, const Scenario& scenario, const std::string& estimator)
      : robot_(&robot), scenario_(&scenario), estimator_(estimator) {}
  Entry() = default;

  const Robot* robot_ = nullptr;
  const Scenario* scenario_ = nullptr;
  std::string estimator_, detector_;
  std::string group_;  // made elsewhere; else ""
};

/// Every robot x scenario x estimator, and with a detector where it has something to detect (or to
/// leave in peace). A robot that does not have a selected estimator or detector has no row for it.
/// @throws std::invalid_argument for a specification that no robot understands, and for one that is
/// there twice
std::vector<Entry> entries(const Selection& selection = {});

/// Whether a name of an entry matches this regular expression somewhere; "" matches all.
/// @throws std::invalid_argument if it is none
std::function<bool(const std::string&)> entry_filter(const std::string& expression);

/// @throws std::invalid_argument always: no entry matches this filter
[[noreturn]] void fail_no_match(const std::string& expression);

}  // namespace tauext

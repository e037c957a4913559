// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <stdexcept>

#include "bench/detection_study.h"
#include "bench/parallel.h"
#include "bench/robot.h"
#include "bench/study_runs.h"

namespace tauext {
namespace {

using namespace study;  // NOLINT(google-build-using-namespace): our own halves

constexpr double kFloor = 0.05;  // of a default threshold: no calibrated one is lower
constexpr double kUnseen = 5;    // [N m] counts in a direction in which training shows nothing

// two passes over the training runs: what the metrics have to undo, then what is the largest
class Training {
 public:
  explicit Training(const CalibrationOptions& o)
      : o_(o),
        names_(o.conditions.empty() ? training_conditions()
                                    : chosen("condition", o.conditions, condition_names())),
        estimators_(chosen("estimator", o.estimators, all_estimators())) {
    for (const std::string& name : names_) {
      const double believed = condition(name).believed;
      believers_.try_emplace(believed, wallmobot3_believing(believed));
    }
    result_.margin = o.margin;
    result_.trained_on =
        fmt::format("wallmobot3, {}: {} runs each of free motion and slow pushes, seeds from {} on",
                    fmt::join(names_, ", "), o.runs, kTrainingSeed);
    for (const double velocity_noise : {1e-4, 1e-3}) {
      result_.sets.push_back({.robot = kRobot, .velocity_noise = velocity_noise});
    }
  }

  Thresholds run() {
    // by run, to be summed in order: a sum of rounded numbers depends on it
    std::map<const Trained*, std::map<int, Eigen::MatrixXd>> covariances;
    pass(0, [&](int i, const Robot& r, const std::string& d, const Trace& t, const Output& out,
                const Trained& to) {
      if (!r.calibration(d).has_metric) return;
      const Eigen::MatrixXd C = r.covariance(d, t, out, {.start_up = kStartUp}, kScoreFrom);
      const std::lock_guard lock(mutex_);
      covariances[&to][i] = C;
    });
    for_each([&](const std::string&, Trained& to) {
      const auto found = covariances.find(&to);
      if (found == covariances.end()) return;
      const auto& runs = found->second;
      const auto n = runs.begin()->second.rows();
      Eigen::MatrixXd C = Eigen::MatrixXd::Zero(n, n);
      for (const auto& [i, part] : runs) C += part / static_cast<double>(runs.size());
      to.metric = (Eigen::MatrixXd::Identity(n, n) + C / (kUnseen * kUnseen)).inverse();
      to.metric = Eigen::MatrixXd((to.metric + to.metric.transpose()) / 2);
    });
    pass(1, [&](int, const Robot& r, const std::string& d, const Trace& t, const Output& out,
                Trained& to) {
      // thresholds that nothing reaches, so that nothing saturates at them
      Trained none{Eigen::VectorXd::Constant(r.dof, 1e12), to.metric};
      const DetectorSettings settings{{{d, none}}, kStartUp};
      const Eigen::VectorXd largest = r.largest_statistic(d, t, out, settings, kScoreFrom);
      const std::lock_guard lock(mutex_);
      to.threshold =
          to.threshold.size() == 0 ? largest : Eigen::VectorXd(to.threshold.cwiseMax(largest));
    });
    for_each([&](const std::string& detector, Trained& to) {
      const Calibration& c = robot(kRobot).calibration(detector);
      // a statistic that training leaves at 0, like a sum below its drift, would have no threshold
      to.threshold = (to.threshold * std::pow(o_.margin, c.degree)).cwiseMax(kFloor * c.threshold);
    });
    return std::move(result_);
  }

 private:
  // calls look(number of the run, robot, detector, trace, estimates, what is known) for all runs, estimators, detectors
  template <class Look>
  void pass(int number, Look&& look) {
    // all places exist before threads write to them
    for (ThresholdSet& set : result_.sets) {
      for (const std::string& e : estimators_) {
        for (const std::string& d : robot(kRobot).calibratable) set.by_estimator[e][d];
      }
    }
    const int count = static_cast<int>(names_.size());
    const auto work = [&](int i) {
      const Condition& c = condition(names_[i % count]);
      const Job job{plant_of(c), TouchKind::kSlowPush, kTrainingSeed + i / count};
      const Trace truth = study::simulate(job, model_of(job.plant));
      const Robot& r = believers_.at(c.believed);
      for (ThresholdSet& set : result_.sets) {
        Sensors sensors = c.degradation.sensors;
        sensors.velocity_noise = set.velocity_noise;
        const Trace t = measured(truth, sensors, job);
        for (const std::string& e : estimators_) {
          const Output estimates = r.runner(e, "", t)->run();
          for (auto& [d, trained] : set.by_estimator.at(e)) look(i, r, d, t, estimates, trained);
        }
      }
    };
    parallel_for(count * o_.runs, o_.threads, work, [&](double share) {
      if (o_.progress) o_.progress((number + share) / 2);
    });
  }

  template <class Change>
  void for_each(Change&& change) {
    for (ThresholdSet& set : result_.sets) {
      for (auto& [estimator, by_detector] : set.by_estimator) {
        for (auto& [detector, trained] : by_detector) change(detector, trained);
      }
    }
  }

  const CalibrationOptions& o_;
  std::vector<std::string> names_, estimators_;
  std::map<double, Robot> believers_;
  Thresholds result_;
  std::mutex mutex_;  // of result_
};

}  // namespace

const std::vector<std::string>& training_conditions() {
  static const std::vector<std::string> all = {"known_0", "known_50", "known_150", "unknown_50",
                                               "unknown_150"};
  return all;
}

Thresholds calibrate(const CalibrationOptions& o) {
  if (o.runs < 1) throw std::invalid_argument("calibration needs at least one run");
  if (!(o.margin >= 1)) {
    throw std::invalid_argument(fmt::format("a margin of {} is below 1", o.margin));
  }
  return Training(o).run();
}

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
#include "bench/study/calibration.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <stdexcept>

#include "bench/roster/robots.h"
#include "bench/score/parallel.h"
#include "bench/study/study_runs.h"

namespace tauext::study {
namespace {

constexpr double kFloor = 0.05;  // of a default threshold: no calibrated one is lower

std::string name_of(const std::string& specification) {
  return std::string(name_of_specification(specification));
}

// all that can be calibrated, and specifications of them that were asked for
std::vector<std::string> trained_detectors(const Robot& r, const std::vector<std::string>& asked) {
  std::vector<std::string> all = r.calibratable();
  if (asked.empty()) return all;
  for (const std::string& d : chosen_detectors(r, asked)) {
    const bool can = std::count(all.begin(), all.end(), name_of(d)) > 0;
    if (can && std::count(all.begin(), all.end(), d) == 0) all.push_back(d);
  }
  return all;
}

// what undoes the covariances of training, run by run in their order: a sum of rounded numbers
// depends on it. `unseen` [N m] counts where training shows nothing, joint by joint
Eigen::MatrixXd metric_of(const std::map<int, Eigen::MatrixXd>& covariances,
                          const Eigen::VectorXd& unseen) {
  const auto n = covariances.begin()->second.rows();
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(n, n);
  for (const auto& [run, part] : covariances) C += part / static_cast<double>(covariances.size());
  const Eigen::MatrixXd floor = unseen.cwiseAbs2().asDiagonal();
  const Eigen::MatrixXd metric = (floor + C).inverse() * unseen.cwiseAbs2().maxCoeff();
  return (metric + metric.transpose()) / 2;
}

// two passes over the training runs: what the metrics have to undo, then what is the largest
class Training {
 public:
  explicit Training(const CalibrationOptions& o)
      : o_(o),
        runs_(touched_runs(o.robot)),
        robot_(robot(runs_.robot)),
        names_(chosen_conditions(runs_, o.conditions, runs_.training)) {
    const std::vector<std::string> estimators = chosen_estimators(robot_, o.estimators);
    const std::vector<std::string> detectors = trained_detectors(robot_, o.detectors);
    for (const std::string& name : names_) {
      const double believed = condition(runs_, name).believed;
      if (!believers_.contains(believed)) believers_[believed] = runs_.believer(believed);
    }
    result_.margin = o.margin;
    result_.trained_on =
        fmt::format("{}, {}: {} runs each of free motion and slow pushes, seeds from {} on",
                    runs_.robot, fmt::join(names_, ", "), o.runs, kTrainingSeed);
    // all places exist before threads write to them
    for (const double velocity_noise : {1e-4, 1e-3}) {
      ThresholdSet set{.robot = runs_.robot,
                       .fingerprint = robot(runs_.robot).fingerprint(),
                       .velocity_noise = velocity_noise};
      for (const std::string& e : estimators) {
        for (const std::string& d : detectors) set.by_estimator[e][d];
      }
      result_.sets.push_back(std::move(set));
    }
  }

  Thresholds run() {
    find_metrics();
    find_thresholds();
    return std::move(result_);
  }

 private:
  void find_metrics() {
    std::map<const Trained*, std::map<int, Eigen::MatrixXd>> covariances;  // by run
    pass(0, [&](int i, const Robot& r, const std::string& d, const Trace& t, const Output& out,
                const Trained& to) {
      if (!r.calibration(d).has_metric) return;
      const Eigen::MatrixXd C = r.covariance(d, t, out, {.start_up = kStartUp}, kScoreFrom);
      const std::lock_guard lock(mutex_);
      covariances[&to][i] = C;
    });
    for_each([&](const std::string&, Trained& to) {
      const auto found = covariances.find(&to);
      if (found != covariances.end()) to.metric = metric_of(found->second, robot_.small_torque());
    });
  }

  void find_thresholds() {
    pass(1, [&](int, const Robot& r, const std::string& d, const Trace& t, const Output& out,
                Trained& to) {
      // thresholds that nothing reaches, so that nothing saturates at them
      const Trained none{Eigen::VectorXd::Constant(r.dof(), 1e12), to.metric};
      const DetectorSettings settings{{{name_of(d), none}}, kStartUp};
      const Eigen::VectorXd largest = r.largest_statistic(d, t, out, settings, kScoreFrom);
      const std::lock_guard lock(mutex_);
      to.threshold =
          to.threshold.size() == 0 ? largest : Eigen::VectorXd(to.threshold.cwiseMax(largest));
    });
    for_each([&](const std::string& detector, Trained& to) {
      const Calibration& c = robot_.calibration(detector);
      // a statistic that training leaves at 0, like a sum below its drift, would have no threshold
      to.threshold = (to.threshold * std::pow(o_.margin, c.degree)).cwiseMax(kFloor * c.threshold);
    });
  }

  // calls look(number of the run, robot, detector, trace, estimates, what is known) for all runs,
  // estimators, detectors
  template <class Look>
  void pass(int number, Look&& look) {
    const int count = static_cast<int>(names_.size());
    const auto work = [&](int i) {
      const Condition& c = condition(runs_, names_[static_cast<std::size_t>(i % count)]);
      const Job job{plant_of(c), TouchKind::kSlowPush,
                    kTrainingSeed + static_cast<std::uint64_t>(i / count)};
      const Trace truth = simulated(runs_, job, runs_.model(job.plant));
      const Robot& r = *believers_.at(c.believed);
      for (ThresholdSet& set : result_.sets) {
        Sensors sensors = c.degradation.sensors;
        sensors.velocity_noise = set.velocity_noise;
        const Trace t = measured(truth, sensors, job);
        for (auto& [e, by_detector] : set.by_estimator) {
          const Output estimates = r.runner(e, "", t)->run();
          for (auto& [d, trained] : by_detector) look(i, r, d, t, estimates, trained);
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
  const StudyRuns& runs_;
  const Robot& robot_;
  std::vector<std::string> names_;
  std::map<double, std::shared_ptr<const Robot>> believers_;
  Thresholds result_;
  std::mutex mutex_;  // of result_
};

}  // namespace

Thresholds calibrate(const CalibrationOptions& o) {
  if (o.runs < 1) throw std::invalid_argument("calibration needs at least one run");
  if (!(o.margin >= 1)) {
    throw std::invalid_argument(fmt::format("a margin of {} is below 1", o.margin));
  }
  return Training(o).run();
}

}  // namespace tauext::study

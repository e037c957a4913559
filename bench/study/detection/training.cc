// SPDX-License-Identifier: Apache-2.0
#include "bench/study/detection/training.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "bench/score/parallel.h"
#include "bench/study/study_runs.h"
#include "estimators/samples/clock.h"

namespace tauext::study {
namespace {

constexpr double kFloor = 0.05;  // of a default threshold: no calibrated one is lower

std::string name_of(const std::string& specification) {
  return std::string(name_of_specification(specification));
}

// all that can be calibrated, or those that were asked for and what these are made of
std::vector<std::string> trained_detectors(const Robot& r, const std::vector<std::string>& asked) {
  if (asked.empty()) return r.calibratable();
  std::vector<std::string> trained;
  for (const std::string& d : chosen_detectors(r, asked)) {
    for (const std::string& part : r.trained_parts(d)) {
      if (std::count(trained.begin(), trained.end(), part) == 0) trained.push_back(part);
    }
  }
  return trained;
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
  Training(const CalibrationOptions& o, const Robot& robot, Source source,
           const std::vector<Quality>& qualities, std::string trained_on)
      : o_(o), robot_(robot), source_(std::move(source)) {
    if (!(o.margin >= 1))
      throw std::invalid_argument(fmt::format("a margin of {} is below 1", o.margin));
    result_.margin = o.margin;
    result_.trained_on = std::move(trained_on);
    // all places exist before threads write to them
    for (const Quality& q : qualities) {
      ThresholdSet set{.robot = robot.name(),
                       .fingerprint = robot.fingerprint(),
                       .velocity_noise = q.velocity_noise,
                       .condition = q.condition};
      add_places(set);
      result_.sets.push_back(std::move(set));
    }
  }

  Thresholds run() {
    find_metrics();
    find_thresholds();
    return result_;
  }

  // every run by the thresholds of all others
  std::vector<HeldOut> held_out() const {
    std::vector<HeldOut> rows;
    if (source_.runs < 2) return rows;
    for_each(result_, [&](const std::string& e, const std::string& d, const Trained& trained) {
      HeldOut row{e, d, source_.runs, 0};
      for (int i = 0; i < source_.runs; ++i) {
        const Eigen::ArrayXd threshold = threshold_of(d, trained, i);
        row.alarms += (largest_.at(&trained).at(i).array() > threshold).any();
      }
      rows.push_back(std::move(row));
    });
    return rows;
  }

 private:
  void add_places(ThresholdSet& set) const {
    for (const auto& [e, d] : o_.pairs) {
      for (const std::string& part : trained_detectors(robot_, {d})) set.by_estimator[e][part];
    }
    if (!o_.pairs.empty()) return;
    for (const std::string& e : chosen_estimators(robot_, o_.estimators)) {
      for (const std::string& d : trained_detectors(robot_, o_.detectors)) set.by_estimator[e][d];
    }
  }

  template <class Value>
  using ByRun = std::map<const Trained*, std::map<int, Value>>;

  void find_metrics() {
    bool any = false;
    for_each(result_, [&](const std::string&, const std::string& d, const Trained&) {
      any = any || robot_.calibration(d).has_metric;
    });
    if (!any) return;
    ByRun<Eigen::MatrixXd> covariances;
    pass(0, [&](const Seen& s, const std::string& d, Session& runs, const Trained& to) {
      if (!s.robot.calibration(d).has_metric) return;
      const std::vector<Eigen::MatrixXd> of_runs =
          runs.covariance({d, {{}, kStartUp}}, begin_of(s));
      const std::lock_guard lock(mutex_);
      for (std::size_t i = 0; i < of_runs.size(); ++i) covariances[&to][s.runs[i]] = of_runs[i];
    });
    for_each(result_, [&](const std::string&, const std::string&, Trained& to) {
      const auto found = covariances.find(&to);
      if (found != covariances.end()) to.metric = metric_of(found->second, robot_.small_torque());
    });
  }

  void find_thresholds() {
    pass(1, [&](const Seen& s, const std::string& d, Session& runs, const Trained& to) {
      // thresholds that nothing reaches, so that nothing saturates at them
      const Trained none{Eigen::VectorXd::Constant(s.robot.dof(), 1e12), to.metric};
      const std::vector<Eigen::VectorXd> of_runs =
          runs.largest_statistic({d, {{{name_of(d), none}}, kStartUp}}, begin_of(s));
      const std::lock_guard lock(mutex_);
      for (std::size_t i = 0; i < of_runs.size(); ++i) {
        Eigen::VectorXd& known = largest_[&to][s.runs[i]];
        known = known.size() == 0 ? of_runs[i] : Eigen::VectorXd(known.cwiseMax(of_runs[i]));
      }
    });
    for_each(result_, [&](const std::string&, const std::string& d, Trained& to) {
      to.threshold = threshold_of(d, to, -1);
    });
  }

  // [s] when estimators that began there, after a stray row or a gap again, have run for kScoreFrom
  static double begin_of(const Seen& s) {
    Clock clock(kScoreFrom);
    const std::vector<double>& t = s.traces.front().t;
    double from = t.front();
    for (const double at : t) {
      const Status status = clock.accept(at);
      if (status == Status::kStarted) from = at;
      if (status == Status::kOk && at - from >= kScoreFrom) break;
    }
    return from + kScoreFrom;
  }

  // from all runs but that one
  Eigen::VectorXd threshold_of(const std::string& detector, const Trained& trained,
                               int without) const {
    Eigen::VectorXd largest = Eigen::VectorXd::Zero(robot_.dof());
    for (const auto& [run, of_run] : largest_.at(&trained)) {
      if (run != without) largest = largest.cwiseMax(of_run);
    }
    const Calibration& c = robot_.calibration(detector);
    // a statistic that training leaves at 0, like a sum below its drift, would have no threshold
    return (largest * std::pow(o_.margin, c.degree)).cwiseMax(kFloor * c.threshold);
  }

  // calls visit(what is seen, detector, estimates, what is known) for all runs, estimators,
  // detectors
  template <class Visit>
  void pass(int number, Visit&& visit) {
    const auto work = [&](int batch) {
      source_.show(batch, [&](const Seen& s) {
        std::unique_ptr<Session> own;
        if (s.estimated == nullptr) own = make_session(s.robot, s.traces);
        for (auto& [e, by_detector] : result_.sets[s.set].by_estimator) {
          if (own) require_estimates(s, e, own->estimate(e));
          for (auto& [d, trained] : by_detector) visit(s, d, own ? *own : *s.estimated, trained);
        }
      });
    };
    parallel_for(source_.batches, o_.threads, work, [&](double share) {
      if (o_.progress) o_.progress((number + share) / 2);
    });
  }

  static void require_estimates(const Seen& s, const std::string& estimator,
                                const std::vector<std::string>& why) {
    if (s.name.empty() || why.front().empty()) return;
    throw std::invalid_argument(fmt::format("{}: {}: {}", s.name, estimator, why.front()));
  }

  template <class All, class Visit>
  static void for_each(All& thresholds, Visit&& visit) {
    for (auto& set : thresholds.sets) {
      for (auto& [estimator, by_detector] : set.by_estimator) {
        for (auto& [detector, trained] : by_detector) visit(estimator, detector, trained);
      }
    }
  }

  const CalibrationOptions& o_;
  const Robot& robot_;
  Source source_;
  Thresholds result_;
  std::mutex mutex_;
  ByRun<Eigen::VectorXd> largest_;  // [the statistic's unit] joint by joint
};

}  // namespace

Thresholds train(const CalibrationOptions& options, const Robot& robot, Source source,
                 const std::vector<Quality>& qualities, std::string trained_on,
                 std::vector<HeldOut>* held_out) {
  Training training(options, robot, std::move(source), qualities, std::move(trained_on));
  Thresholds thresholds = training.run();
  if (held_out != nullptr) *held_out = training.held_out();
  return thresholds;
}

}  // namespace tauext::study

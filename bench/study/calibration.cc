// SPDX-License-Identifier: Apache-2.0
#include "bench/study/calibration.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>

#include "bench/roster/robots.h"
#include "bench/score/parallel.h"
#include "bench/study/study_runs.h"

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
    for (const std::string& part : r.trained_parts(name_of(d))) {
      const std::string& own = part == name_of(d) ? d : part;
      if (std::count(trained.begin(), trained.end(), own) == 0) trained.push_back(own);
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

// runs as sensors of one quality see them, for one session
struct Seen {
  std::size_t set;  // of thresholds
  const Robot& robot;
  std::span<const Trace> traces;  // of one clock
  std::vector<int> runs;          // which ones these are
  const std::string& name;        // of a recording
};
using Look = std::function<void(const Seen&)>;

// where training runs come from, batch by batch
struct Source {
  int runs, batches;
  std::function<void(int batch, const Look& look)> show;
};

// two passes over the training runs: what the metrics have to undo, then what is the largest
class Training {
 public:
  Training(const CalibrationOptions& o, const Robot& robot, Source source,
           const std::vector<double>& velocity_noises, std::string trained_on)
      : o_(o), robot_(robot), source_(std::move(source)) {
    if (!(o.margin >= 1))
      throw std::invalid_argument(fmt::format("a margin of {} is below 1", o.margin));
    result_.margin = o.margin;
    result_.trained_on = std::move(trained_on);
    // all places exist before threads write to them
    for (const double velocity_noise : velocity_noises) {
      ThresholdSet set{.robot = robot.name(),
                       .fingerprint = robot.fingerprint(),
                       .velocity_noise = velocity_noise};
      for (const std::string& e : chosen_estimators(robot, o.estimators)) {
        for (const std::string& d : trained_detectors(robot, o.detectors)) set.by_estimator[e][d];
      }
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
  template <class Value>
  using ByRun = std::map<const Trained*, std::map<int, Value>>;

  void find_metrics() {
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

  static double begin_of(const Seen& s) { return s.traces.front().t.front() + kScoreFrom; }

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
        const std::unique_ptr<Session> session = s.robot.session(s.traces);
        for (auto& [e, by_detector] : result_.sets[s.set].by_estimator) {
          require_estimates(s, e, session->estimate(e));
          for (auto& [d, trained] : by_detector) visit(s, d, *session, trained);
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

void require_free(const FreeRecording& r, const Robot& robot) {
  const Trace& t = r.trace;
  const auto fail = [&](const std::string& why) {
    throw std::invalid_argument(fmt::format("{}: {}", r.name, why));
  };
  robot.require_joints(t, r.name);
  const double length = t.size() == 0 ? 0 : t.t.back() - t.t.front();
  if (length < 2 * kScoreFrom)
    fail(fmt::format("{:.3g} s long; {:g} s are needed, of which the first {:g} do not count",
                     length, 2 * kScoreFrom, kScoreFrom));
  const auto contact =
      std::find_if(t.contact.begin(), t.contact.end(), [](auto c) { return c != 0; });
  if (contact != t.contact.end())
    fail(
        fmt::format("something touches at {:g} s, by its column contact; thresholds come from "
                    "recordings without",
                    t.t[static_cast<std::size_t>(contact - t.contact.begin())]));
}

}  // namespace

Thresholds calibrate(const CalibrationOptions& o) {
  if (o.runs < 1) throw std::invalid_argument("calibration needs at least one run");
  const StudyRuns& runs = touched_runs(o.robot);
  const Robot& r = robot(runs.robot);
  const std::vector<std::string> names = chosen_conditions(runs, o.conditions, runs.training);
  std::set<double> noises = {1e-4, 1e-3};
  for (const std::string& name : names)
    noises.insert(condition(runs, name).degradation.sensors.velocity_noise);
  const std::vector<double> velocity_noises(noises.begin(), noises.end());
  std::map<double, std::shared_ptr<const Robot>> believers;
  for (const std::string& name : names) {
    const double believed = condition(runs, name).believed;
    if (!believers.contains(believed)) believers[believed] = runs.believer(believed);
  }
  // a batch has runs of one condition
  const int count = static_cast<int>(names.size()), most = r.runs_at_once();
  const int batches_of_one = (o.runs + most - 1) / most;
  const auto show = [&](int batch, const Look& look) {
    const int which_name = batch % count, from = batch / count * most;
    const Condition& c = condition(runs, names[static_cast<std::size_t>(which_name)]);
    const PlantKey plant = plant_of(c);
    const Model model = runs.model(plant);
    std::vector<Job> jobs;
    std::vector<int> which;
    for (int i = from; i < std::min(from + most, o.runs); ++i) {
      which.push_back(i * count + which_name);
      jobs.push_back({plant, TouchKind::kSlowPush, kTrainingSeed + static_cast<std::uint64_t>(i)});
    }
    Views views(simulated(runs, jobs, model), jobs);
    for (std::size_t set = 0; set < velocity_noises.size(); ++set) {
      Sensors sensors = c.degradation.sensors;
      sensors.velocity_noise = velocity_noises[set];
      const std::vector<Trace> seen = views.by(sensors, c.every);
      look({set, *believers.at(c.believed), seen, which, ""});
    }
  };
  return Training(
             o, r, {count * o.runs, count * batches_of_one, show}, velocity_noises,
             fmt::format("{}, {}: {} runs each of free motion and slow pushes, seeds from {} on",
                         runs.robot, fmt::join(names, ", "), o.runs, kTrainingSeed))
      .run();
}

Thresholds calibrate_on(const Robot& r, const std::vector<FreeRecording>& recordings,
                        const CalibrationOptions& o, std::vector<HeldOut>& held_out) {
  if (recordings.empty()) throw std::invalid_argument("no recording to calibrate from");
  double seconds = 0;
  std::vector<std::string> names;
  for (const FreeRecording& x : recordings) {
    require_free(x, r);
    seconds += x.trace.t.back() - x.trace.t.front() - kScoreFrom;
    names.push_back(x.name);
  }
  const auto show = [&](int i, const Look& look) {
    const FreeRecording& x = recordings[static_cast<std::size_t>(i)];
    look({0, r, {&x.trace, 1}, {i}, x.name});
  };
  const int count = static_cast<int>(recordings.size());
  Training training(o, r, {count, count, show}, {0},
                    fmt::format("{}, {:.0f} s of {}", r.name(), seconds, fmt::join(names, ", ")));
  Thresholds thresholds = training.run();
  held_out = training.held_out();
  return thresholds;
}

}  // namespace tauext::study

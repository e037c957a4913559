// SPDX-License-Identifier: Apache-2.0
#include "bench/detection_study.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <stdexcept>

#include "bench/parallel.h"
#include "bench/robot.h"
#include "bench/suite.h"
#include "mjcf/touch.h"

namespace tauext {
namespace {

constexpr const char* kRobot = "wallmobot3";
constexpr double kScoreFrom = 4;     // [s] an estimator has found an unknown panel by then
constexpr double kStartUp = 3;       // [s] detectors stay silent
constexpr double kWindow = 0.2;      // [s] after a blow in which a mark still belongs to it
constexpr double kRefractory = 0.2;  // [s] between two crossings of a level
constexpr double kFloor = 0.05;      // of a default threshold: no calibrated one is lower

Degradation noise(double velocity_noise) {
  Degradation d;
  d.sensors.velocity_noise = velocity_noise;
  return d;
}

Degradation hysteresis() {
  Degradation d = noise(1e-4);
  d.sensors.loadcell.hysteresis = 0.002;  // of 3000 N m
  return d;
}

Degradation dry_friction() {
  Degradation d = noise(1e-4);
  d.model_error.friction = 5;  // [N m]
  return d;
}

// conditions that differ in the sensors alone share their simulated runs
struct PlantKey {
  double panel, friction;
  auto operator<=>(const PlantKey&) const = default;  // NOLINT(modernize-use-nullptr): not ours
};

PlantKey plant_of(const Condition& c) {
  return {c.panel, c.degradation.model_error.friction};
}

Model model_of(const PlantKey& p) {
  return with_errors(wallmobot3_with_panel(p.panel), {.friction = p.friction});
}

constexpr double kUnseen = 5;  // [N m] counts in a direction in which training shows nothing

// one run to simulate
struct Job {
  PlantKey plant;
  TouchKind kind;
  std::uint64_t seed;
};

// seeds from `first` on until their runs hold `count` touches
void add_jobs(const PlantKey& plant, TouchKind kind, std::uint64_t first, int count,
              std::vector<Job>& jobs) {
  for (std::uint64_t seed = first; count > 0; ++seed) {
    jobs.push_back({plant, kind, seed});
    count -= static_cast<int>(touches_of_wallmobot3(kind, seed).size());
  }
}

std::vector<Job> jobs_of(const PlantKey& plant, const StudyOptions& o) {
  std::vector<Job> jobs;
  add_jobs(plant, TouchKind::kBlow, o.first_seed, o.blows, jobs);
  add_jobs(plant, TouchKind::kBriskPush, o.first_seed, o.brisk_pushes, jobs);
  add_jobs(plant, TouchKind::kClamp, o.first_seed, o.clampings, jobs);
  const double scored = touched_wallmobot3(TouchKind::kSlowPush, 1).duration - kScoreFrom;
  const int runs = static_cast<int>(std::ceil(o.hours * 3600 / scored - 1e-9));
  for (int i = 0; i < runs; ++i) jobs.push_back({plant, TouchKind::kSlowPush, o.first_seed + i});
  return jobs;
}

Trace simulate(const Job& job, const Model& model) {
  return simulate(model, touched_wallmobot3(job.kind, job.seed));
}

Trace measured(const Trace& truth, Sensors sensors, const Job& job) {
  sensors.seed = 4 * job.seed + static_cast<std::uint64_t>(job.kind);
  return measure(truth, sensors);
}

// times [s] at which the score rises through a level
std::vector<double> crossings(const Trace& t, const std::vector<Detection>& d, double level) {
  std::vector<double> at;
  bool above = true;  // nothing rises at the first sample
  for (std::size_t k = 0; k < d.size(); ++k) {
    const bool now = d[k].score >= level;
    const bool late = at.empty() || t.t[k] - at.back() >= kRefractory;
    if (now && !above && late && t.t[k] >= kScoreFrom) at.push_back(t.t[k]);
    above = now;
  }
  return at;
}

bool belongs_to(double mark, const Touch& touch) {
  return mark >= touch.begin && mark <= touch.end() + kWindow;
}

int count_detected(const std::vector<double>& marks, const std::vector<Touch>& touches) {
  return static_cast<int>(std::count_if(touches.begin(), touches.end(), [&](const Touch& touch) {
    return std::any_of(marks.begin(), marks.end(), [&](double m) { return belongs_to(m, touch); });
  }));
}

struct Mark {
  double t;
  Contact contact;
};

std::vector<Mark> marks_of(const Trace& t, const std::vector<Detection>& d) {
  std::vector<Mark> marks;
  for (std::size_t k = 0; k < d.size(); ++k) {
    if (d[k].mark && t.t[k] >= kScoreFrom) marks.push_back({t.t[k], d[k].contact});
  }
  return marks;
}

void count_blows(const Trace& t, const std::vector<Detection>& d, const std::vector<Touch>& touches,
                 Cell& cell) {
  const std::vector<Mark> marks = marks_of(t, d);
  int belonging = 0;
  for (const Touch& touch : touches) {
    const auto mine = [&](const Mark& m) { return belongs_to(m.t, touch); };
    const auto first = std::find_if(marks.begin(), marks.end(), mine);
    belonging += static_cast<int>(std::count_if(marks.begin(), marks.end(), mine));
    if (first != marks.end()) cell.delays.push_back(first->t - touch.begin);
  }
  cell.blows += static_cast<int>(touches.size());
  cell.detected = static_cast<int>(cell.delays.size());
  cell.stray += static_cast<int>(marks.size()) - belonging;
  for (std::size_t i = 0; i < kLevels.size(); ++i) {
    cell.detected_at[i] += count_detected(crossings(t, d, kLevels[i]), touches);
  }
}

void count_alarms(const Trace& t, const std::vector<Detection>& d, Cell& cell) {
  for (const Mark& m : marks_of(t, d)) {
    ++cell.alarms;
    cell.collision_alarms += m.contact == Contact::kCollision;
  }
  for (std::size_t k = 0; k < d.size(); ++k) {
    if (t.t[k] < kScoreFrom) continue;
    ++cell.quiet_samples;
    cell.alarmed_samples += d[k].score >= 1;
  }
  for (std::size_t i = 0; i < kLevels.size(); ++i) {
    cell.alarms_at[i] += static_cast<int>(crossings(t, d, kLevels[i]).size());
  }
}

void count_brisk(const Trace& t, const std::vector<Detection>& d, const std::vector<Touch>& touches,
                 Cell& cell) {
  const std::vector<Mark> marks = marks_of(t, d);
  for (const Touch& touch : touches) {
    ++cell.brisk;
    cell.brisk_flagged += std::any_of(marks.begin(), marks.end(),
                                      [&](const Mark& m) { return belongs_to(m.t, touch); });
  }
}

void count_clampings(const Trace& t, const std::vector<Detection>& d,
                     const std::vector<Touch>& touches, Cell& cell) {
  const std::vector<Mark> marks = marks_of(t, d);
  for (const Touch& touch : touches) {
    // caught in time: before it lets go
    const auto within = [&](const Mark& m) {
      return m.t >= touch.begin && m.t < touch.end() - touch.fall;
    };
    ++cell.clampings;
    cell.clampings_flagged += std::any_of(marks.begin(), marks.end(), within);
    cell.clampings_named += std::any_of(marks.begin(), marks.end(), [&](const Mark& m) {
      return within(m) && m.contact == Contact::kClamping;
    });
  }
}

void count(const Job& job, const Trace& t, const std::vector<Detection>& d,
           const std::vector<Touch>& touches, Cell& cell) {
  switch (job.kind) {
    case TouchKind::kBlow:
      return count_blows(t, d, touches, cell);
    case TouchKind::kSlowPush:
      return count_alarms(t, d, cell);
    case TouchKind::kBriskPush:
      return count_brisk(t, d, touches, cell);
    case TouchKind::kClamp:
      return count_clampings(t, d, touches, cell);
  }
}

// what one run adds to a cell
void add(const Cell& run, Cell& sum) {
  sum.runs += run.runs;
  sum.failed_runs += run.failed_runs;
  sum.blows += run.blows;
  sum.detected += run.detected;
  sum.stray += run.stray;
  sum.delays.insert(sum.delays.end(), run.delays.begin(), run.delays.end());
  sum.quiet_samples += run.quiet_samples;
  sum.alarmed_samples += run.alarmed_samples;
  sum.alarms += run.alarms;
  sum.collision_alarms += run.collision_alarms;
  sum.brisk += run.brisk;
  sum.brisk_flagged += run.brisk_flagged;
  sum.clampings += run.clampings;
  sum.clampings_flagged += run.clampings_flagged;
  sum.clampings_named += run.clampings_named;
  for (std::size_t i = 0; i < kLevels.size(); ++i) {
    sum.detected_at[i] += run.detected_at[i];
    sum.alarms_at[i] += run.alarms_at[i];
  }
}

std::vector<std::string> all_estimators() {
  std::vector<std::string> names = robot(kRobot).estimators;
  std::erase_if(names, [](const std::string& n) { return is_baseline(n); });
  return names;
}

// the ones asked for, or all
std::vector<std::string> chosen(const char* what, const std::vector<std::string>& asked,
                                const std::vector<std::string>& known) {
  for (const std::string& name : asked) {
    if (std::count(known.begin(), known.end(), name) > 0) continue;
    throw std::invalid_argument(
        fmt::format("unknown {} '{}'; known: {}", what, name, fmt::join(known, ", ")));
  }
  return asked.empty() ? known : asked;
}

std::vector<std::string> condition_names() {
  std::vector<std::string> names;
  for (const Condition& c : conditions()) names.push_back(c.name);
  return names;
}

// the study's tables, and the work on one run
class Study {
 public:
  Study(const StudyOptions& o, const Thresholds& thresholds)
      : estimators_(chosen("estimator", o.estimators, all_estimators())),
        detectors_(chosen("detector", o.detectors, robot(kRobot).detectors)) {
    for (const std::string& name : chosen("condition", o.conditions, condition_names())) {
      const Condition& c = condition(name);
      conditions_.push_back(&c);
      believers_.try_emplace(c.believed, wallmobot3_believing(c.believed));
      models_.try_emplace(plant_of(c), nullptr);
      sets_.push_back(thresholds.of(kRobot, c.degradation.sensors.velocity_noise));
      for (const std::string& e : estimators_) {
        for (const std::string& d : detectors_) {
          cells_.push_back({.condition = name, .estimator = e, .detector = d});
        }
      }
    }
    for (auto& [plant, model] : models_) {
      model = model_of(plant);
      const std::vector<Job> jobs = jobs_of(plant, o);
      jobs_.insert(jobs_.end(), jobs.begin(), jobs.end());
    }
  }

  int size() const { return static_cast<int>(jobs_.size()); }

  void run(int i) {
    const Job& job = jobs_[i];
    const Trace truth = simulate(job, models_.at(job.plant));
    const std::vector<Touch> touches = touches_of_wallmobot3(job.kind, job.seed);
    for (std::size_t c = 0; c < conditions_.size(); ++c) {
      if (plant_of(*conditions_[c]) != job.plant) continue;
      run(job, c, measured(truth, conditions_[c]->degradation.sensors, job), touches);
    }
  }

  std::vector<Cell> cells() && {
    for (Cell& c : cells_) std::sort(c.delays.begin(), c.delays.end());
    return std::move(cells_);
  }

 private:
  void run(const Job& job, std::size_t c, const Trace& t, const std::vector<Touch>& touches) {
    const Robot& r = believers_.at(conditions_[c]->believed);
    std::vector<Cell> adds;
    for (const std::string& e : estimators_) {
      const Output estimates = r.runner(e, "", t)->run();
      const bool failed = !bad_status(t, estimates).empty();
      const auto known = sets_[c].by_estimator.find(e);
      const DetectorSettings settings{
          known == sets_[c].by_estimator.end() ? DetectorThresholds{} : known->second, kStartUp};
      for (const std::string& d : detectors_) {
        Cell cell{.runs = 1, .failed_runs = failed};
        count(job, t, r.detect(d, t, estimates, settings), touches, cell);
        adds.push_back(std::move(cell));
      }
    }
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < adds.size(); ++i) add(adds[i], cells_[c * adds.size() + i]);
  }

  std::vector<std::string> estimators_, detectors_;
  std::vector<const Condition*> conditions_;
  std::vector<ThresholdSet> sets_;     // of each condition
  std::map<double, Robot> believers_;  // by the panel that they believe in
  std::map<PlantKey, Model> models_;
  std::vector<Job> jobs_;
  std::vector<Cell> cells_;
  std::mutex mutex_;  // of cells_
};

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
      const Trace truth = simulate(job, model_of(job.plant));
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

const std::vector<Condition>& conditions() {
  static const std::vector<Condition> all = {
      {"known_0", "no panel, and the estimators know", 0, 0, noise(1e-4)},
      {"known_50", "a panel of 50 kg, known", 50, 50, noise(1e-4)},
      {"known_150", "a panel of 150 kg, known", 150, 150, noise(1e-4)},
      {"unknown_50", "50 kg, and the estimators believe in none", 50, 0, noise(1e-4)},
      {"unknown_150", "150 kg, and the estimators believe in none", 150, 0, noise(1e-4)},
      {"noise_known_0", "no panel, known; velocity noise 1e-3 rad/s", 0, 0, noise(1e-3)},
      {"noise_known_150", "150 kg, known; velocity noise 1e-3 rad/s", 150, 150, noise(1e-3)},
      {"noise_unknown_150", "150 kg, unknown; velocity noise 1e-3 rad/s", 150, 0, noise(1e-3)},
      {"hysteresis", "150 kg, known; torque sensors with 6 N m of hysteresis", 150, 150,
       hysteresis()},
      {"dry_friction", "150 kg, known; 5 N m of dry friction that the estimators do not know", 150,
       150, dry_friction()},
  };
  return all;
}

const Condition& condition(const std::string& name) {
  for (const Condition& c : conditions()) {
    if (c.name == name) return c;
  }
  throw std::invalid_argument(
      fmt::format("unknown condition '{}'; known: {}", name, fmt::join(condition_names(), ", ")));
}

void check_study(const StudyOptions& o) {
  if (o.blows < 0 || o.brisk_pushes < 0 || o.clampings < 0 || !(o.hours >= 0 && o.hours <= 1000)) {
    throw std::invalid_argument("a study has 0 or more touches of each kind, and 0 to 1000 hours");
  }
  if (o.blows + o.brisk_pushes + o.clampings == 0 && o.hours == 0) {
    throw std::invalid_argument("nothing to try: 0 collisions, pushes, clampings and hours");
  }
  const double runs = std::max({o.blows, o.brisk_pushes, o.clampings}) + o.hours * 3600;
  if (static_cast<double>(o.first_seed) + runs >= static_cast<double>(kTrainingSeed)) {
    throw std::invalid_argument(fmt::format(
        "seeds from {} on are for calibration: a test would know its training", kTrainingSeed));
  }
  chosen("condition", o.conditions, condition_names());
  chosen("estimator", o.estimators, all_estimators());
  chosen("detector", o.detectors, robot(kRobot).detectors);
}

std::vector<Cell> detection_study(const StudyOptions& o, const Thresholds& thresholds) {
  check_study(o);
  Study study(o, thresholds);
  parallel_for(
      study.size(), o.threads, [&](int i) { study.run(i); }, o.progress);
  return std::move(study).cells();
}

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

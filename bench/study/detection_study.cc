// SPDX-License-Identifier: Apache-2.0
#include "bench/study/detection_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <stdexcept>
#include <utility>

#include "bench/roster/robots.h"
#include "bench/roster/threshold_file.h"
#include "bench/score/parallel.h"
#include "bench/study/calibration.h"
#include "bench/study/study_runs.h"

namespace tauext::study {
namespace {

// seeds from `first` on until their runs hold `count` touches
void add_jobs(const StudyRuns& runs, const PlantKey& plant, TouchKind kind, std::uint64_t first,
              int count, std::vector<Job>& jobs) {
  for (std::uint64_t seed = first; count > 0; ++seed) {
    jobs.push_back({plant, kind, seed});
    count -= static_cast<int>(runs.touches(kind, seed).size());
  }
}

std::vector<Job> jobs_of(const StudyRuns& study, const PlantKey& plant, const StudyOptions& o) {
  std::vector<Job> jobs;
  add_jobs(study, plant, TouchKind::kBlow, o.first_seed, o.blows, jobs);
  add_jobs(study, plant, TouchKind::kBriskPush, o.first_seed, o.brisk_pushes, jobs);
  add_jobs(study, plant, TouchKind::kClamp, o.first_seed, o.clampings, jobs);
  for (int c = 0; o.regions > 0 && c < static_cast<int>(region_classes().size()); ++c) {
    Job job{plant, TouchKind::kSlowPush, o.first_seed, c};
    for (int count = o.regions; count > 0; ++job.seed) {
      jobs.push_back(job);
      count -= static_cast<int>(meetings_of(study, job).size());
    }
  }
  const double scored = study.touched(TouchKind::kSlowPush, 1, plant.motions).duration - kScoreFrom;
  const int runs = static_cast<int>(std::ceil(o.hours * 3600 / scored - 1e-9));
  for (int i = 0; i < runs; ++i) jobs.push_back({plant, TouchKind::kSlowPush, o.first_seed + i});
  return jobs;
}

// the study's tables, and the work on its runs
class Study {
 public:
  Study(const StudyOptions& o, const Thresholds& thresholds)
      : thresholds_(thresholds),
        runs_(touched_runs(o.robot)),
        estimators_(chosen_estimators(robot(runs_.robot), o.estimators)),
        detectors_(chosen_detectors(robot(runs_.robot), o.detectors)) {
    for (const std::string& e : estimators_) {  // before it takes its time
      for (const std::string& d : detectors_) trained_for(thresholds, runs_.robot, 0, e, d);
    }
    for (const std::string& name : chosen_conditions(runs_, o.conditions, runs_.usual)) {
      add_condition(condition(runs_, name));
    }
    for (auto& [plant, model] : models_) {
      model = runs_.model(plant);
      const std::vector<Job> jobs = jobs_of(runs_, plant, o);
      jobs_.insert(jobs_.end(), jobs.begin(), jobs.end());
    }
    make_batches();
  }

  // of runs that a session does at once
  int batches() const { return static_cast<int>(batches_.size()); }

  void run(int batch) {
    const std::span<const Job> jobs = batches_[static_cast<std::size_t>(batch)];
    const Model& model = models_.at(jobs.front().plant);
    std::vector<Trace> truths = simulated(runs_, jobs, model);
    if (is_first_of_plant(jobs)) require_mujoco_agrees(runs_, jobs.front(), model, truths.front());
    Views views(std::move(truths), jobs);
    for (std::size_t c = 0; c < conditions_.size(); ++c) {
      const Condition& of = *conditions_[c];
      if (plant_of(of) == jobs.front().plant) run(jobs, c, views);
    }
  }

  std::vector<Cell> cells() && {
    for (Cell& c : cells_) {
      std::sort(c.delays.begin(), c.delays.end());
      for (RegionCount& r : c.regions) {
        for (auto* values : {&r.delays, &r.peaks, &r.until_found})
          std::sort(values->begin(), values->end());
      }
    }
    return std::move(cells_);
  }

 private:
  void add_condition(const Condition& c) {
    conditions_.push_back(&c);
    if (!believers_.contains(c.believed)) believers_[c.believed] = runs_.believer(c.believed);
    models_.try_emplace(plant_of(c), nullptr);
    for (const std::string& e : estimators_) {
      for (const std::string& d : detectors_) {
        cells_.push_back(
            {.condition = c.name, .estimator = e, .detector = d, .Ts = 1e-3 * c.every});
      }
    }
  }

  // batches of jobs of one plant and kind
  void make_batches() {
    const auto most = static_cast<std::size_t>(robot(runs_.robot).runs_at_once());
    for (std::size_t from = 0, n = 0; from < jobs_.size(); from += n) {
      for (n = 1; n < most && from + n < jobs_.size(); ++n) {
        const Job &a = jobs_[from], &b = jobs_[from + n];
        if (a.plant != b.plant || a.kind != b.kind || a.region != b.region) break;
      }
      batches_.emplace_back(&jobs_[from], n);
    }
  }

  bool is_first_of_plant(std::span<const Job> jobs) const {
    const Job* const first = &jobs.front();
    return first == &jobs_.front() || (first - 1)->plant != first->plant;
  }

  // what one run adds
  Cell counted(const Job& job, const Answers& answers, const std::vector<double>& force) const {
    Cell cell{.runs = 1};
    if (job.region < 0) {
      count(job.kind, answers, runs_.touches(job.kind, job.seed), cell);
    } else {
      const auto c = static_cast<std::size_t>(job.region);
      cell.regions.resize(region_classes().size());
      count_regions(region_classes()[c], answers, meetings_of(runs_, job), force, cell.regions[c]);
    }
    return cell;
  }

  void run(std::span<const Job> jobs, std::size_t c, Views& views) {
    const Sensors& sensors = conditions_[c]->degradation.sensors;
    const std::vector<Trace> seen = views.by(sensors, conditions_[c]->every);
    const std::unique_ptr<Session> session = believers_.at(conditions_[c]->believed)->session(seen);
    const double noise = sensors.velocity_noise;
    std::vector<Cell> adds;
    for (const std::string& e : estimators_) {
      const std::vector<std::string> why = session->estimate(e);
      std::vector<Asked> asked;
      for (const std::string& d : detectors_) {
        asked.push_back({d, {trained_for(thresholds_, runs_.robot, noise, e, d), kStartUp}});
      }
      for (const std::vector<Answers>& of_runs : session->answers(asked, kLevels, kScoreFrom)) {
        for (std::size_t i = 0; i < jobs.size(); ++i) {
          adds.push_back(counted(jobs[i], of_runs[i], views.contact_force(i)));
          adds.back().failed_runs = !why[i].empty();
        }
      }
    }
    const std::lock_guard lock(mutex_);
    const std::size_t pairs = adds.size() / jobs.size();
    for (std::size_t i = 0; i < adds.size(); ++i) add(adds[i], cells_[c * pairs + i / jobs.size()]);
  }

  const Thresholds& thresholds_;
  const StudyRuns& runs_;
  std::vector<std::string> estimators_, detectors_;
  std::vector<const Condition*> conditions_;
  std::map<double, std::shared_ptr<const Robot>> believers_;  // by the panel that they believe in
  std::map<PlantKey, Model> models_;
  std::vector<Job> jobs_;
  std::vector<std::span<const Job>> batches_;
  std::vector<Cell> cells_;
  std::mutex mutex_;  // of cells_
};

}  // namespace

void check_study(const StudyOptions& o) {
  if (o.blows < 0 || o.brisk_pushes < 0 || o.clampings < 0 || o.regions < 0)
    throw std::invalid_argument(
        fmt::format("a study has 0 or more touches of each kind, not {} collisions, {} pushes, {} "
                    "clampings and {} of regions",
                    o.blows, o.brisk_pushes, o.clampings, o.regions));
  if (!(o.hours >= 0 && o.hours <= 1000))
    throw std::invalid_argument(fmt::format("a study has 0 to 1000 hours, not {}", o.hours));
  if (o.blows + o.brisk_pushes + o.clampings + o.regions == 0 && o.hours == 0) {
    throw std::invalid_argument(
        "nothing to try: 0 collisions, pushes, clampings, regions and hours");
  }
  const double runs = std::max({o.blows, o.brisk_pushes, o.clampings, o.regions}) + o.hours * 3600;
  if (static_cast<double>(o.first_seed) + runs >= static_cast<double>(kTrainingSeed)) {
    throw std::invalid_argument(fmt::format(
        "seeds from {} on are for calibration: a test would know its training", kTrainingSeed));
  }
  const StudyRuns& of = touched_runs(o.robot);
  if (o.regions > 0) of.points();  // which may throw
  chosen_conditions(of, o.conditions, {});
  chosen_estimators(robot(of.robot), o.estimators);
  chosen_detectors(robot(of.robot), o.detectors);
}

std::vector<Cell> detection_study(const StudyOptions& o, const Thresholds& thresholds) {
  check_study(o);
  Study study(o, thresholds);
  parallel_for(
      study.batches(), o.threads, [&](int i) { study.run(i); }, o.progress);
  return std::move(study).cells();
}

}  // namespace tauext::study

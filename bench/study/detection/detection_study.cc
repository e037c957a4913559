// SPDX-License-Identifier: Apache-2.0
#include "bench/study/detection/detection_study.h"

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
#include "bench/study/detection/calibration.h"
#include "bench/study/moved_on.h"
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

bool is_chosen(const std::vector<std::string>& asked, const std::string& specification) {
  return asked.empty() || std::any_of(asked.begin(), asked.end(), [&](const std::string& a) {
           return a == specification || a == name_of_specification(specification);
         });
}

// where a session has fewer lanes, it takes several rounds
constexpr std::size_t kRunsOfPiece = 8;

}  // namespace

class DetectionStudy::Study {
 public:
  Study(const StudyOptions& o, const Thresholds& thresholds)
      : thresholds_(thresholds), runs_(touched_runs(o.robot)) {
    for (const std::string& name : chosen_conditions(runs_, o.conditions, runs_.quick)) {
      add_condition(o, condition(runs_, name));
    }
    for (auto& [plant, model] : models_) {
      model = runs_.model(plant);
      const std::vector<Job> jobs = jobs_of(runs_, plant, o);
      jobs_.insert(jobs_.end(), jobs.begin(), jobs.end());
    }
    make_pieces();
  }

  const std::vector<Cell>& cells() const { return cells_; }
  int pieces() const { return static_cast<int>(pieces_.size()); }

  Added run(int piece) const {
    const std::span<const Job> jobs = pieces_[static_cast<std::size_t>(piece)];
    std::map<std::size_t, Cell> sums;
    const auto most = static_cast<std::size_t>(runs_.robot->runs_at_once());
    for (std::size_t from = 0; from < jobs.size(); from += most)
      run(jobs.subspan(from, std::min(most, jobs.size() - from)), sums);
    return {sums.begin(), sums.end()};
  }

 private:
  // an estimator, the detectors that are tried behind it, and the cell of the first of them
  struct Behind {
    std::string estimator;
    std::vector<Asked> detectors;
    std::size_t cell = 0;
  };
  struct Tried {
    const Condition* condition;
    std::vector<Behind> behind;
  };

  void add_condition(const StudyOptions& o, const Condition& c) {
    const Robot& r = *runs_.robot;
    Tried tried{&c, pairs_of(o, r, c)};
    if (c.trains_itself && !thresholds_.path.empty() && !are_for(thresholds_, r, c.name))
      throw std::invalid_argument(
          fmt::format("{}: has no thresholds for the condition {}; tauext-detect --calibrate FILE "
                      "--train {} makes them",
                      thresholds_.path, c.name, c.name));
    if (!believers_.contains(c.believed)) believers_[c.believed] = runs_.believer(c.believed);
    models_.try_emplace(plant_of(c), nullptr);
    for (Behind& b : tried.behind) {
      b.cell = cells_.size();
      for (Asked& d : b.detectors) {
        d.settings = settings(c, b.estimator, d.detector);
        cells_.push_back({.condition = c.name,
                          .estimator = b.estimator,
                          .detector = d.detector,
                          .Ts = 1e-3 * c.every});
      }
    }
    tried_.push_back(std::move(tried));
  }

  // the pairs of one condition: those that were tuned for it, or every detector behind every
  // estimator
  static std::vector<Behind> pairs_of(const StudyOptions& o, const Robot& r, const Condition& c) {
    std::vector<Behind> all;
    const auto add = [&](const std::string& e, const std::string& d) {
      auto at =
          std::find_if(all.begin(), all.end(), [&](const Behind& b) { return b.estimator == e; });
      if (at == all.end()) at = all.insert(at, {e, {}});
      at->detectors.push_back({d, {}});
    };
    bool tuned = false;
    for (const TunedRow& p : o.tuned) {
      if (!is_tuned(p, r, c.name)) continue;
      tuned = true;
      if (is_chosen(o.estimators, p.estimator) && is_chosen(o.detectors, p.detector))
        add(p.estimator, p.detector);
    }
    if (tuned && all.empty())
      throw std::invalid_argument(
          fmt::format("none of these estimators and detectors was tuned for {}", c.name));
    if (tuned) return all;
    for (const std::string& e : chosen_estimators(r, o.estimators)) {
      for (const std::string& d : chosen_detectors(r, o.detectors)) add(e, d);
    }
    return all;
  }

  DetectorSettings settings(const Condition& c, const std::string& e, const std::string& d) const {
    const double noise = c.degradation.sensors.velocity_noise;
    return judged_with(trained_for(thresholds_, *runs_.robot, noise, e, d, c.name));
  }

  // pieces of jobs of one plant and kind
  void make_pieces() {
    for (std::size_t from = 0, n = 0; from < jobs_.size(); from += n) {
      for (n = 1; n < kRunsOfPiece && from + n < jobs_.size(); ++n) {
        const Job &a = jobs_[from], &b = jobs_[from + n];
        if (a.plant != b.plant || a.kind != b.kind || a.region != b.region) break;
      }
      pieces_.emplace_back(&jobs_[from], n);
    }
  }

  bool is_first_of_plant(std::span<const Job> jobs) const {
    const Job* const first = &jobs.front();
    return first == &jobs_.front() || (first - 1)->plant != first->plant;
  }

  // what one run adds
  Cell counted(const Job& job, const Answers& answers, const std::vector<double>& force,
               const std::vector<double>& moved) const {
    Cell cell{.runs = 1};
    if (job.region < 0) {
      count(job.kind, answers, runs_.touches(job.kind, job.seed), cell);
    } else {
      const auto c = static_cast<std::size_t>(job.region);
      cell.regions.resize(region_classes().size());
      count_regions(region_classes()[c], answers, meetings_of(runs_, job), force, moved,
                    cell.regions[c]);
    }
    return cell;
  }

  void run(std::span<const Job> jobs, std::map<std::size_t, Cell>& sums) const {
    const Model& model = models_.at(jobs.front().plant);
    std::vector<Trace> truths = simulated(runs_, jobs, model);
    if (is_first_of_plant(jobs)) require_mujoco_agrees(runs_, jobs.front(), model, truths.front());
    const auto moved = moved_on(runs_, jobs, model, truths);
    Views views(std::move(truths), jobs);
    for (const Tried& t : tried_) {
      if (plant_of(*t.condition) == jobs.front().plant) look(jobs, t, views, moved, sums);
    }
  }

  void look(std::span<const Job> jobs, const Tried& t, Views& views,
            const std::vector<std::vector<double>>& moved,
            std::map<std::size_t, Cell>& sums) const {
    const Condition& c = *t.condition;
    const std::vector<Trace> seen = views.by(c.degradation.sensors, c.every);
    const std::unique_ptr<Session> session = make_session(*believers_.at(c.believed), seen);
    for (const Behind& b : t.behind) {
      const std::vector<std::string> why = session->estimate(b.estimator);
      std::size_t cell = b.cell;
      for (const std::vector<Answers>& of_runs :
           session->answers(b.detectors, kLevels, kScoreFrom)) {
        for (std::size_t i = 0; i < jobs.size(); ++i) {
          Cell adds = counted(jobs[i], of_runs[i], views.contact_force(i), moved[i]);
          adds.failed_runs = !why[i].empty();
          add(adds, sums[cell]);
        }
        ++cell;
      }
    }
  }

  const Thresholds thresholds_;
  const StudyRuns& runs_;
  std::vector<Tried> tried_;
  std::map<double, std::shared_ptr<const Robot>> believers_;  // by the panel that they believe in
  std::map<PlantKey, Model> models_;
  std::vector<Job> jobs_;
  std::vector<std::span<const Job>> pieces_;
  std::vector<Cell> cells_;
};

DetectionStudy::DetectionStudy(const StudyOptions& options, const Thresholds& thresholds) {
  check_study(options);
  study_ = std::make_unique<const Study>(options, thresholds);
}
DetectionStudy::~DetectionStudy() = default;

const std::vector<Cell>& DetectionStudy::cells() const {
  return study_->cells();
}
int DetectionStudy::pieces() const {
  return study_->pieces();
}
Added DetectionStudy::run(int piece) const {
  return study_->run(piece);
}

void StudySum::add(const Added& added) {
  for (const auto& [cell, counts] : added) study::add(counts, cells_.at(cell));
  ++pieces_;
}

std::vector<Cell> StudySum::sorted() const {
  std::vector<Cell> all = cells_;
  for (Cell& c : all) sort_values(c);
  return all;
}

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
  chosen_estimators(*of.robot, o.estimators);
  chosen_detectors(*of.robot, o.detectors);
}

void run_pieces(const DetectionStudy& study, const StudyOptions& o, StudySum& sum) {
  std::mutex mutex;
  const auto work = [&](int piece) {
    if (o.stop && o.stop()) return;
    const Added added = study.run(mixed(piece, study.pieces()));
    const std::lock_guard lock(mutex);
    sum.add(added);
  };
  parallel_for(study.pieces(), o.threads, work, o.progress);
}

std::vector<Cell> detection_study(const StudyOptions& o, const Thresholds& thresholds) {
  const DetectionStudy study(o, thresholds);
  StudySum sum(study.cells());
  run_pieces(study, o, sum);
  return sum.sorted();
}

}  // namespace tauext::study

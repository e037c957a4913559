// SPDX-License-Identifier: Apache-2.0
#include "bench/tune/study_tuning.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/program/exit_code.h"
#include "bench/roster/robots.h"
#include "bench/roster/threshold_file.h"
#include "bench/score/parallel.h"
#include "bench/study/detection/calibration.h"
#include "bench/study/detection/study_counts.h"
#include "bench/study/study_runs.h"
#include "bench/tune/tune.h"
#include "mjcf/scenarios/region_runs.h"
#include "mjcf/trace/printable.h"

namespace tauext {

using study::Job;

TrainingRuns::TrainingRuns(const study::StudyRuns& runs, const study::Condition& c, int free_runs,
                           int meetings, int threads)
    : runs_(runs), robot_(*runs.robot), believer_(runs.believer(c.believed)) {
  std::vector<Job> all;
  Job job{plant_of(c), TouchKind::kSlowPush, study::kTrainingSeed};
  for (int i = 0; i < free_runs; ++i, ++job.seed) all.push_back(job);
  add_batches(all);
  free_ = jobs_.size();
  all.clear();
  for (int k = 0; k < static_cast<int>(region_classes().size()); ++k) {
    job.region = k, job.seed = study::kTrainingSeed;
    for (int left = meetings; left > 0; ++job.seed) {
      all.push_back(job);
      left -= static_cast<int>(meetings_of(runs_, job).size());
    }
  }
  add_batches(all);
  batches_.resize(jobs_.size());
  forces_.resize(jobs_.size());
  const Model model = runs.model(plant_of(c));
  parallel_for(static_cast<int>(jobs_.size()), threads, [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    study::Views views(simulated(runs, jobs_[at], model), jobs_[at]);
    batches_[at] = views.by(c.degradation.sensors, c.every);
    for (std::size_t k = 0; k < jobs_[at].size(); ++k)
      forces_[at].push_back(jobs_[at][k].region < 0 ? std::vector<double>()
                                                    : views.contact_force(k));
  });
}

std::vector<study::EstimatedRuns> TrainingRuns::seen_by(const std::string& estimator) const {
  std::vector<study::EstimatedRuns> all;
  for (const std::vector<Trace>& batch : batches_) {
    all.push_back({batch, make_session(*believer_, batch)});
    for (const std::string& why : all.back().session->estimate(estimator)) {
      if (!why.empty()) return {};
    }
  }
  return all;
}

double TrainingRuns::recall(const std::vector<study::EstimatedRuns>& seen, const TunedPair& p,
                            double margin) const {
  study::CalibrationOptions o;
  o.margin = margin;
  o.pairs = {{p.estimator, p.detector}};
  o.threads = 1;
  Thresholds t;
  t.sets = {calibrate_on(*believer_, std::span(seen).first(free_), o)};
  t.sets.front().robot = robot_.name(), t.sets.front().fingerprint = robot_.fingerprint();
  const Asked asked{p.detector,
                    study::judged_with(trained_for(t, robot_, 0, p.estimator, p.detector))};
  std::vector<study::RegionCount> counts(region_classes().size());
  for (std::size_t i = free_; i < seen.size(); ++i) {
    const auto answers =
        seen[i].session->answers({&asked, 1}, study::kLevels, study::kScoreFrom).front();
    for (std::size_t k = 0; k < answers.size(); ++k) {
      const Job& job = jobs_[i][k];
      const auto c = static_cast<std::size_t>(job.region);
      count_regions(region_classes()[c], answers[k], meetings_of(runs_, job), forces_[i][k], {},
                    counts[c]);
    }
  }
  double sum = 0;
  for (const study::RegionCount& c : counts) sum += static_cast<double>(c.found) / c.touches;
  return sum / static_cast<double>(counts.size());
}

void TrainingRuns::add_batches(const std::vector<Job>& all) {
  const auto most = static_cast<std::size_t>(robot_.runs_at_once());
  for (std::size_t from = 0; from < all.size(); from += most) {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(from);
    jobs_.emplace_back(begin,
                       begin + static_cast<std::ptrdiff_t>(std::min(most, all.size() - from)));
  }
}

namespace {

using study::StudyRuns;

// what is tuned of our detectors; of another one all its numbers above 0, but those of its marks
const std::map<std::string, std::vector<std::string>>& keys_of_detectors() {
  static const std::map<std::string, std::vector<std::string>> all = {
      {"threshold", {}},
      {"dynamic_threshold", {"speed=0.05:10", "share=0.001:0.5"}},
      {"high_pass", {"w=1:300"}},
      {"band_pass", {"w_low=1:60", "w_high=65:400"}},
      {"cusum", {"drift", "w=1:200"}},
      {"glr", {"w=1:200", "span=0.01:0.25"}},
      {"energy", {"w=5:300"}},
      {"pan_tompkins", {"stride=1:16", "hold=0.002:0.2"}},
      {"clamping", {"w_baseline=0.05:5", "w_smooth=10:300", "duration=0.005:0.5"}},
      {"contact_classifier",
       {"collision.stride=1:16", "clamping.w_baseline=0.05:5", "clamping.duration=0.005:0.5"}}};
  return all;
}

std::vector<std::string> keys_of_detector(const Robot& r, const std::string& detector) {
  const std::string name(name_of_specification(detector));
  const auto ours = keys_of_detectors().find(name);
  if (ours != keys_of_detectors().end()) return ours->second;
  std::vector<std::string> keys;
  for (const FieldHelp& f : r.detector_fields(name)) {
    const bool of_marks = f.key == "refractory" || f.key == "start_up" || f.key == "threshold";
    if (!of_marks && !f.unit.empty() && std::atof(f.value.c_str()) > 0) keys.push_back(f.key);
  }
  return keys;
}

// the numbers of a detector that its specification leaves open
std::vector<TunedKey> open_keys(const Robot& r, const TunedPair& pair) {
  std::vector<std::string> texts;
  for (const std::string& text : keys_of_detector(r, pair.detector)) {
    if (!key_of(pair.detector, text.substr(0, text.find('=')))) texts.push_back(text);
  }
  // an estimator may have a key of that name, too
  return keys_of(texts, pair, {}, r.detector_fields(name_of_specification(pair.detector)));
}

constexpr std::array kBandwidths = {5., 15., 50., 150., 450.};  // [rad/s]

// an estimator as it is, and at each bandwidth, if it has one and does not say it
std::vector<std::string> designs_of(const Robot& r, const std::string& estimator) {
  std::vector<std::string> all = {estimator};
  const std::vector<std::string> tunable = r.tunable();
  if (std::count(tunable.begin(), tunable.end(), name_of_specification(estimator)) == 0 ||
      key_of(estimator, "bandwidth"))
    return all;
  for (const double w : kBandwidths) {
    const std::string design = at_bandwidth(estimator, w);
    try {
      r.check(design, "");
      all.push_back(design);
    } catch (const std::invalid_argument&) {  // it cannot be so slow or so fast
    }
  }
  return all;
}

// the best of a detector behind a design of an estimator
study::TunedRow tuned(const Robot& r, const std::string& condition, const TunedPair& pair,
                      const std::vector<study::EstimatedRuns>& seen, const TrainingRuns& runs,
                      const StudyTuning& o, int evaluations) {
  study::TunedRow found{r.name(), r.fingerprint(), condition, pair.estimator, pair.detector};
  TuneOptions t;
  t.keys = open_keys(r, pair);
  if (t.keys.empty()) {
    found.recall = found.recall_before = runs.recall(seen, pair, o.margin);
    found.evaluations = 1;
    return found;
  }
  t.pair = pair;
  t.minimize = Metric::kRecall;
  t.evaluations = evaluations;
  t.check = [&](const TunedPair& p) { r.check(p.estimator, p.detector); };
  t.score = [&](const TunedPair& p) {
    Score score;
    score.set(Metric::kRecall, runs.recall(seen, p, o.margin));
    return std::vector<std::vector<Score>>{{score}};
  };
  const Tuned best = tune(t);
  found.detector = best.best.detector;
  found.recall = best.of_best, found.recall_before = best.of_start;
  found.evaluations = best.evaluations;
  found.at_ends = best.at_bound;
  return found;
}

bool is_known(const std::vector<study::TunedRow>& known, const Robot& r,
              const std::string& condition, const TunedPair& pair) {
  return std::any_of(known.begin(), known.end(), [&](const study::TunedRow& k) {
    return study::is_tuned(k, r, condition) && k.before == pair.estimator + "+" + pair.detector;
  });
}

void check(const StudyTuning& o) {
  if (o.conditions.empty()) throw std::invalid_argument("no condition to tune for");
  constexpr int kLeast = 3 * (1 + static_cast<int>(kBandwidths.size()));
  if (o.free_runs < 1 || o.meetings < 1 || o.runs < 1 || o.evaluations < kLeast)
    throw std::invalid_argument(fmt::format(
        "tuning needs a run without a touch, a meeting of each kind and {} evaluations (not {}), "
        "three for each bandwidth, or more",
        kLeast, o.evaluations));
  const StudyRuns& runs = study::touched_runs(o.robot);
  for (const std::string& name : study::chosen_conditions(runs, o.conditions, {})) {
    if (!condition(runs, name).trains_itself)
      throw std::invalid_argument(fmt::format(
          "{}: thresholds of this condition come from others; tune for light, typical, hard",
          name));
  }
  runs.points();  // which may throw
}

// the pairs of one condition
class OfCondition {
 public:
  // `unit` numbers the estimators of all conditions, of which each is of one part
  OfCondition(const StudyTuning& o, const StudyRuns& runs, const std::string& condition,
              const std::vector<study::TunedRow>& known, int& unit)
      : o_(o), robot_(*runs.robot), runs_(runs), condition_(condition) {
    const std::vector<std::string> detectors = study::chosen_detectors(robot_, o.detectors);
    for (const std::string& e : study::chosen_estimators(robot_, o.estimators)) {
      if (unit++ % o.shard.count != o.shard.index - 1) continue;
      const std::size_t first = rows_.size();
      for (const std::string& d : detectors) {
        if (is_known(known, robot_, condition, {e, d})) continue;
        rows_.push_back({.estimator = e, .detector = d});
        open_keys(robot_, {e, d});  // which may throw, before it takes its time
      }
      if (rows_.size() == first) continue;
      const std::vector<std::string> designs = designs_of(robot_, e);
      for (const std::string& design : designs)
        work_.push_back({design, first, rows_.size(), static_cast<int>(designs.size())});
    }
  }

  // those of estimators of which every design was tried
  std::vector<study::TunedRow> run(const std::function<void(double)>& done) {
    if (work_.empty()) return {};
    const TrainingRuns training(runs_, study::condition(runs_, condition_), o_.free_runs,
                                o_.meetings, o_.threads);
    tried_.resize(work_.size());
    parallel_for(
        static_cast<int>(work_.size()), o_.threads,
        [&](int i) {
          if (!o_.stop || !o_.stop()) try_design(static_cast<std::size_t>(i), training);
        },
        done);
    std::vector<study::TunedRow> all;
    for (std::size_t i = 0; i < work_.size(); i += static_cast<std::size_t>(work_[i].designs))
      take_best(i, all);
    return all;
  }

 private:
  // a design of an estimator with those of the rows that are behind it
  struct Work {
    std::string design;
    std::size_t first, last;  // of rows_
    int designs;              // of this estimator
  };

  void try_design(std::size_t i, const TrainingRuns& training) {
    const Work& w = work_[i];
    const std::vector<study::EstimatedRuns> seen = training.seen_by(w.design);
    for (std::size_t k = w.first; k < w.last; ++k) {
      study::TunedRow row{.recall = -1};
      if (!seen.empty())
        row = tuned(robot_, condition_, {w.design, rows_[k].detector}, seen, training, o_,
                    o_.evaluations / w.designs);
      tried_[i].push_back(row);
    }
  }

  void take_best(std::size_t i, std::vector<study::TunedRow>& all) const {
    const auto designs = static_cast<std::size_t>(work_[i].designs);
    for (std::size_t k = 0; k < work_[i].last - work_[i].first; ++k) {
      const study::TunedRow* best = nullptr;
      int evaluations = 0;
      for (std::size_t j = i; j < i + designs; ++j) {
        if (tried_[j].empty()) return;  // it was stopped before
        const study::TunedRow& row = tried_[j][k];
        evaluations += row.evaluations;
        if (best == nullptr || row.recall > best->recall) best = &row;
      }
      if (best->recall < 0) continue;  // no design makes estimates here
      all.push_back(*best);
      all.back().evaluations = evaluations;
      const study::TunedRow &start = tried_[i][k], &row = rows_[work_[i].first + k];
      all.back().before = row.estimator + "+" + row.detector;
      all.back().recall_before = start.recall < 0 ? kNoValue : start.recall_before;
      if (designs > 2 && (best == &tried_[i + 1][k] || best == &tried_[i + designs - 1][k]))
        all.back().at_ends.emplace_back("bandwidth");
    }
  }

  const StudyTuning& o_;
  const Robot& robot_;
  const StudyRuns& runs_;
  std::string condition_;
  std::vector<study::TunedRow> rows_;  // what is to be tuned
  std::vector<Work> work_;
  std::vector<std::vector<study::TunedRow>> tried_;  // of each work, by row
};

}  // namespace

void tune_study(const StudyTuning& o, const std::vector<study::TunedRow>& known) {
  check(o);
  const StudyRuns& runs = study::touched_runs(o.robot);
  double begun = 0;
  int unit = 0;
  for (const std::string& name : o.conditions) {
    if (o.stop && o.stop()) break;
    const std::vector<study::TunedRow> found =
        OfCondition(o, runs, name, known, unit).run([&](double share) {
          if (o.progress)
            o.progress((begun + 0.9 * share) / static_cast<double>(o.conditions.size()));
        });
    ++begun;
    if (found.empty()) continue;
    study::CalibrationOptions c;
    c.robot = o.robot;
    c.margin = o.margin;
    c.runs = o.runs;
    c.threads = o.threads;
    for (const study::TunedRow& p : found) c.pairs.emplace_back(p.estimator, p.detector);
    o.found({study::calibrate_for({name}, c), found, ""});
  }
}

int merge_tuned(const std::vector<std::string>& paths, const std::string& out) {
  study::TunedStudy all;
  for (const std::string& path : paths) {
    const study::TunedStudy more = study::read_tuned(path);
    if (more.rows.empty())
      throw std::runtime_error(path + ": has no pairs that tauext-tune --conditions has tuned");
    for (const study::TunedRow& p : more.rows) {
      if (std::any_of(all.rows.begin(), all.rows.end(), [&](const study::TunedRow& k) {
            return k.robot == p.robot && k.arm == p.arm && k.condition == p.condition &&
                   k.before == p.before;
          }))
        throw std::runtime_error(fmt::format("{}: {} for {} on {} is in a file before it, too",
                                             path, p.before, p.condition, p.robot));
    }
    append(more, all);
  }
  study::write_tuned(all, out);
  say(fmt::format("{}: {} pairs", out, all.rows.size()));
  return kGood;
}

}  // namespace tauext

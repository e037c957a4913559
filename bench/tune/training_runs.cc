// SPDX-License-Identifier: Apache-2.0
#include "bench/tune/training_runs.h"

#include <algorithm>
#include <span>
#include <utility>

#include "bench/roster/robots.h"
#include "bench/roster/threshold_file.h"
#include "bench/score/parallel.h"
#include "bench/study/detection/study_counts.h"
#include "mjcf/scenarios/region_runs.h"

namespace tauext {

using study::Job;

TrainingRuns::TrainingRuns(const study::StudyRuns& runs, const study::Condition& c, int free_runs,
                           int meetings, int threads)
    : runs_(runs), robot_(robot(runs.robot)), believer_(runs.believer(c.believed)) {
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
    all.push_back({batch, believer_->session(batch)});
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
                    study::judged_with(trained_for(t, robot_.name(), 0, p.estimator, p.detector))};
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

}  // namespace tauext

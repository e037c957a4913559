// SPDX-License-Identifier: Apache-2.0
#include "bench/study/moved_on.h"

#include <cstddef>

#include "bench/score/detection_metrics.h"
#include "mjcf/plant/plant.h"

namespace tauext::study {
namespace {

constexpr double kSample = 1.5e-3;  // [s] and half of one, for rounding

}  // namespace

std::vector<double> moved_on(const std::vector<RegionTouch>& touches, const Model& model,
                             const Trace& truth) {
  std::vector<double> moved(truth.t.size());
  Plant plant(model);
  auto touch = touches.begin();
  Plant::Place from, to;
  Eigen::Vector3d start;
  double last = 0;  // [s] of the last sample with a force: the contact lasts until the next one
  for (int k = 0; k < truth.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    const bool begins = touch != touches.end() && truth.t[at] >= touch->begin - 1e-9;
    if (begins) from = plant.place(touch->at.from), to = plant.place(touch->at.to);
    if (begins || truth.contact_force[at] > 0) last = truth.t[at];
    if ((!begins && touch == touches.begin()) || truth.t[at] > last + metrics::kGrace + kSample)
      continue;
    const RegionTouch& now = begins ? *touch++ : *(touch - 1);
    plant.set_pose(truth.q.col(k));
    const Eigen::Vector3d point =
        (1 - now.at.share) * plant.position(from) + now.at.share * plant.position(to);
    if (begins) start = point;
    moved[at] = (point - start).norm();
  }
  return moved;
}

std::vector<std::vector<double>> moved_on(const StudyRuns& runs, std::span<const Job> jobs,
                                          const Model& model, std::span<const Trace> truths) {
  std::vector<std::vector<double>> all(jobs.size());
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (jobs[i].region >= 0) all[i] = moved_on(meetings_of(runs, jobs[i]), model, truths[i]);
  }
  return all;
}

}  // namespace tauext::study

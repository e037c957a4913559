// SPDX-License-Identifier: Apache-2.0
#include "bench/outside/log_metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/score/detection_metrics.h"
#include "bench/score/metrics.h"

namespace tauext {
namespace {

using Eigen::VectorXd;

// samples that count and while which nothing touches, or has touched just before
std::vector<int> untouched(const LogRun& run) {
  std::vector<int> samples;
  const Trace& t = *run.trace;
  double last = -std::numeric_limits<double>::infinity();  // [s] of a contact
  for (int k = 0; k < t.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    if (!t.contact.empty() && t.contact[at] != 0) last = t.t[at];
    if (t.t[at] >= run.from && t.t[at] > last + metrics::kGrace) samples.push_back(k);
  }
  return samples;
}

VectorXd mean(const Output& o, const std::vector<int>& samples, std::size_t from, std::size_t to) {
  VectorXd sum = VectorXd::Zero(o.tau_ext.rows());
  for (std::size_t i = from; i < to; ++i) sum += o.tau_ext.col(samples[i]);
  return sum / static_cast<double>(to - from);
}

Score::Joints as_list(const VectorXd& v) {
  return Score::Joints(v.begin(), v.end());
}

}  // namespace

void add_floor_metrics(const std::vector<LogRun>& runs, Score& score) {
  if (runs.empty()) return;
  const Eigen::Index n = runs.front().output->tau_ext.rows();
  VectorXd squares = VectorXd::Zero(n), drift = VectorXd::Zero(n);
  std::size_t count = 0;
  for (const LogRun& run : runs) {
    const std::vector<int> samples = untouched(run);
    for (const int k : samples) squares += run.output->tau_ext.col(k).cwiseAbs2();
    count += samples.size();
    const std::size_t third = samples.size() / 3;
    if (third == 0) continue;
    const VectorXd wandered = mean(*run.output, samples, samples.size() - third, samples.size()) -
                              mean(*run.output, samples, 0, third);
    drift = drift.cwiseMax(wandered.cwiseAbs());
  }
  if (count < 3) return;
  score.set_joints(Metric::kFloor,
                   as_list((squares / static_cast<double>(count)).cwiseSqrt().eval()));
  score.set_joints(Metric::kDrift, as_list(drift));
}

void add_maker_metrics(const std::vector<LogRun>& runs, Score& score) {
  const bool known = std::all_of(runs.begin(), runs.end(), [](const LogRun& r) {
    return r.trace->tau_ext_of_driver.cols() == r.trace->size() && r.trace->size() > 0;
  });
  if (runs.empty() || !known) return;
  const Eigen::Index n = runs.front().output->tau_ext.rows();
  Score::Joints correlation;
  std::vector<double> gain;
  Eigen::Index worst = 0;
  for (Eigen::Index j = 0; j < n; ++j) {
    double count = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
    for (const LogRun& run : runs) {
      for (int k = 0; k < run.trace->size(); ++k) {
        if (run.trace->t[static_cast<std::size_t>(k)] < run.from) continue;
        const double a = run.output->tau_ext(j, k), b = run.trace->tau_ext_of_driver(j, k);
        count += 1, x += a, y += b, xx += a * a, yy += b * b, xy += a * b;
      }
    }
    const double cov = xy - x * y / count, vx = xx - x * x / count, vy = yy - y * y / count;
    correlation.push_back(vx > 0 && vy > 0 ? cov / std::sqrt(vx * vy) : kNoValue);
    gain.push_back(vx > 0 ? cov / vx : kNoValue);
    if (correlation.back() < correlation[static_cast<std::size_t>(worst)]) worst = j;
  }
  score.set_joints(Metric::kMakerCorrelation, correlation);
  score.set(Metric::kMakerGain, gain[static_cast<std::size_t>(worst)]);
  const LogRun& run = runs.front();
  const auto ours = run.output->tau_ext.row(worst),
             theirs = run.trace->tau_ext_of_driver.row(worst);
  const std::vector<double>& t = run.trace->t;
  const double from = std::max(run.from - t.front(), 0.);  // as a lag counts it
  const double after = metrics::lag(t, theirs, ours, from),
               before = metrics::lag(t, ours, theirs, from);
  score.set(Metric::kMakerLag, after > 0 || std::isnan(before) ? after : -before);
}

void add_label_metrics(const std::vector<LogRun>& runs, Score& score) {
  metrics::DetectionScore all;
  double hours = 0;  // that were watched
  for (const LogRun& run : runs) {
    if (run.output->marks.empty()) return;
    const Trace& t = *run.trace;
    const auto from = std::lower_bound(t.t.begin(), t.t.end(), run.from) - t.t.begin();
    const std::vector<double> times(t.t.begin() + from, t.t.end());
    const std::vector<std::uint8_t> marks(run.output->marks.begin() + from,
                                          run.output->marks.end());
    std::vector<std::uint8_t> contact(marks.size(), 0);
    if (!t.contact.empty()) contact.assign(t.contact.begin() + from, t.contact.end());
    const metrics::DetectionScore d = metrics::detection_score(times, contact, marks);
    all.collisions += d.collisions;
    all.detected += d.detected;
    all.false_alarms += d.false_alarms;
    all.delays.insert(all.delays.end(), d.delays.begin(), d.delays.end());
    hours += d.watched / 3600;
  }
  if (all.collisions > 0) {
    const metrics::Interval recall = metrics::share_interval(all.detected, all.collisions);
    score.set(Metric::kRecall, static_cast<double>(all.detected) / all.collisions);
    score.set(Metric::kRecallLow, recall.low);
    score.set(Metric::kRecallHigh, recall.high);
    score.set(Metric::kDelay, metrics::quantile(all.delays, 1));
    score.set(Metric::kDelayMedian, metrics::quantile(all.delays, 0.5));
  }
  score.set(Metric::kFalseAlarms, all.false_alarms);
  if (!(hours > 0)) return;
  const metrics::Interval alarms = metrics::count_interval(all.false_alarms);
  score.set(Metric::kFalseAlarmsPerHour, all.false_alarms / hours);
  score.set(Metric::kFalseAlarmsLow, alarms.low / hours);
  score.set(Metric::kFalseAlarmsHigh, alarms.high / hours);
}

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
#include "bench/score/detection_metrics.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mjcf/trace/read/recording.h"

namespace tauext {
namespace metrics {
namespace {

// the mean with which at most `count` events are seen in this share of all trials
double poisson_mean(int count, double share) {
  // P(at most `count`) falls with the mean
  const auto probability = [&](double mean) {
    double sum = 0;
    for (int k = 0; k <= count; ++k)
      sum += std::exp(k * std::log(mean) - mean - std::lgamma(k + 1));
    return sum;
  };
  double least = 0, most = count + 20 + 6 * std::sqrt(count + 1.);
  for (int i = 0; i < 60; ++i) {
    const double mean = (least + most) / 2;
    (probability(mean) > share ? least : most) = mean;
  }
  return least;
}

}  // namespace

void DetectionCounter::watch(double t, bool counts) {
  switch (clock_.accept(t)) {
    case Status::kOk:
      ++steps_;
      if (counts) s_.watched += clock_.h();
      break;
    case Status::kStarted:
      if (steps_ == 1) s_.watched = before_;  // its only step was a gap
      before_ = s_.watched;
      steps_ = 0;
      break;
    default:
      break;
  }
}

// whether a mark at t belongs to a touch on purpose
bool DetectionCounter::take_intended(double t, bool touched, bool mark) {
  if (touched && !std::exchange(in_intended_, true)) {
    ++s_.intended;
    intended_marked_ = false;
  }
  if (touched) last_intended_ = t;
  in_intended_ = in_intended_ && t <= last_intended_ + kGrace;
  if (in_intended_ && mark && !std::exchange(intended_marked_, true)) ++s_.intended_marked;
  return in_intended_;
}

void DetectionCounter::take(double t, std::uint8_t label, bool mark) {
  const bool contact = label != 0 && label != kIntended;
  const bool intended = take_intended(t, label == kIntended, mark && !contact);
  watch(t, !intended);
  const bool goes_on = contact && touched_;  // whatever the time between two samples
  touched_ = contact;
  if (in_collision_ && !goes_on && t > last_ + kGrace) in_collision_ = false;
  if (!in_collision_ && !contact) {
    s_.false_alarms += mark && !intended;
    return;
  }
  if (!in_collision_) {
    ++s_.collisions;
    in_collision_ = true;
    marked_ = false;
    begin_ = t;
  }
  if (contact) last_ = t;
  if (!mark || marked_) return;
  marked_ = true;
  ++s_.detected;
  s_.delays.push_back(t - begin_);
}

DetectionScore DetectionCounter::score() const {
  DetectionScore s = s_;
  s.delay = s.delays.empty() ? kNoValue : *std::max_element(s.delays.begin(), s.delays.end());
  if (s.watched > 0) s.false_alarms_per_hour = 3600 * s.false_alarms / s.watched;
  return s;
}

DetectionScore detection_score(const std::vector<double>& t,
                               const std::vector<std::uint8_t>& contact,
                               const std::vector<std::uint8_t>& marks) {
  DetectionCounter counter;
  for (std::size_t k = 0; k < t.size(); ++k) counter.take(t[k], contact[k], marks[k] != 0);
  return counter.score();
}

double overtravel(const Trace& trace) {
  const int at = trace.stopped_at;
  if (at < 0) return kNoValue;
  double most = 0;
  for (int j = 0; j < trace.dof(); ++j) {
    const double sense = trace.qd(j, at) < 0 ? -1 : 1;
    const auto after = trace.q.row(j).tail(trace.size() - at).array();
    most = std::max(most, (sense * (after - trace.q(j, at))).maxCoeff());
  }
  return most;
}

double peak(const std::vector<double>& force) {
  return force.empty() ? 0 : *std::max_element(force.begin(), force.end());
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return kNoValue;
  std::sort(values.begin(), values.end());
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  return values[static_cast<std::size_t>(std::max(rank, 1.)) - 1];
}

double poisson_upper(int count) {
  return poisson_mean(count, 0.05);
}

Interval count_interval(int count) {
  return {count == 0 ? 0 : poisson_mean(count - 1, 0.975), poisson_mean(count, 0.025)};
}

Interval share_interval(int found, int all) {
  if (all == 0) return {0, 1};
  constexpr double z = 1.959963985;
  const double n = all, p = found / n, middle = p + z * z / (2 * n), scale = 1 + z * z / n;
  const double half = z * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n));
  return {std::max((middle - half) / scale, 0.), std::min((middle + half) / scale, 1.)};
}

}  // namespace metrics

void add_detection_metrics(const Trace& trace, const Output& out, Score& score) {
  if (out.marks.empty() || trace.contact.empty()) return;
  const metrics::DetectionScore d = metrics::detection_score(trace.t, trace.contact, out.marks);
  score.collisions = d.collisions;
  if (d.collisions > 0) {
    score.set(Metric::kDelay, d.delay);
    score.set(Metric::kRecall, static_cast<double>(d.detected) / d.collisions);
  }
  score.set(Metric::kFalseAlarms, d.false_alarms);
  score.set(Metric::kFalseAlarmsPerHour, d.false_alarms_per_hour);
}

void add_score_metrics(const std::vector<Detection>& detections, Score& score) {
  if (detections.empty()) return;
  double peak = 0, sum = 0, touched = 0;
  for (const Detection& d : detections) {
    peak = std::max(peak, d.score);
    sum += d.score;
    touched += d.contact != Contact::kNone;
  }
  const auto n = static_cast<double>(detections.size());
  score.set(Metric::kPeakScore, peak);
  score.set(Metric::kMeanScore, sum / n);
  score.set(Metric::kContactShare, touched / n);
}

void add_reaction_metrics(const Trace& stopped, const Trace& free, Score& score) {
  const double peak = metrics::peak(stopped.contact_force);
  const bool touched = peak > 0;  // else a false alarm has stopped it before
  score.set(Metric::kOvertravel, touched ? metrics::overtravel(stopped) : kNoValue);
  score.set(Metric::kPeak, touched ? peak : kNoValue);
  score.set(Metric::kPeakUnstopped, metrics::peak(free.contact_force));
}

}  // namespace tauext

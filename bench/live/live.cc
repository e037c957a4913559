// SPDX-License-Identifier: Apache-2.0
#include "bench/live/live.h"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "bench/roster/threshold_file.h"
#include "mjcf/trace/known.h"

namespace tauext::live {
namespace {

// the messages' numbers are the library's
static_assert(estimate_t::kOk == static_cast<int>(Status::kOk) &&
              estimate_t::kStarted == static_cast<int>(Status::kStarted) &&
              estimate_t::kBadMeasurement == static_cast<int>(Status::kBadMeasurement) &&
              estimate_t::kSingularInertia == static_cast<int>(Status::kSingularInertia) &&
              estimate_t::kDiverged == static_cast<int>(Status::kDiverged) &&
              estimate_t::kBadTime == static_cast<int>(Status::kBadTime) &&
              estimate_t::kOutOfRange == static_cast<int>(Status::kOutOfRange) &&
              estimate_t::kJump == static_cast<int>(Status::kJump) &&
              estimate_t::kFrozen == static_cast<int>(Status::kFrozen) &&
              estimate_t::kUnlikely == static_cast<int>(Status::kUnlikely));
static_assert(detection_t::kNone == static_cast<int>(Contact::kNone) &&
              detection_t::kIntentional == static_cast<int>(Contact::kIntentional) &&
              detection_t::kCollision == static_cast<int>(Contact::kCollision) &&
              detection_t::kClamping == static_cast<int>(Contact::kClamping));

constexpr auto kRelaxed = std::memory_order_relaxed;

// by the one thread that writes
template <class T>
void add(std::atomic<T>& to, T value) noexcept {
  to.store(to.load(kRelaxed) + value, kRelaxed);
}

std::int64_t now_ns() noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

// or until `stop` is set, which a gap in the samples must not outlast
void sleep_until(std::int64_t due, const std::atomic<bool>& stop) noexcept {
  constexpr std::int64_t kLook = 20'000'000;  // [ns]
  for (std::int64_t now = now_ns(); now < due && !stop.load(kRelaxed); now = now_ns()) {
    const std::int64_t ns = std::min(due, now + kLook);
    const timespec until{ns / 1'000'000'000, ns % 1'000'000'000};
    ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
  }
}

// [s] from the first sample of a round to that of the next one
double round_time(const std::vector<Reading>& all) {
  const double span = all.back().t - all.front().t;
  return all.size() > 1 ? span + span / static_cast<double>(all.size() - 1) : 1;
}

}  // namespace

double LiveFigures::rmse() const noexcept {
  const auto n = static_cast<double>(compared.load(kRelaxed));
  if (n == 0) return std::numeric_limits<double>::quiet_NaN();
  double worst = 0;
  for (const auto& s : squares) worst = std::max(worst, s.load(kRelaxed));
  return std::sqrt(worst / n);
}

std::vector<Stream> streams_of(const std::vector<std::string>& estimators,
                               const std::string& detector, const std::string& site) {
  std::vector<Stream> streams;
  for (const std::string& e : estimators) streams.push_back({e, detector, site});
  return streams;
}

LiveEstimation::LiveEstimation(const Robot& robot, const std::vector<std::string>& estimators,
                               const std::string& detector, const DetectorsOf& thresholds_of,
                               const Trace& trace, LiveStream* stream, const ArmForces* forces)
    : dof_(robot.dof()), stream_(stream), forces_(forces) {
  if (robot.dof() > kMaxJoints) {
    throw std::invalid_argument(
        fmt::format("{} has {} joints: a message holds {}", robot.name(), robot.dof(), kMaxJoints));
  }
  refuse_twice("estimator", estimators);
  for (const std::string& e : estimators) {
    const DetectorSettings settings{.thresholds =
                                        thresholds_of ? thresholds_of(e) : DetectorThresholds()};
    pairs_.emplace_back(new Watched{e, robot.pair(e, detector, trace, settings)});
  }
}

void LiveEstimation::take(const Reading& r) noexcept {
  sample_.reading = r;
  for (int i = 0; i < size(); ++i) {
    Watched& e = *pairs_[i];
    const std::int64_t begin = now_ns();
    const StepResult s =
        e.pair.step(r.t, r.q.data(), r.qd.data(), r.tau.data(), sample_.tau_ext_hat.data());
    const std::int64_t step = now_ns() - begin;
    e.figures.step_ns.add(step);
    if (s.status != Status::kOk && (e.started || s.status != Status::kStarted)) {
      add<std::int64_t>(e.figures.unusable, 1);
    }
    e.started = e.started || s.status == Status::kStarted;
    e.figures.counts.add(s.status, s.joints);
    if (s.detection.mark) add<std::int64_t>(e.figures.marks, 1);
    if (r.reference != ReferenceKind::kNone) compare(r, sample_.tau_ext_hat, e.figures);
    if (forces_ != nullptr) find_force(r, e.figures);
    if (stream_ == nullptr) continue;
    sample_.stream = i;
    sample_.step_us = static_cast<double>(step) * 1e-3;
    sample_.status = static_cast<std::int8_t>(s.status);
    sample_.mark = s.detection.mark;
    sample_.score = s.detection.score;
    sample_.contact = static_cast<std::int8_t>(s.detection.contact);
    stream_->push(sample_);
  }
  add<std::int64_t>(samples_, 1);
}

void LiveEstimation::find_force(const Reading& r, LiveFigures& f) noexcept {
  const SiteForce s = forces_->at_site(r.q.data(), sample_.tau_ext_hat.data());
  const TouchPlace touch = forces_->touch(r.q.data(), sample_.tau_ext_hat.data());
  LiveForce& out = sample_.force;
  const auto keep = [](auto& to, const auto& from) {
    std::copy(from.begin(), from.end(), to.begin());
  };
  keep(out.force, s.force);
  keep(out.moment, s.moment);
  keep(out.seen, s.seen);
  keep(out.point, touch.line.point);
  keep(out.direction, touch.line.direction);
  out.left_over = s.left_over;
  out.link = touch.link + 1;
  if (!(s.force.norm() > f.largest_force.load(kRelaxed))) return;
  f.largest_force.store(s.force.norm(), kRelaxed);
  f.touched.store(out.link, kRelaxed);
}

void LiveEstimation::compare(const Reading& r, const Joints& hat, LiveFigures& f) noexcept {
  if (!plausible(r.tau_ext, r.n)) return;  // a driver may have none for a while
  double largest = f.largest_error.load(kRelaxed);
  for (int j = 0; j < r.n; ++j) {
    const double error = hat[j] - r.tau_ext[j];
    add(f.squares[j], error * error);
    largest = std::max(largest, std::abs(error));
  }
  f.largest_error.store(largest, kRelaxed);
  add<std::int64_t>(f.compared, 1);
}

void LiveEstimation::reset() noexcept {
  for (const auto& e : pairs_) {
    e->pair.reset();
    e->started = false;
  }
}

void play(const std::vector<Reading>& readings, const Pace& pace, LiveEstimation& estimation,
          Histogram& late, const std::atomic<bool>& stop) {
  const double first = readings.front().t, round = round_time(readings);
  const std::int64_t start = now_ns();
  std::int64_t seq = 0;
  Reading r;
  for (double offset = 0; !stop.load(kRelaxed); offset += round) {
    estimation.reset();
    for (const Reading& recorded : readings) {
      const double elapsed = (recorded.t - first + offset) / pace.speed;
      if (pace.duration > 0 && elapsed >= pace.duration) return;
      const std::int64_t due = start + std::llround(elapsed * 1e9);
      sleep_until(due, stop);
      if (stop.load(kRelaxed)) return;
      late.add(now_ns() - due);
      r = recorded;
      r.seq = seq++;
      if (offset > 0) {
        r.t += offset;
        r.utime = std::llround(r.t * 1e6);
      }
      estimation.take(r);
    }
    if (!pace.again) return;
  }
}

}  // namespace tauext::live

// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/emitter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace tauext {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

// n values and zeros behind them
void copy(const Joints& from, int n, double* to) {
  std::fill(std::copy_n(from.begin(), n, to), to + kMaxJoints, 0.0);
}

// the extremes of what is finite; no chart could show the rest
void hold_extremes(const Joints& values, int n, double* least, double* most) {
  for (int j = 0; j < n; ++j) {
    if (!std::isfinite(values[j])) continue;
    least[j] = std::min(least[j], values[j]);
    most[j] = std::max(most[j], values[j]);
  }
}

void begin_extremes(int n, double* least, double* most) {
  std::fill(std::fill_n(least, n, kInf), least + kMaxJoints, 0.0);
  std::fill(std::fill_n(most, n, -kInf), most + kMaxJoints, 0.0);
}

// where nothing was finite
void end_extremes(int n, double* least, double* most) {
  for (int j = 0; j < n; ++j) {
    if (least[j] > most[j]) least[j] = most[j] = std::numeric_limits<double>::quiet_NaN();
  }
}

}  // namespace

std::optional<std::int64_t> messages_of(const summary_t& s, std::string_view estimator) {
  const std::string name = "/" + std::string(estimator);
  const bool alone = s.entry.ends_with(name);
  const std::int64_t all = s.published + s.failed;  // those that failed had a number, too
  if (all <= 0 || (!alone && s.entry.find(name + "+") == std::string::npos)) return {};
  return alone ? all : all / 2;  // an estimate and a detection each time
}

Emitter::Emitter(const std::vector<Stream>& streams, double rate, Sink sink)
    : rate_(rate), sink_(std::move(sink)) {
  if (!(rate >= 0 && std::isfinite(rate))) {
    throw std::invalid_argument(
        fmt::format("{} messages a second: a rate is 0 (every sample) or more", rate));
  }
  std::size_t largest = estimate_t{}.getEncodedSize();
  for (const Stream& s : streams) {
    Channel c;
    c.name = kEstimateChannel + s.estimator;
    if (c.name.size() > kLongestChannel) {
      throw std::invalid_argument(
          fmt::format("channel {} is longer than LCM's {} characters", c.name, kLongestChannel));
    }
    c.detection.estimator = s.estimator;
    c.detection.detector = s.detector;
    c.force.estimator = s.estimator;
    c.force.site = s.site;
    for (const int size : {c.detection.getEncodedSize(), c.force.getEncodedSize()})
      largest = std::max(largest, static_cast<std::size_t>(size));
    channels_.push_back(std::move(c));
  }
  buffer_.resize(largest);
}

void Emitter::add(const LiveSample& s) {
  if (!any_) first_utime_ = s.reading.utime;
  any_ = true;
  Channel& c = channels_[s.stream];
  if (c.estimate.samples > 0 && s.reading.n != c.estimate.n) emit(c);
  hold(c, s);
  // a message where time enters another slot of 1 / rate; 1 us for clocks that were rounded
  const double elapsed = static_cast<double>(s.reading.utime - first_utime_ + 1);
  const auto slot = static_cast<std::int64_t>(std::floor(elapsed * rate_ * 1e-6));
  if (c.started && rate_ > 0 && slot == c.slot && !s.mark) return;
  c.started = true;
  c.slot = slot;
  emit(c);
}

void Emitter::flush() {
  for (Channel& c : channels_) {
    if (c.estimate.samples > 0) emit(c);
  }
}

void Emitter::begin(Channel& c, int n) {
  estimate_t& e = c.estimate;
  detection_t& d = c.detection;
  e.n = n;
  e.status = 0;
  e.step_us = d.score = 0;
  begin_extremes(n, e.tau_ext_hat_min, e.tau_ext_hat_max);
  begin_extremes(n, e.tau_ext_true_min, e.tau_ext_true_max);
  d.mark = d.contact = d.contact_true = 0;
  d.mark_utime = 0;
  c.force.force_max = 0;
}

void Emitter::hold(Channel& c, const LiveSample& s) {
  estimate_t& e = c.estimate;
  const Reading& r = s.reading;
  if (e.samples == 0) begin(c, r.n);
  ++e.samples;
  e.utime = r.utime;
  e.t = r.t;
  e.reference = static_cast<std::int8_t>(r.reference);
  if (e.status == 0) e.status = s.status;
  e.step_us = std::max(e.step_us, s.step_us);
  copy(r.q, r.n, e.q);
  copy(r.qd, r.n, e.qd);
  copy(r.tau, r.n, e.tau);
  copy(r.tau_ext, r.n, e.tau_ext_true);
  copy(s.tau_ext_hat, r.n, e.tau_ext_hat);
  hold_extremes(s.tau_ext_hat, r.n, e.tau_ext_hat_min, e.tau_ext_hat_max);
  hold_extremes(r.tau_ext, r.n, e.tau_ext_true_min, e.tau_ext_true_max);
  hold(c.detection, s);
  hold(c.force, s);
}

void Emitter::hold(detection_t& d, const LiveSample& s) {
  d.utime = s.reading.utime;
  d.score = std::max(d.score, s.score);
  d.contact_true = static_cast<std::int8_t>(d.contact_true != 0 || s.reading.contact);
  if (d.mark == 0) d.contact = s.contact;
  if (s.mark && d.mark == 0) {
    d.mark = 1;
    d.mark_utime = s.reading.utime;
  }
}

void Emitter::hold(force_t& f, const LiveSample& s) {
  f.utime = s.reading.utime;
  f.t = s.reading.t;
  const auto keep = [](const auto& from, double* to) { std::copy(from.begin(), from.end(), to); };
  keep(s.force.force, f.force);
  keep(s.force.moment, f.moment);
  keep(s.force.seen, f.seen);
  keep(s.force.point, f.point);
  keep(s.force.direction, f.direction);
  f.left_over = s.force.left_over;
  f.link = s.force.link;
  const double size = std::hypot(f.force[0], f.force[1], f.force[2]);
  if (size > f.force_max) f.force_max = size;  // not where it is no number
}

void Emitter::emit(Channel& c) {
  estimate_t& e = c.estimate;
  end_extremes(e.n, e.tau_ext_hat_min, e.tau_ext_hat_max);
  end_extremes(e.n, e.tau_ext_true_min, e.tau_ext_true_max);
  c.detection.samples = c.force.samples = e.samples;
  const auto count = [&c](bool sent) { ++(sent ? c.counts.sent : c.counts.failed); };
  count(send(c.name.c_str(), e));
  if (!c.detection.detector.empty()) count(send(kDetectionChannel, c.detection));
  if (!c.force.site.empty()) send(kForceChannel, c.force);
  e.samples = 0;
}

template <class Message>
bool Emitter::send(const char* name, Message& m) {
  const std::size_t size = encode(m, buffer_);
  ++m.seq;
  const bool sent = size > 0 && sink_(name, m.utime, {buffer_.data(), size});
  ++(sent ? counts_.sent : counts_.failed);
  return sent;
}

}  // namespace tauext

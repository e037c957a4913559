// SPDX-License-Identifier: Apache-2.0
#include "lcmtypes/emitter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace tauext {
namespace {

constexpr std::size_t kLongestChannel = 63;  // LCM_MAX_CHANNEL_NAME_LENGTH

void copy(const Joints& from, double* to) {
  std::copy(from.begin(), from.end(), to);
}

}  // namespace

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
    largest = std::max<std::size_t>(largest, c.detection.getEncodedSize());
    channels_.push_back(std::move(c));
  }
  buffer_.resize(largest);
}

void Emitter::add(const LiveSample& s) {
  if (!any_) first_utime_ = s.reading.utime;
  any_ = true;
  Channel& c = channels_[s.stream];
  hold(c, s);
  // a message where time enters another slot of 1 / rate; 1 us for clocks that were rounded
  const double elapsed = static_cast<double>(s.reading.utime - first_utime_ + 1);
  const auto slot = static_cast<std::int64_t>(std::floor(elapsed * rate_ * 1e-6));
  if (c.started && rate_ > 0 && slot == c.slot) return;
  c.started = true;
  c.slot = slot;
  emit(c);
}

void Emitter::flush() {
  for (Channel& c : channels_) {
    if (c.estimate.samples > 0) emit(c);
  }
}

void Emitter::hold(Channel& c, const LiveSample& s) {
  estimate_t& e = c.estimate;
  detection_t& d = c.detection;
  const Reading& r = s.reading;
  if (e.samples == 0) {
    e.status = 0;
    e.step_us = d.score = 0;
    d.mark = d.contact = d.contact_true = 0;
    d.mark_utime = 0;
    copy(s.tau_ext_hat, e.tau_ext_hat_min);
    copy(s.tau_ext_hat, e.tau_ext_hat_max);
    copy(r.tau_ext, e.tau_ext_true_min);
    copy(r.tau_ext, e.tau_ext_true_max);
  }
  ++e.samples;
  e.utime = r.utime;
  e.t = r.t;
  e.n = r.n;
  e.reference = static_cast<std::int8_t>(r.reference);
  if (e.status == 0) e.status = s.status;
  e.step_us = std::max(e.step_us, s.step_us);
  copy(r.q, e.q);
  copy(r.qd, e.qd);
  copy(r.tau, e.tau);
  copy(r.tau_ext, e.tau_ext_true);
  copy(s.tau_ext_hat, e.tau_ext_hat);
  for (int j = 0; j < kMaxJoints; ++j) {
    e.tau_ext_hat_min[j] = std::min(e.tau_ext_hat_min[j], s.tau_ext_hat[j]);
    e.tau_ext_hat_max[j] = std::max(e.tau_ext_hat_max[j], s.tau_ext_hat[j]);
    e.tau_ext_true_min[j] = std::min(e.tau_ext_true_min[j], r.tau_ext[j]);
    e.tau_ext_true_max[j] = std::max(e.tau_ext_true_max[j], r.tau_ext[j]);
  }
  d.utime = r.utime;
  d.score = std::max(d.score, s.score);
  d.contact_true = static_cast<std::int8_t>(d.contact_true != 0 || r.contact);
  if (d.mark == 0) d.contact = s.contact;
  if (s.mark && d.mark == 0) {
    d.mark = 1;
    d.mark_utime = r.utime;
  }
}

void Emitter::emit(Channel& c) {
  c.detection.samples = c.estimate.samples;
  send(c, c.name.c_str(), c.estimate);
  if (!c.detection.detector.empty()) send(c, kDetectionChannel, c.detection);
  c.estimate.samples = 0;
}

template <class Message>
void Emitter::send(Channel& c, const char* name, Message& m) {
  const std::size_t size = encode(m, buffer_);
  ++m.seq;
  const bool sent = size > 0 && sink_(name, m.utime, {buffer_.data(), size});
  for (Counts* counts : {&c.counts, &counts_}) ++(sent ? counts->sent : counts->failed);
}

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
#include "bench/live/live_io.h"

#include <cstring>
#include <stdexcept>
#include <utility>

#include "bench/live/interrupt.h"
#include "bench/logs/lcm_trace.h"
#include "mjcf/trace/printable.h"

namespace tauext::live {

Outlet::Outlet(const Options& o, const std::string& title, double rate)
    : streams_(streams_of(o.estimators, o.detector, o.wrench)),
      viewers_(std::make_shared<Viewers>(o.page, o.plotjuggler, title)) {
  if (o.stream) {
    refuse_input_as_log(lcm_url(o.url));
    transport_ = std::make_shared<Transport>(o.url);
    if (!transport_->good()) say("streaming is off: " + transport_->trouble());
  }
  if (!o.stream && !viewers_->any()) return;
  stream_.emplace(streams_, rate,
                  [viewers = viewers_, transport = transport_](const char* channel, std::int64_t,
                                                               Bytes message) {
                    viewers->take(channel, message);
                    return transport ? transport->publish(channel, message) : viewers->any();
                  });
}

void Outlet::report_failures() {
  if (!transport_ || reported_ || !transport_->good() || stream_->counts().failed == 0) return;
  reported_ = true;
  say(fmt::format("messages to {} fail ({}); the run goes on", transport_->url(),
                  trouble_with(transport_->url()).empty() ? "send error" : "no route"));
}

StreamReport Outlet::finish(std::vector<summary_t> summaries) {
  StreamReport report;
  report.asked = stream_.has_value();
  if (!stream_) return report;
  report.url = transport_ ? transport_->url() : viewers_->where().substr(2);
  report.hung = !stream_->finish();
  report.counts = stream_->counts();
  if (report.hung) return report;
  publish(summaries, report.counts.dropped);
  viewers_->close();
  return report;
}

void Outlet::publish(std::vector<summary_t>& summaries, std::int64_t dropped) {
  for (int i = 0; i < static_cast<int>(summaries.size()); ++i) {
    summary_t& s = summaries[i];
    s.published = stream_->counts(i).sent;
    s.failed = stream_->counts(i).failed;
    s.ring_drops = dropped;
    std::vector<std::byte> bytes(s.getEncodedSize());
    const Bytes message(bytes.data(), encode(s, bytes));
    if (transport_) transport_->publish(kSummaryChannel, message);
    viewers_->take(kSummaryChannel, message);
  }
}

Inlet::Inlet(const Options& o, const Robot& robot, LiveEstimation& estimation, LiveReport& report)
    : channel_(o.subscribe),
      type_(message_type(o.type)),
      robot_(robot),
      estimation_(estimation),
      report_(report),
      listener_(o.url, {o.subscribe, kSummaryChannel},
                [this](std::string_view channel, Sender sender, Bytes message) {
                  if (channel == channel_) {
                    take(sender, message);
                  } else {
                    take_summary(sender, message);
                  }
                }) {}

bool Inlet::wait() {
  try {
    listener_.wait(50);
  } catch (const std::runtime_error& e) {
    say(e.what());
    report_.failed = true;
  }
  report_.arrivals = arrivals_.counts();
  report_.refused = listener_.refused();
  if (const std::string trouble = arrivals_.trouble(); !trouble.empty()) {
    say(fmt::format("{}: {}", channel_, trouble));
  }
  return !report_.failed;
}

void Inlet::take(Sender sender, Bytes message) {
  Reading reading;
  const Reject reject = read(message, type_, reading);
  if (reject != Reject::kNone || reading.n != robot_.dof()) {
    if (!explained_) explain(reject, reading.n);
    explained_ = true;
    arrivals_.reject(stamp_of(message), sender);
    return;
  }
  const Arrival arrival = arrivals_.take(reading, sender, microseconds_since(begin_));
  if (arrival == Arrival::kRestart) {
    say(fmt::format("{}: the sender has started anew; so do the estimators", channel_));
    estimation_.reset();
  }
  if (arrival == Arrival::kNext || arrival == Arrival::kRestart) estimation_.take(reading);
}

void Inlet::take_summary(Sender sender, Bytes message) {
  summary_t s{};
  if (!channel_.starts_with(kEstimateChannel) || decode(message, s) != Reject::kNone) return;
  const std::string estimator = channel_.substr(std::strlen(kEstimateChannel));
  if (const auto sent = messages_of(s, estimator)) arrivals_.end(*sent, sender);
}

void Inlet::explain(Reject reject, int joints) const {
  const std::string why = reject == Reject::kNone ? fmt::format("of {} joints, and {} has {}",
                                                                joints, robot_.name(), robot_.dof())
                                                  : describe(reject);
  say(fmt::format("{}: a message {}; the first that was rejected", channel_, why));
}

}  // namespace tauext::live

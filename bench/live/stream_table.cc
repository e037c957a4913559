// SPDX-License-Identifier: Apache-2.0
#include "bench/live/stream_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "mjcf/trace/table_writer.h"

namespace tauext::live {
namespace {

constexpr std::int64_t kSecond = 1'000'000;  // [us]

const char* contact_name(std::int8_t contact) {
  constexpr const char* kNames[] = {"", "intentional", "collision", "clamping"};
  return contact >= 0 && contact < 4 ? kNames[contact] : "?";
}

const char* status_name(std::int8_t status) {
  constexpr const char* kNames[] = {"ok", "started", "bad sample", "singular", "diverged"};
  return status >= 0 && status < 5 ? kNames[status] : "?";
}

// a text from outside may hold anything; a terminal should not obey it
std::string printable(std::string_view text) {
  std::string out;
  for (const char c : text.substr(0, 60)) out += c >= ' ' && c <= '~' ? c : '?';
  return out;
}

}  // namespace

template <class Message>
bool StreamTable::decoded(Bytes message, Message& m) {
  const Reject reject = decode(message, m);
  if (reject == Reject::kNone) {
    ++good_;
  } else {
    ++rejects_[reject];
  }
  return reject == Reject::kNone;
}

void StreamTable::take(std::string_view channel, std::int64_t arrived, Bytes message) {
  const std::int64_t hash = hash_of(message);
  if (hash == detection_t::getHash()) {
    if (detection_t d; decoded(message, d)) take_detection(d, arrived);
  } else if (hash == summary_t::getHash()) {
    if (summary_t s; decoded(message, s)) take_summary(s);
  } else if (hash == sample_t::getHash()) {
    sample_t s{};
    if (!decoded(message, s)) return;
    Channel& c = of(channels_, printable(channel));
    c.newest.n = s.n;
    c.newest.t = s.t;
    c.newest.reference = s.reference;
    std::copy_n(s.tau_ext_true, kMaxJoints, c.newest.tau_ext_true);
    count(c, s.seq, arrived);
  } else {
    estimate_t e{};
    if (!decoded(message, e)) return;
    Channel& c = of(channels_, printable(channel));
    c.newest = e;
    c.estimate = true;
    count(c, e.seq, arrived);
  }
}

StreamTable::Channel& StreamTable::of(std::map<std::string, Channel, std::less<>>& all,
                                      const std::string& name) {
  constexpr std::size_t kMost = 100;  // names come from outside
  const auto it = all.find(name);
  if (it != all.end()) return it->second;
  return all.size() < kMost ? all[name] : others_;
}

void StreamTable::count(Channel& c, std::int64_t seq, std::int64_t arrived) {
  c.sequence.take(seq);
  c.arrivals.push_back(arrived);
  while (c.arrivals.front() <= arrived - kSecond) c.arrivals.pop_front();
}

template <class Count>
std::int64_t StreamTable::sum(Count&& count) const {
  std::int64_t sum = 0;
  for (const auto* all : {&channels_, &pairs_}) {
    for (const auto& [name, c] : *all) sum += count(c.sequence);
  }
  return sum;
}

std::int64_t StreamTable::lost() const {
  return sum([](const Sequence& s) { return s.lost(); });
}

std::int64_t StreamTable::strays() const {
  return sum([](const Sequence& s) { return s.strays(); });
}

void StreamTable::take_detection(const detection_t& d, std::int64_t arrived) {
  const std::string pair = printable(d.estimator) + "+" + printable(d.detector);
  count(of(pairs_, pair), d.seq, arrived);
  if (d.mark == 0) return;
  events_.push_back(fmt::format("{:.3f} s  {} marks{}{}", static_cast<double>(d.mark_utime) / 1e6,
                                pair, d.contact == 0 ? "" : ": ", contact_name(d.contact)));
}

void StreamTable::take_summary(const summary_t& s) {
  std::string line = printable(s.entry);
  if (!s.error.empty()) line += "  FAILED: " + printable(s.error);
  if (s.rmse_Nm >= 0) line += fmt::format("  rmse {:.4g} N m", s.rmse_Nm);
  if (s.step_ns >= 0) line += fmt::format("  step {:.4g} ns", s.step_ns);
  if (s.published > 0)
    line += fmt::format("  {} messages, {} samples dropped", s.published, s.ring_drops);
  events_.push_back(line);
}

std::vector<std::string> StreamTable::events() {
  return std::exchange(events_, {});
}

std::int64_t StreamTable::rejected() const {
  std::int64_t sum = 0;
  for (const auto& [reason, count] : rejects_) sum += count;
  return sum;
}

std::string StreamTable::format(std::int64_t now) const {
  TableWriter table({{"channel", "", true, 28},
                     {"rate", "1/s", false, 6},
                     {"lost", "", false, 6},
                     {"joint", "", false, 5},
                     {"tau_ext", "N m", false, 9},
                     {"least", "N m", false, 9},
                     {"largest", "N m", false, 9},
                     {"reference", "N m", false, 9},
                     {"status", "", true, 10},
                     {"step", "us", false, 7}});
  const auto torque = [](bool known, double x) { return known ? fmt::format("{:.3f}", x) : "-"; };
  for (const auto& [name, c] : channels_) {
    const estimate_t& e = c.newest;
    const auto recent = std::count_if(c.arrivals.begin(), c.arrivals.end(),
                                      [&](std::int64_t t) { return t > now - kSecond; });
    for (int j = 0; j < e.n; ++j) {
      const bool first = j == 0,
                 says = first && c.estimate;  // what holds for all joints stands once
      table.add({first ? name : "", first ? fmt::to_string(recent) : "",
                 first ? fmt::to_string(c.sequence.lost()) : "", fmt::to_string(j + 1),
                 torque(c.estimate, e.tau_ext_hat[j]), torque(c.estimate, e.tau_ext_hat_min[j]),
                 torque(c.estimate, e.tau_ext_hat_max[j]),
                 torque(e.reference != estimate_t::kNone, e.tau_ext_true[j]),
                 says ? status_name(e.status) : "", says ? fmt::format("{:.1f}", e.step_us) : ""});
    }
  }
  return table.format();
}

std::string StreamTable::totals() const {
  std::string out = fmt::format("{} messages, {} lost, {} rejected", good_, lost(), rejected());
  for (const auto& [reason, count] : rejects_)
    out += fmt::format("; {} {}", count, describe(reason));
  if (strays() > 0)
    out += fmt::format("; {} out of turn: copies, or two senders on one channel", strays());
  return out + "\n";
}

}  // namespace tauext::live

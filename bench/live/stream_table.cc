// SPDX-License-Identifier: Apache-2.0
#include "bench/live/stream_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "estimators/types.h"
#include "lcmtypes/emitter.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/table_writer.h"

namespace tauext::live {
namespace {

constexpr std::int64_t kSecond = 1'000'000;  // [us]

const char* contact_name(std::int8_t contact) {
  constexpr const char* kNames[] = {"", "intentional", "collision", "clamping"};
  return contact >= 0 && contact < 4 ? kNames[contact] : "?";
}

const char* status_name(std::int8_t status) {
  return status >= 0 && status < kStatusCount ? name_of(static_cast<Status>(status)) : "?";
}

// a name's beginning and its end, which tells specifications apart, in so many characters
std::string shortened(const std::string& name, std::size_t most) {
  if (name.size() <= most) return name;
  return name.substr(0, most / 2 - 1) + "~" + name.substr(name.size() - most / 2);
}

std::string number_or_dash(bool known, double x) {
  return known ? fmt::format("{:.3f}", x) : "-";
}

// [N], or from 3 on [N m]; "-" for a component of which less than half is seen
std::string seen(const force_t& f, int component) {
  const double value = component < 3 ? f.force[component] : f.moment[component - 3];
  return number_or_dash(f.seen[component] >= 0.5, value);
}

}  // namespace

std::int64_t StreamTable::Channel::rate(std::int64_t now) const {
  return std::count_if(arrivals.begin(), arrivals.end(),
                       [now](std::int64_t t) { return t > now - kSecond; });
}

template <class Message>
bool StreamTable::decoded(Bytes message, const Envelope& e, Message& m) {
  const Reject reject = decode(message, m);
  if (reject == Reject::kNone) return true;
  ++rejects_[reject];
  const auto it = channels_.find(e.name);
  if (it != channels_.end() && it->second.senders.is_ours(e.sender))
    it->second.sequence.excuse(stamp_of(message).seq);
  return false;
}

bool StreamTable::take(std::string_view channel, Sender sender, std::int64_t arrived,
                       Bytes message) {
  const std::int64_t hash = hash_of(message);
  Envelope envelope{std::string(channel.substr(0, kLongestChannel)), sender, arrived};
  const auto take_as = [&]<class Message>(Message m) {
    return decoded(message, envelope, m) && use(m, envelope);
  };
  if (hash == detection_t::getHash()) return take_as(detection_t{});
  if (hash == force_t::getHash()) return take_as(force_t{});
  if (hash == summary_t::getHash()) return take_as(summary_t{});
  if (hash == sample_t::getHash()) return take_as(sample_t{});
  return take_as(estimate_t{});
}

bool StreamTable::use(const estimate_t& m, const Envelope& e) {
  Channel* const c = accept(channels_, e, m.seq);
  if (c == nullptr) return false;
  c->newest = m;
  return c->estimate = true;
}

bool StreamTable::use(const sample_t& s, const Envelope& e) {
  Channel* const c = accept(channels_, e, s.seq);
  if (c == nullptr) return false;
  c->newest.n = s.n, c->newest.t = s.t, c->newest.reference = s.reference;
  std::copy_n(s.tau_ext_true, kMaxJoints, c->newest.tau_ext_true);
  return true;
}

// the channel, if the message is the newest of its sender and its number is believed
StreamTable::Channel* StreamTable::accept(Channels& all, const Envelope& e, std::int64_t seq) {
  if (all.size() >= kMostNames && !all.contains(e.name)) {
    if (++beyond_ == 1)
      events_.push_back(fmt::format("{}: rejected, as are all names beyond the first {}",
                                    printable_name(e.name), kMostNames));
    return nullptr;
  }
  Channel& c = all[e.name];
  const Senders::Whose whose = c.senders.take(e.sender, e.arrived);
  Order order = Order::kRepeated;
  if (whose == Senders::Whose::kOther) {
    ++c.others;
  } else if (whose == Senders::Whose::kNew) {
    c.sequence.restart(seq);
    order = Order::kRestart;
  } else {
    const std::int64_t foreign = c.sequence.counts().foreign;
    order = c.sequence.take(seq);
    const bool in_turn = order == Order::kNext || order == Order::kRestart;
    const bool followed = c.sequence.counts().foreign == foreign;
    if (in_turn && followed)
      c.senders.in_turn(e.arrived);
    else
      c.senders.out_of_turn(e.arrived);
  }
  if (order == Order::kRestart)
    events_.push_back(printable_name(e.name) + ": the sender has started anew");
  if (const std::string trouble = c.senders.trouble(); !trouble.empty())
    events_.push_back(printable_name(e.name) + ": " + trouble);
  if (whose == Senders::Whose::kOther) return nullptr;
  c.arrivals.push_back(e.arrived);
  while (c.arrivals.front() <= e.arrived - kSecond) c.arrivals.pop_front();
  const bool used = order == Order::kRestart || (order == Order::kNext && c.sequence.is_settled());
  return used ? &c : nullptr;
}

Account StreamTable::account() const {
  Account sum{.used = summaries_, .rejected = beyond_};
  for (const auto& [reason, count] : rejects_) sum.rejected += count;
  for (const Channels* all : {&channels_, &pairs_, &forces_}) {
    for (const auto& [name, c] : *all) {
      const Sequence::Counts& n = c.sequence.counts();
      sum.used += n.next;
      sum.late += n.late;
      sum.repeated += n.repeated;
      sum.rejected += n.foreign + c.others;
      sum.lost += n.lost;
    }
  }
  return sum;
}

bool StreamTable::use(const detection_t& d, const Envelope& e) {
  const std::string pair = d.estimator + "+" + d.detector;
  if (accept(pairs_, {pair, e.sender, e.arrived}, d.seq) == nullptr) return false;
  if (d.mark != 0)
    events_.push_back(fmt::format("{:.3f} s  {} marks{}{}", static_cast<double>(d.mark_utime) / 1e6,
                                  printable_name(pair, 120), d.contact == 0 ? "" : ": ",
                                  contact_name(d.contact)));
  return true;
}

bool StreamTable::use(const force_t& f, const Envelope& e) {
  const std::string name = f.estimator + " at " + (f.site.empty() ? "end_effector" : f.site);
  Channel* const c = accept(forces_, {name, e.sender, e.arrived}, f.seq);
  if (c != nullptr) c->force = f;
  return c != nullptr;
}

bool StreamTable::use(const summary_t& s, const Envelope& e) {
  ++summaries_;
  take_end(s, e);
  std::string line = printable_name(s.entry);
  if (!s.error.empty()) line += "  FAILED: " + printable_name(s.error);
  if (s.rmse_Nm >= 0) line += fmt::format("  rmse {:.4g} N m", s.rmse_Nm);
  if (s.step_ns >= 0) line += fmt::format("  step {:.4g} ns", s.step_ns);
  if (s.published > 0)
    line += fmt::format("  {} messages, {} samples dropped", s.published, s.ring_drops);
  events_.push_back(line);
  return true;
}

// the last messages may have been lost, too
void StreamTable::take_end(const summary_t& s, const Envelope& e) {
  const auto end = [&](Channel& c, const std::string& estimator) {
    const auto sent = messages_of(s, estimator);
    if (!sent || !c.senders.is_ours(e.sender)) return;
    c.sequence.end(*sent);
    c.senders.end();
  };
  for (auto& [name, c] : channels_) {
    if (name.starts_with(kEstimateChannel)) end(c, name.substr(std::strlen(kEstimateChannel)));
  }
  for (auto& [name, c] : forces_) end(c, c.force.estimator);
  for (auto& [pair, c] : pairs_) {
    if (s.entry.ends_with("/" + pair)) end(c, pair.substr(0, pair.find('+')));
  }
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
  for (const auto& [name, c] : channels_) {
    const estimate_t& e = c.newest;
    const auto recent = c.rate(now);
    for (int j = 0; j < e.n; ++j) {
      const bool first = j == 0,
                 says = first && c.estimate;  // what holds for all joints stands once
      table.add({first ? name : "", first ? fmt::to_string(recent) : "",
                 first ? fmt::to_string(c.sequence.counts().lost) : "", fmt::to_string(j + 1),
                 number_or_dash(c.estimate, e.tau_ext_hat[j]),
                 number_or_dash(c.estimate, e.tau_ext_hat_min[j]),
                 number_or_dash(c.estimate, e.tau_ext_hat_max[j]),
                 number_or_dash(e.reference != estimate_t::kNone, e.tau_ext_true[j]),
                 says ? status_name(e.status) : "", says ? fmt::format("{:.1f}", e.step_us) : ""});
    }
  }
  return table.format() + (forces_.empty() ? "" : "\n" + format_forces(now, false));
}

std::string StreamTable::format_small(std::int64_t now, int joint) const {
  TableWriter table({{"estimator", "", true, 12},
                     {"rate", "1/s", false, 4},
                     {"joint", "", false, 5},
                     {"tau_ext", "N m", false, 8},
                     {"least", "N m", false, 8},
                     {"largest", "N m", false, 8},
                     {"reference", "N m", false, 9},
                     {"status", "", true, 10}});
  for (const auto& [name, c] : channels_) {
    const estimate_t& e = c.newest;
    const double* const shown = c.estimate ? e.tau_ext_hat : e.tau_ext_true;
    const double* const worst = std::max_element(
        shown, shown + e.n, [](double a, double b) { return std::abs(a) < std::abs(b); });
    const auto j = joint > 0 ? joint - 1 : worst - shown;
    if (j >= e.n) continue;
    const std::size_t prefix =
        name.starts_with(kEstimateChannel) ? std::strlen(kEstimateChannel) : 0;
    table.add({shortened(name.substr(prefix), 12), fmt::to_string(c.rate(now)),
               fmt::to_string(j + 1), number_or_dash(c.estimate, e.tau_ext_hat[j]),
               number_or_dash(c.estimate, e.tau_ext_hat_min[j]),
               number_or_dash(c.estimate, e.tau_ext_hat_max[j]),
               number_or_dash(e.reference != estimate_t::kNone, e.tau_ext_true[j]),
               c.estimate ? std::string(status_name(e.status)).substr(0, 10) : ""});
  }
  return table.format();
}

int StreamTable::joints() const {
  int most = 0;
  for (const auto& [name, c] : channels_) most = std::max(most, static_cast<int>(c.newest.n));
  return most;
}

std::string StreamTable::format_forces(std::int64_t now, bool small) const {
  if (forces_.empty()) return "";
  const std::size_t width = small ? 8 : 9, widest = small ? 22 : 28;
  std::vector<TableWriter::Column> columns = {{"force", "", true, widest},
                                              {"rate", "1/s", false, 4}};
  if (!small) columns.push_back({"lost", "", false, 6});
  for (const char* axis : {"x", "y", "z", "largest"}) columns.push_back({axis, "N", false, width});
  if (!small) {
    for (const char* axis : {"about x", "y", "z"}) columns.push_back({axis, "N m", false, width});
  }
  columns.push_back({"link", "", false, 4});
  TableWriter table(columns);
  for (const auto& [name, c] : forces_) {
    const force_t& f = c.force;
    const std::string shown = printable_name(name, 120);
    std::vector<std::string> cells = {small ? shortened(shown, widest) : shown,
                                      fmt::to_string(c.rate(now))};
    if (!small) cells.push_back(fmt::to_string(c.sequence.counts().lost));
    for (int i = 0; i < 3; ++i) cells.push_back(seen(f, i));
    cells.push_back(fmt::format("{:.3f}", f.force_max));
    for (int i = 3; i < 6 && !small; ++i) cells.push_back(seen(f, i));
    cells.push_back(f.link > 0 ? fmt::to_string(f.link) : "-");
    table.add(std::move(cells));
  }
  return table.format();
}

std::string StreamTable::totals(const GroupSocket::Counts& refused) const {
  const Account all = account();
  std::string out = tauext::format(all, refused) + "\n";
  std::int64_t foreign = all.rejected - beyond_;
  std::vector<std::string> why;
  for (const auto& [reason, count] : rejects_) {
    foreign -= count;
    why.push_back(fmt::format("{} {}", count, describe(reason)));
  }
  if (foreign > 0) why.push_back(fmt::format("{} of a second sender", foreign));
  if (beyond_ > 0) why.push_back(fmt::format("{} of more names than are shown", beyond_));
  if (!why.empty()) out += fmt::format("rejected: {}\n", fmt::join(why, ", "));
  if (const std::string r = tauext::format(refused); !r.empty()) out += "refused: " + r + "\n";
  return out;
}

}  // namespace tauext::live

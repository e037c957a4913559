// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/lcm_trace.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string_view>

#include "lcmtypes/emitter.h"
#include "lcmtypes/receive/arrivals.h"
#include "mjcf/trace/input_file.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

const char* channel_of(MessageType type) {
  switch (type) {
    case MessageType::kIiwa:
      return "IIWA_STATUS";
    case MessageType::kPanda:
      return "PANDA_STATUS";
    case MessageType::kTauext:
      break;
  }
  return kSampleChannel;
}

// channels whose messages carry measurements
std::vector<std::string> channels_in(const std::string& path) {
  std::vector<std::string> names;
  read_log(path, [&](const LogEvent& e) {
    MessageType type{};
    if (type_of(e.message, type) != Reject::kNone) return;
    if (std::find(names.begin(), names.end(), e.channel) == names.end()) {
      names.emplace_back(e.channel);
    }
  });
  return names;
}

std::string choose_channel(const std::string& path, const std::string& wanted) {
  const std::vector<std::string> names = channels_in(path);
  if (names.empty()) throw std::runtime_error(fmt::format("{}: no measurements in it", path));
  const auto has = [&](const std::string& n) {
    return std::find(names.begin(), names.end(), n) != names.end();
  };
  const std::string known = one_line(fmt::format("{}", fmt::join(names, ", ")));
  if (!wanted.empty() && !has(wanted)) {
    throw std::runtime_error(
        fmt::format("{}: no measurements on channel {}; it has {}", path, wanted, known));
  }
  if (!wanted.empty()) return wanted;
  if (names.size() == 1) return names[0];
  if (has(kSampleChannel)) return kSampleChannel;
  throw std::runtime_error(
      fmt::format("{}: choose one of its channels by --channel: {}", path, known));
}

Eigen::VectorXd vector(const Joints& values, int n) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), n);
}

Trace trace_of(const std::vector<Reading>& all) {
  const int n = all[0].n, size = static_cast<int>(all.size());
  const auto all_have = [&](ReferenceKind kind) {
    return std::all_of(all.begin(), all.end(),
                       [&](const Reading& r) { return r.reference == kind; });
  };
  const bool truth = all_have(ReferenceKind::kTruth), sender = all_have(ReferenceKind::kSender);
  constexpr double kWallClock = 1e8;  // [s]
  const double origin = all[0].t > kWallClock ? all[0].t : 0;
  Trace trace;
  trace.q.resize(n, size);
  trace.qd.resize(n, size);
  trace.tau.resize(n, size);
  trace.tau_ext.resize(n, truth ? size : 0);
  trace.tau_ext_of_driver.resize(n, sender ? size : 0);
  for (int k = 0; k < size; ++k) {
    const Reading& r = all[k];
    trace.t.push_back(r.t - origin);
    trace.q.col(k) = vector(r.q, n);
    trace.qd.col(k) = vector(r.qd, n);
    trace.tau.col(k) = vector(r.tau, n);
    if (truth) trace.tau_ext.col(k) = vector(r.tau_ext, n);
    if (sender) trace.tau_ext_of_driver.col(k) = vector(r.tau_ext, n);
    if (truth) trace.contact.push_back(r.contact);
  }
  return trace;
}

// without those of another arm than most
std::vector<Reading> of_most_joints(std::vector<Reading> all, LogReport& found) {
  std::array<std::size_t, kMaxJoints + 1> count{};
  for (const Reading& r : all) ++count[r.n];
  const auto n = std::max_element(count.begin(), count.end()) - count.begin();
  found.rejected +=
      static_cast<std::int64_t>(std::erase_if(all, [&](const Reading& r) { return r.n != n; }));
  return all;
}

// t [s] says the same as utime only to a rounding, so it may stand still where utime goes on
void drop_repeated_t(std::vector<Reading>& all, LogReport& found) {
  double newest = -1;
  found.out_of_order += static_cast<std::int64_t>(std::erase_if(all, [&](const Reading& r) {
    const bool repeated = r.t <= newest;
    newest = std::max(newest, r.t);
    return repeated;
  }));
}

// those that an estimator would have got
std::vector<Reading> in_order(const std::vector<Reading>& recorded, const std::string& path,
                              LogReport& found) {
  Arrivals arrivals;
  std::vector<Reading> used, late;
  for (const Reading& r : recorded) {
    const Arrival arrival = arrivals.take(r, 0, r.utime);
    if (arrival == Arrival::kNext) {
      used.push_back(r);
      late.clear();
    }
    if (arrival == Arrival::kLate) late.push_back(r);
    if (arrival != Arrival::kRestart) continue;
    used.pop_back();  // one false time far ahead, to which all after it were late
    late.erase(late.begin(), late.end() - (Sequence::kPatience - 1));
    if (!used.empty() && used.back().utime >= late.front().utime) {
      throw std::runtime_error(fmt::format(
          "{}: time goes back on channel {}: the sender was restarted, or there are several; "
          "give it one run a log",
          path, printable_name(found.channel)));
    }
    ++found.rejected;
    found.out_of_order -= static_cast<std::int64_t>(late.size());
    used.insert(used.end(), late.begin(), late.end());
    used.push_back(r);
  }
  found.two_arms = arrivals.counts().two_arms;
  found.out_of_order += arrivals.counts().late + arrivals.counts().repeated;
  found.lost = arrivals.counts().lost;
  drop_repeated_t(used, found);
  return used;
}

}  // namespace

std::int64_t utime_of(double t) {
  return std::llround(t * 1e6);
}

std::vector<Reading> readings_of(const Trace& trace) {
  const int n = trace.dof();
  if (n > kMaxJoints) {
    throw std::invalid_argument(fmt::format("{} joints: a message holds {}", n, kMaxJoints));
  }
  const double origin = trace.size() > 0 ? std::min(trace.t[0], 0.0) : 0;
  std::vector<Reading> all(trace.size());
  for (int k = 0; k < trace.size(); ++k) {
    Reading& r = all[k];
    r.seq = k;
    r.t = trace.t[k] - origin;
    r.utime = utime_of(r.t);
    r.n = n;
    Eigen::VectorXd::Map(r.q.data(), n) = trace.q.col(k);
    Eigen::VectorXd::Map(r.qd.data(), n) = trace.qd.col(k);
    Eigen::VectorXd::Map(r.tau.data(), n) = trace.tau.col(k);
    if (trace.has_truth()) {
      r.reference = ReferenceKind::kTruth;
      Eigen::VectorXd::Map(r.tau_ext.data(), n) = trace.tau_ext.col(k);
    } else if (trace.tau_ext_of_driver.cols() > 0) {
      r.reference = ReferenceKind::kSender;
      Eigen::VectorXd::Map(r.tau_ext.data(), n) = trace.tau_ext_of_driver.col(k);
    }
    if (!trace.contact.empty()) r.contact = trace.contact[k] != 0;
  }
  return all;
}

void append_samples(const std::vector<Reading>& readings, MessageType type, LogBuffer& log) {
  for (const Reading& r : readings) log.append(channel_of(type), r.utime, write(r, type));
}

std::string LogReport::in_words() const {
  std::string text;
  const auto add = [&](std::int64_t count, const char* what) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, what);
  };
  add(rejected, "messages rejected");
  add(out_of_order, "late or repeated");
  add(lost, "lost");
  add(faults.junk_bytes, "bytes of junk between events");
  add(faults.truncated, "event cut off at the end");
  if (two_arms) {
    text += fmt::format("{}positions jump to and fro: do two arms share the channel?",
                        text.empty() ? "" : "; ");
  }
  return text;
}

Trace read_lcm(const std::string& path, const std::string& channel, LogReport* report) {
  LogReport unused;
  LogReport& found = report == nullptr ? unused : *report;
  claim_input(path);
  found.channel = choose_channel(path, channel);
  std::vector<Reading> recorded;
  found.faults = read_log(path, [&](const LogEvent& e) {
    if (e.channel != found.channel) return;
    MessageType type{};
    Reading r;
    if (type_of(e.message, type) == Reject::kNone && read(e.message, type, r) == Reject::kNone &&
        (r.reference != ReferenceKind::kTruth || plausible(r.tau_ext, r.n))) {
      recorded.push_back(r);
    } else {
      ++found.rejected;
    }
  });
  const std::vector<Reading> all = in_order(of_most_joints(recorded, found), path, found);
  if (all.empty()) {
    throw std::runtime_error(fmt::format("{}: {} messages on channel {}, and none is good", path,
                                         found.rejected, printable_name(found.channel)));
  }
  return trace_of(all);
}

bool is_lcm_log(const std::string& path) {
  const std::string name = std::filesystem::path(path).filename().string();
  return name.ends_with(".lcm") || name.starts_with("lcmlog-");
}

void refuse_input_as_log(const std::string& url) {
  constexpr std::string_view kScheme = "file://";
  if (!url.starts_with(kScheme)) return;
  refuse_input(url.substr(kScheme.size(), url.find('?') - kScheme.size()));
}

}  // namespace tauext

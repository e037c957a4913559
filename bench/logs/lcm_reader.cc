// SPDX-License-Identifier: Apache-2.0
#include "bench/logs/lcm_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <deque>
#include <stdexcept>
#include <utility>
#include <vector>

#include "lcmtypes/emitter.h"
#include "lcmtypes/reading.h"
#include "lcmtypes/receive/arrivals.h"
#include "mjcf/trace/input_file.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace detail {

// what a channel carries, by the number of joints
struct Census {
  struct Of {
    std::int64_t readings = 0, with_truth = 0, of_sender = 0;
  };
  std::array<Of, kMaxJoints + 1> of{};
  std::int64_t messages = 0;  // from the first one on that is of a type that we know

  int joints() const {  // of most
    const auto most = std::max_element(
        of.begin(), of.end(), [](const Of& a, const Of& b) { return a.readings < b.readings; });
    return static_cast<int>(most - of.begin());
  }
};

}  // namespace detail

namespace {

using detail::Census;

// a message's measurement; false if it has none that is good
bool measurement(Bytes message, Reading& r) {
  MessageType type{};
  return type_of(message, type) == Reject::kNone && read(message, type, r) == Reject::kNone &&
         (r.reference != ReferenceKind::kTruth || plausible(r.tau_ext, r.n));
}

// channels whose messages carry measurements, as they come
std::vector<std::pair<std::string, Census>> channels_in(const std::string& path) {
  std::vector<std::pair<std::string, Census>> all;
  read_log(path, [&](const LogEvent& e) {
    auto at =
        std::find_if(all.begin(), all.end(), [&](const auto& c) { return c.first == e.channel; });
    MessageType type{};
    if (at == all.end() && type_of(e.message, type) != Reject::kNone) return;
    if (at == all.end()) at = all.insert(at, {std::string(e.channel), {}});
    Census& census = at->second;
    ++census.messages;
    Reading r;
    if (!measurement(e.message, r)) return;
    Census::Of& of = census.of[static_cast<std::size_t>(r.n)];
    ++of.readings;
    of.with_truth += r.reference == ReferenceKind::kTruth;
    of.of_sender += r.reference == ReferenceKind::kSender;
  });
  return all;
}

std::pair<std::string, Census> choose_channel(const std::string& path, const std::string& wanted) {
  const auto all = channels_in(path);
  if (all.empty()) throw std::runtime_error(fmt::format("{}: no measurements in it", path));
  std::vector<std::string> names;
  for (const auto& [name, census] : all) names.push_back(name);
  const std::string known = one_line(fmt::format("{}", fmt::join(names, ", ")));
  const std::string& name = !wanted.empty()   ? wanted
                            : all.size() == 1 ? names[0]
                                              : std::string(kSampleChannel);
  for (const auto& channel : all) {
    if (channel.first == name) return channel;
  }
  if (!wanted.empty())
    throw std::runtime_error(
        fmt::format("{}: no measurements on channel {}; it has {}", path, wanted, known));
  throw std::runtime_error(
      fmt::format("{}: choose one of its channels by --channel: {}", path, known));
}

}  // namespace

struct LcmReader::Impl {
  Impl(const std::string& file, const std::string& channel)
      : path(file), chosen((claim_input(file), choose_channel(file, channel))), events(file) {
    const Census& census = chosen.second;
    found.channel = chosen.first;
    const int n = census.joints();
    const Census::Of& of = census.of[static_cast<std::size_t>(n)];
    if (of.readings == 0)
      throw std::runtime_error(fmt::format("{}: {} messages on channel {}, and none is good", path,
                                           census.messages, printable_name(found.channel)));
    contents.dof = n;
    contents.has_truth = contents.has_contact = of.with_truth == of.readings;
    contents.has_driver = of.of_sender == of.readings;
  }

  // takes the log's next message; false at its end
  bool take() {
    LogEvent e;
    if (!events.next(e)) return false;
    if (e.channel != found.channel) return true;
    Reading r;
    if (!measurement(e.message, r) || r.n != contents.dof) {
      ++found.rejected;
      return true;
    }
    switch (arrivals.take(r, 0, r.utime)) {
      case Arrival::kRestart:
        believe_late();
        [[fallthrough]];
      case Arrival::kNext:
        used.push_back(r);
        late.clear();
        break;
      case Arrival::kLate:
        late.push_back(r);
        if (late.size() >= Sequence::kPatience) late.pop_front();
        break;
      default:
        break;
    }
    return true;
  }

  // one false time lay far ahead, to which all after it were late
  void believe_late() {
    used.pop_back();
    if (!used.empty() && used.back().utime >= late.front().utime) {
      throw std::runtime_error(fmt::format(
          "{}: time goes back on channel {}: the sender was restarted, or there are several; "
          "give it one run a log",
          path, printable_name(found.channel)));
    }
    ++found.rejected;
    found.out_of_order -= static_cast<std::int64_t>(late.size());
    used.insert(used.end(), late.begin(), late.end());
  }

  // the next one that nothing can change any more
  bool next(Reading& r) {
    while (!ended && used.size() <= 2) ended = !take();
    if (used.empty()) return false;
    r = used.front();
    used.pop_front();
    return true;
  }

  LogReport report() const {
    LogReport all = found;
    all.faults = events.faults();
    all.two_arms = arrivals.counts().two_arms;
    all.out_of_order += arrivals.counts().late + arrivals.counts().repeated;
    all.lost = arrivals.counts().lost;
    return all;
  }

  void fill(const Reading& r, RecordedSample& s) {
    constexpr double kWallClock = 1e8;  // [s]
    const int n = contents.dof;
    if (counter.so_far().samples == 0 && r.t > kWallClock) origin = r.t;
    const auto copy = [n](const Joints& from, Eigen::VectorXd& to) {
      to = Eigen::VectorXd::Map(from.data(), n);
    };
    s.t = r.t - origin;
    copy(r.q, s.q), copy(r.qd, s.qd), copy(r.tau, s.tau);
    if (contents.has_truth) copy(r.tau_ext, s.tau_ext);
    if (contents.has_driver) copy(r.tau_ext, s.driver);
    s.contact = contents.has_truth && r.contact;
    counter.take(s.t, s.q, s.qd, s.tau);
  }

  std::string path;
  std::pair<std::string, Census> chosen;
  LogEvents events;
  RecordingContents contents;
  LogReport found;
  Arrivals arrivals;
  std::deque<Reading> used;  // not yet handed out; the last one may still turn out wrong
  std::deque<Reading> late;  // since then
  bool ended = false;
  double newest = -1, origin = 0;  // [s]
  RegularityCounter counter;
};

LcmReader::LcmReader(const std::string& path, const std::string& channel)
    : impl_(std::make_unique<Impl>(path, channel)) {}
LcmReader::~LcmReader() = default;

const RecordingContents& LcmReader::contents() const {
  return impl_->contents;
}
const Regularity& LcmReader::regularity() const {
  return impl_->counter.so_far();
}
LogReport LcmReader::report() const {
  return impl_->report();
}

bool LcmReader::next(RecordedSample& s) {
  for (Reading r; impl_->next(r);) {
    // t [s] says the same as utime only to a rounding, so it may stand still where utime goes on
    if (r.t <= impl_->newest) {
      ++impl_->found.out_of_order;
      continue;
    }
    impl_->newest = r.t;
    impl_->fill(r, s);
    return true;
  }
  return false;
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

}  // namespace tauext

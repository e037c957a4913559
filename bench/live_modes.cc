// SPDX-License-Identifier: Apache-2.0
#include "bench/live_modes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <optional>
#include <stdexcept>
#include <thread>

#include "bench/cli.h"
#include "bench/file_robot.h"
#include "bench/lcm_trace.h"
#include "bench/live_report.h"
#include "bench/stream_table.h"
#include "bench/thresholds.h"
#include "lcmtypes/arrivals.h"
#include "lcmtypes/listener.h"

namespace tauext {
namespace {

using Clock = std::chrono::steady_clock;

// Ctrl-C and kill as something to be asked for; made before the first thread, so that all block them
class Interrupt {
 public:
  Interrupt() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  }
  // true once one of them has come, waiting up to so long
  bool wait(double seconds) {
    const auto whole = static_cast<time_t>(seconds);
    const timespec t{whole, static_cast<long>((seconds - static_cast<double>(whole)) * 1e9)};
    seen_ = seen_ || sigtimedwait(&signals_, nullptr, &t) > 0;
    return seen_;
  }

 private:
  sigset_t signals_{};
  bool seen_ = false;
};

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

ThresholdSet thresholds_of(const LiveOptions& o) {
  if (o.thresholds.empty()) return {};
  return read_thresholds(o.thresholds).of(o.robot, o.sensors.velocity_noise);
}

// the samples to play: simulated with everything that reacts in it, or read
Trace recorded_trace(const LiveOptions& o, const Robot& r) {
  if (!o.from.empty()) return read_log_or_csv(o.from, o.channel);
  const Scenario& s = scenario(r.name, o.scenario);
  Supervisor supervisor;
  if (s.reacts && !o.detector.empty()) supervisor = r.supervisor(o.estimators[0], o.detector);
  if (::isatty(STDERR_FILENO) == 1)
    fmt::print(stderr, "simulating {} s of {}\n", s.duration, s.name);
  return measure(
      simulate(load_for(r.name, s, o.model_error), s, o.recording, o.sensors, supervisor),
      o.sensors);
}

Robot robot_or_file(const LiveOptions& o) {
  if (!o.robot.ends_with(".xml")) return robot(o.robot);
  if (!o.scenario.empty()) {
    throw std::invalid_argument(fmt::format(
        "--robot {}: a robot from a file has no scenarios; --from or --subscribe", o.robot));
  }
  return file_robot(o.robot);
}

std::string source_of(const LiveOptions& o) {
  if (!o.subscribe.empty()) return o.subscribe;
  return o.from.empty() ? o.scenario : o.from;
}

// a stream, if one was asked for, and what is to be said of it
class Outlet {
 public:
  Outlet(const LiveOptions& o, double rate) : streams_(streams_of(o.estimators, o.detector)) {
    if (!o.stream) return;
    transport_.emplace(o.url);
    if (!transport_->good()) fmt::print(stderr, "streaming is off: {}\n", transport_->trouble());
    stream_.emplace(&*transport_, streams_, rate);
  }

  LiveStream* stream() { return stream_ ? &*stream_ : nullptr; }

  // once: messages do not go out any more
  void report_failures() {
    if (!stream_ || reported_ || !transport_->good() || stream_->counts().failed == 0) return;
    reported_ = true;
    fmt::print(stderr, "\r\033[Kmessages to {} fail ({}); the run goes on\n", transport_->url(),
               trouble_with(transport_->url()).empty() ? "send error" : "no route");
  }

  StreamReport finish(const std::vector<summary_t>& summaries) {
    StreamReport report;
    report.asked = stream_.has_value();
    if (!stream_) return report;
    report.url = transport_->url();
    report.hung = !stream_->finish();
    report.counts = stream_->counts();
    if (report.hung) return report;
    for (int i = 0; i < static_cast<int>(summaries.size()); ++i) {
      summary_t s = summaries[i];
      s.published = stream_->counts(i).sent;
      s.failed = stream_->counts(i).failed;
      s.ring_drops = report.counts.dropped;
      std::vector<std::byte> bytes(s.getEncodedSize());
      const std::size_t size = encode(s, bytes);
      transport_->publish(kSummaryChannel, {bytes.data(), size});
    }
    return report;
  }

 private:
  std::vector<Stream> streams_;
  std::optional<Transport> transport_;  // outlives the stream's thread
  std::optional<LiveStream> stream_;
  bool reported_ = false;
};

int finish(const LiveOptions& o, Outlet& outlet, const LiveEstimation& e, LiveReport report) {
  report.title = fmt::format("{}/{}", o.robot, source_of(o));
  report.stream = outlet.finish(summaries_of(report, e, o.detector));
  fmt::print("{}", format(report, e));
  if (report.stream.hung) {  // its thread still holds the transport
    std::fflush(stdout);
    std::_Exit(kAnswerIsNo);
  }
  const bool silent = report.stream.asked && report.stream.counts.published == 0;
  return silent || e.samples() == 0 ? kAnswerIsNo : kGood;
}

}  // namespace

void check(const LiveOptions& o, bool listen) {
  const auto require = [](bool good, const std::string& what) {
    if (!good) throw std::invalid_argument(what + "; see tauext-live --help");
  };
  require(std::isfinite(o.pace.duration) && o.pace.duration >= 0,
          fmt::format("--duration {}: 0 s or more", o.pace.duration));
  if (listen) {
    require(o.robot.empty() && o.estimators.empty(),
            "--listen shows streams and estimates nothing");
    return;
  }
  const int sources = !o.scenario.empty() + !o.from.empty() + !o.subscribe.empty();
  require(sources == 1, "one of --scenario, --from, --subscribe and --listen is required");
  require(!o.robot.empty() && !o.estimators.empty(), "--robot and --estimator are required");
  require(o.pace.speed >= 1e-3 && o.pace.speed <= 1e3,
          fmt::format("--speed {}: 0.001 to 1000", o.pace.speed));
  require(o.rate >= 0 && o.rate <= 1e6, fmt::format("--rate {}: 0 to 1e6 a second", o.rate));
  message_type(o.type);
  for (const std::string& e : o.estimators) {
    require(o.subscribe != kEstimateChannel + e,
            fmt::format("--subscribe {}: its own estimates would come back to it", o.subscribe));
  }
}

int run_recorded(const LiveOptions& o) {
  const Robot r = robot_or_file(o);
  const Trace trace = recorded_trace(o, r);
  const std::vector<Reading> readings = readings_of(trace);
  Interrupt interrupt;
  Outlet outlet(o, o.rate / o.pace.speed);  // a rate of the clock's seconds
  LiveEstimation estimation(r, o.estimators, o.detector, thresholds_of(o), trace, outlet.stream());
  Histogram late;
  std::atomic<bool> stop = false, ended = false;
  const auto begin = Clock::now();
  std::thread loop([&] {
    play(readings, o.pace, estimation, late, stop);
    ended = true;
  });
  StatusLine status;
  while (!ended && !interrupt.wait(0.05)) {
    outlet.report_failures();
    status.show(estimation, &late, outlet.stream());
  }
  stop = true;
  loop.join();
  status.clear();
  LiveReport report;
  report.seconds = seconds_since(begin);
  report.late = &late;
  report.period = 1e-3 * 1e9 / o.pace.speed;
  return finish(o, outlet, estimation, report);
}

int run_subscribed(const LiveOptions& o) {
  const Robot r = robot_or_file(o);
  const MessageType type = message_type(o.type);
  Interrupt interrupt;
  Outlet outlet(o, o.rate);
  LiveEstimation estimation(r, o.estimators, o.detector, thresholds_of(o), Trace(),
                            outlet.stream());
  Arrivals arrivals;
  LiveReport report;
  report.subscribed = true;
  Listener listener(o.url, o.subscribe, [&](std::string_view channel, std::int64_t, Bytes message) {
    if (channel != o.subscribe) return;  // the name is a regular expression to LCM
    Reading reading;
    const Reject reject = read(message, type, reading);
    if (reject != Reject::kNone || reading.n != r.dof) {
      if (report.rejected++ > 0) return;
      const std::string why = reject == Reject::kNone ? fmt::format("of {} joints, and {} has {}",
                                                                    reading.n, r.name, r.dof)
                                                      : describe(reject);
      fmt::print(stderr, "\r\033[K{}: a message {}; the first that was rejected\n", o.subscribe,
                 why);
      return;
    }
    const Arrival arrival = arrivals.take(reading);
    if (arrival == Arrival::kRestart) estimation.reset();
    if (arrival == Arrival::kNext || arrival == Arrival::kRestart) estimation.take(reading);
  });
  const auto begin = Clock::now();
  StatusLine status;
  status.waiting_for(fmt::format("{} at {}", o.subscribe, listener.url()));
  while (!interrupt.wait(0) && !(o.pace.duration > 0 && seconds_since(begin) > o.pace.duration)) {
    listener.wait(50);
    outlet.report_failures();
    status.show(estimation, nullptr, outlet.stream());
  }
  status.clear();
  report.seconds = seconds_since(begin);
  report.arrivals = arrivals.counts();
  return finish(o, outlet, estimation, report);
}

int run_listen(const LiveOptions& o) {
  Interrupt interrupt;
  StreamTable table;
  Listener listener(o.url, "TAUEXT_.*",
                    [&](std::string_view channel, std::int64_t arrived, Bytes m) {
                      table.take(channel, arrived, m);
                    });
  const bool terminal = ::isatty(STDOUT_FILENO) == 1;
  const auto begin = Clock::now();
  auto shown = begin;
  std::vector<std::string> events;
  const auto take_events = [&] {
    for (std::string& line : table.events()) {
      if (!terminal) fmt::print("{}\n", line);
      events.push_back(std::move(line));
    }
    constexpr std::size_t kShown = 12;
    if (events.size() > kShown) events.erase(events.begin(), events.end() - kShown);
  };
  while (!interrupt.wait(0) && !(o.pace.duration > 0 && seconds_since(begin) > o.pace.duration)) {
    listener.wait(50);
    take_events();
    if (!terminal || seconds_since(shown) < 0.2) continue;
    shown = Clock::now();
    fmt::print("\033[H\033[2J{}  {:.0f} s\n\n{}\n{}\n{}\n", listener.url(), seconds_since(begin),
               table.format(), table.totals(), fmt::join(events, "\n"));
    std::fflush(stdout);
  }
  if (!terminal) fmt::print("{}{}", table.format(), table.totals());
  if (terminal) fmt::print("\n");
  return table.good() > 0 ? kGood : kAnswerIsNo;
}

}  // namespace tauext

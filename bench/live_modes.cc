// SPDX-License-Identifier: Apache-2.0
#include "bench/live_modes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <thread>

#include "bench/cli.h"
#include "bench/file_robot.h"
#include "bench/interrupt.h"
#include "bench/lcm_trace.h"
#include "bench/live_io.h"
#include "bench/live_report.h"
#include "bench/metrics.h"
#include "bench/thresholds.h"

namespace tauext {
namespace {

using Clock = std::chrono::steady_clock;

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
  Robot r = file_robot(o.robot);
  for (const std::string& e : o.estimators) {
    if (std::find(r.estimators.begin(), r.estimators.end(), e) != r.estimators.end()) continue;
    throw std::invalid_argument(
        fmt::format("a robot from a file has no estimator '{}', only those that need no tuning of "
                    "their own: {}",
                    e, fmt::join(r.estimators, ", ")));
  }
  return r;
}

std::string title_of(const LiveOptions& o) {
  return o.robot + "/" +
         (!o.subscribe.empty() ? o.subscribe
          : !o.from.empty()    ? o.from
                               : o.scenario);
}

int finish(const LiveOptions& o, Outlet& outlet, const LiveEstimation& e, LiveReport report) {
  report.title = title_of(o);
  report.stream = outlet.finish(summaries_of(report, e, o.detector));
  fmt::print("{}", format(report, e));
  if (report.stream.hung) {  // its thread is still in LCM
    std::fflush(stdout);
    std::_Exit(kAnswerIsNo);
  }
  const bool silent = report.stream.asked && report.stream.counts.published == 0;
  return silent || report.failed || e.samples() == 0 ? kAnswerIsNo : kGood;
}

// [ns] from one sample to the next, as most are
double period_of(const std::vector<Reading>& all, double speed) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < all.size(); ++k) steps.push_back(all[k].t - all[k - 1].t);
  return steps.empty() ? 0 : quantile(steps, 0.5) * 1e9 / speed;
}

// the control loop in a thread of its own, which ends with us
class Loop {
 public:
  Loop(const std::vector<Reading>& readings, const Pace& pace, LiveEstimation& estimation)
      : thread_([&readings, pace, &estimation, this] {
          play(readings, pace, estimation, late_, stop_);
          ended_ = true;
        }) {}
  ~Loop() { stop(); }
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;

  bool ended() const { return ended_; }
  void stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  const Histogram& late() const { return late_; }

 private:
  Histogram late_;
  std::atomic<bool> stop_ = false, ended_ = false;
  std::thread thread_;  // last: it uses the others
};

}  // namespace

void check(const LiveOptions& o, bool listen) {
  const auto require = [](bool good, const std::string& what) {
    if (!good) throw std::invalid_argument(what + "; see tauext-live --help");
  };
  require(std::isfinite(o.pace.duration) && o.pace.duration >= 0,
          fmt::format("--duration {}: 0 s or more", o.pace.duration));
  const bool receives = listen || !o.subscribe.empty();
  require(!receives || !lcm_url(o.url).starts_with("memq://"),
          "memq:// does not leave a process: nothing can arrive");
  if (listen) {
    require(o.robot.empty() && o.estimators.empty(),
            "--listen shows streams and estimates nothing");
    return;
  }
  const int sources = !o.scenario.empty() + !o.from.empty() + !o.subscribe.empty();
  require(sources == 1, "exactly one of --scenario, --from, --subscribe and --listen is required");
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
  Outlet outlet(o, o.rate / o.pace.speed);  // a rate of the clock's seconds
  LiveEstimation estimation(r, o.estimators, o.detector, thresholds_of(o), trace, outlet.stream());
  const Interrupt interrupt;
  fmt::print(stderr, "playing {}{}; Ctrl-C ends\n", title_of(o), outlet.where());
  const auto begin = Clock::now();
  StatusLine status;
  Loop loop(readings, o.pace, estimation);
  while (!loop.ended() && !interrupt.seen()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    outlet.report_failures();
    status.show(estimation, &loop.late(), outlet.stream());
  }
  loop.stop();
  status.clear();
  LiveReport report;
  report.seconds = seconds_since(begin);
  report.late = &loop.late();
  report.period = period_of(readings, o.pace.speed);
  return finish(o, outlet, estimation, report);
}

int run_subscribed(const LiveOptions& o) {
  const Robot r = robot_or_file(o);
  Outlet outlet(o, o.rate);
  LiveEstimation estimation(r, o.estimators, o.detector, thresholds_of(o), Trace(),
                            outlet.stream());
  LiveReport report;
  report.subscribed = true;
  Inlet inlet(o, r, estimation, report);
  const Interrupt interrupt;
  fmt::print(stderr, "listening to {} at {}{}; Ctrl-C ends\n", o.subscribe, inlet.url(),
             o.stream ? ", streaming" : "");
  const auto begin = Clock::now();
  StatusLine status;
  while (!over(interrupt, begin, o.pace.duration) && inlet.wait()) {
    outlet.report_failures();
    status.show(estimation, nullptr, outlet.stream());
  }
  status.clear();
  report.seconds = seconds_since(begin);
  if (report.arrivals.late > report.arrivals.used / 10) {
    notice(fmt::format("{} messages on {} were late: are there two senders?", report.arrivals.late,
                       o.subscribe));
  }
  if (report.arrivals.used == 0 && report.rejected == 0) {
    notice(fmt::format("nothing came on {} at {}", o.subscribe, inlet.url()));
  }
  return finish(o, outlet, estimation, report);
}

}  // namespace tauext

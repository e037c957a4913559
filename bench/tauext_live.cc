// SPDX-License-Identifier: Apache-2.0
// tauext-live: estimates while it happens, and streams them.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "bench/live/interrupt.h"
#include "bench/live/live_io.h"
#include "bench/live/live_listen.h"
#include "bench/live/live_report.h"
#include "bench/live/view/viewers.h"
#include "bench/logs/lcm_trace.h"
#include "bench/program/program.h"
#include "bench/program/realtime.h"
#include "bench/replay/robot_log.h"
#include "bench/roster/robots.h"
#include "bench/roster/threshold_file.h"
#include "bench/run/recording_flags.h"
#include "bench/run/scenario_file.h"
#include "bench/score/detection_metrics.h"
#include "bench/score/entry.h"
#include "mjcf/trace/printable.h"

namespace tauext::live {
namespace {

using Clock = std::chrono::steady_clock;

// a robot on which all that was asked for can run
const Robot& checked_robot(const Options& o) {
  const Robot& r = robot(o.robot, o.lock);
  for (const std::string& e : o.estimators) r.check(e, o.detector);
  if (r.dof() > kMaxJoints)
    throw std::invalid_argument(
        fmt::format("{} has {} joints: a message holds {}", r.name(), r.dof(), kMaxJoints));
  return r;
}

// null unless they are asked for
std::unique_ptr<const ArmForces> forces_of(const Options& o, const Robot& r) {
  return o.wrench.empty() ? nullptr : r.forces_at(o.wrench, r.dof() >= kJointsOfMoment);
}

DetectorsOf thresholds_of(const Options& o, const Robot& r) {
  const Thresholds all = o.thresholds.empty() ? Thresholds() : read_thresholds(o.thresholds);
  return [&o, &r, all](const std::string& estimator) {
    return trained_for(all, r, o.sensors.velocity_noise, estimator, o.detector);
  };
}

// samples of a log, to be played
RecordedLog read_samples(const Options& o, const Robot& r) {
  return robot_log(r, o.from, o.channel, o.columns);
}

// samples of a simulation, in which a detector may stop the motor
RecordedLog simulate_samples(const Options& o, const Robot& r, const DetectorsOf& thresholds) {
  const Scenario& s = scenario_of(r, o.scenario);
  Supervisor supervisor;
  if (s.reacts && !o.detector.empty()) {
    supervisor = r.supervisor(o.estimators[0], o.detector, o.recording.drives,
                              {.thresholds = thresholds(o.estimators[0])});
  }
  say(fmt::format("simulating {} s of {}", s.duration, s.name));
  const Sensors sensors = sensors_for(s, o.sensors);
  return {measure(simulate(r.load_for(s, o.model_error), s, o.recording, sensors, supervisor),
                  sensors)};
}

std::string title_of(const Options& o) {
  return robot(o.robot, o.lock).label() + "/" +
         (!o.subscribe.empty() ? o.subscribe
          : !o.from.empty()    ? o.from
                               : o.scenario);
}

int finish(const Options& o, Outlet& outlet, const LiveEstimation& e, LiveReport report) {
  report.title = title_of(o);
  report.stream = outlet.finish(summaries_of(report, e, o.detector));
  fmt::print("{}", printable(format(report, e)));
  if (report.stream.hung) {  // its thread is still in LCM
    std::fflush(stdout);
    std::_Exit(kAnswerIsNo);
  }
  for (int i = 0; i < e.size(); ++i) {
    if (2 * e.figures(i).unusable <= e.samples()) continue;
    say(e.name(i) +
        ": most samples could not be used. Is t in s, q in rad, qd in rad/s, tau in N m?");
    report.failed = true;
  }
  const bool silent = report.stream.asked && report.stream.counts.published == 0;
  return silent || report.failed || e.samples() == 0 ? kAnswerIsNo : kGood;
}

// the priority of the loop, or of a thread that comes `below` it
std::unique_ptr<Realtime> realtime_of(const Options& o, int below = 0) {
  if (!o.realtime) return nullptr;
  return std::make_unique<Realtime>(*o.realtime > below ? *o.realtime - below : *o.realtime);
}

// [ns] from one sample to the next, as most are
double period_of(const std::vector<Reading>& all, double speed) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < all.size(); ++k) steps.push_back(all[k].t - all[k - 1].t);
  return steps.empty() ? 0 : metrics::quantile(steps, 0.5) * 1e9 / speed;
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

// plays what was recorded, or simulated, until its end or Ctrl-C, prints a summary, and returns the
// exit code: 1 if a stream was asked for and nothing could be sent, or if nothing good was
// received
int run_recorded(const Options& o) {
  const Robot& r = checked_robot(o);
  const DetectorsOf thresholds = thresholds_of(o, r);
  const auto forces = forces_of(o, r);
  if (o.from.empty()) scenario_of(r, o.scenario);  // or says that there is none
  RecordedLog log;
  if (!o.from.empty()) log = read_samples(o, r);         // before anything is written
  std::unique_ptr<Realtime> first = realtime_of(o, 1);   // who sends comes behind the loop
  Outlet outlet(o, title_of(o), o.rate / o.pace.speed);  // a rate of the clock's seconds
  first.reset();
  if (o.from.empty()) log = simulate_samples(o, r, thresholds);
  const Trace& trace = log.trace;
  const std::vector<Reading> readings = readings_of(trace);
  LiveEstimation estimation(r, o.estimators, o.detector, thresholds, trace, outlet.stream(),
                            forces.get());
  const Interrupt interrupt;
  say(fmt::format("playing {}{}; Ctrl-C ends", title_of(o), outlet.where()));
  const auto begin = Clock::now();
  StatusLine status;
  first = realtime_of(o);
  Loop loop(readings, o.pace, estimation);
  first.reset();  // this thread only looks on
  while (!loop.ended() && !interrupt.seen()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    outlet.report_failures();
    status.show(estimation, &loop.late(), outlet.stream());
  }
  loop.stop();
  status.clear();
  LiveReport report;
  report.failed = !log.usable();
  report.seconds = seconds_since(begin);
  report.late = &loop.late();
  report.period = period_of(readings, o.pace.speed);
  return finish(o, outlet, estimation, report);
}

// the same on what a robot sends
int run_subscribed(const Options& o) {
  const Robot& r = checked_robot(o);
  const auto forces = forces_of(o, r);
  Outlet outlet(o, title_of(o), o.rate);
  LiveEstimation estimation(r, o.estimators, o.detector, thresholds_of(o, r), Trace(),
                            outlet.stream(), forces.get());
  LiveReport report;
  report.subscribed = true;
  Inlet inlet(o, r, estimation, report);
  const Interrupt interrupt;
  say(fmt::format("listening to {} at {}{}; Ctrl-C ends", o.subscribe, inlet.url(),
                  outlet.where()));
  const std::unique_ptr<Realtime> first = realtime_of(o);  // this thread is the loop
  const auto begin = Clock::now();
  StatusLine status;
  for (bool ended = false; !ended;) {
    ended = over(interrupt, begin, o.pace.duration);
    ended = !inlet.wait() || ended;  // what has come by then is taken
    outlet.report_failures();
    status.show(estimation, nullptr, outlet.stream());
  }
  status.clear();
  report.seconds = seconds_since(begin);
  if (report.arrivals.sent() == 0) {
    say(fmt::format("nothing came on {} at {}", o.subscribe, inlet.url()));
  }
  return finish(o, outlet, estimation, report);
}

}  // namespace
}  // namespace tauext::live

namespace {

using namespace tauext;

// where samples come from
void add_source_flags(CLI::App& app, live::Options& o, bool& listen) {
  add_robot_flags(app, o.robot, o.lock);
  app.add_option("--scenario", o.scenario, "scenario to simulate (see --list)");
  app.add_option("--from", o.from,
                 "log to play instead, as tauext-replay reads it (--columns, --channel)")
      ->type_name("LOG");
  app.add_option("--subscribe", o.subscribe,
                 "LCM channel to estimate instead (--type tauext, iiwa or panda)")
      ->type_name("CHANNEL");
  app.add_option("--type", o.type)->group("");
  app.add_option("--channel", o.channel)->group("");
  app.add_option("--columns", o.columns)->group("");
  app.add_flag("--listen", listen, "instead: show the tauext streams at --lcm URL");
}

// what is made of them, and where that goes
void add_run_flags(CLI::App& app, live::Options& o) {
  app.add_option("--estimator", o.estimators, "NAME[:KEY=VALUE].., one or more apart by commas")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--detector", o.detector, "NAME[:KEY=VALUE].. behind each estimator");
  app.add_option("--thresholds", o.thresholds,
                 "the detectors' thresholds, from tauext-detect --calibrate")
      ->type_name("FILE")
      ->check(not_empty);
  app.add_option("--wrench", o.wrench,
                 "the force at this site or body (end_effector), and the link touched")
      ->type_name("SITE")
      ->check(not_empty);
  app.add_option("--lcm", o.url, "stream; else $LCM_DEFAULT_URL or this machine's own group")
      ->type_name("[URL]")
      ->expected(0, 1);
  app.add_option("--page", o.page, "show the stream in a browser, at http://127.0.0.1:PORT; 0: any")
      ->type_name("[PORT]")
      ->expected(0, 1)
      ->check(CLI::Range(0, 65535).description(""))
      ->default_str(std::to_string(live::PageServer::kUsualPort));
  app.add_option(
         "--plotjuggler", o.plotjuggler,
         fmt::format("send it as JSON by UDP to HOST:PORT, else {}", live::PlotJuggler::kUsual))
      ->type_name("[TO]")
      ->expected(0, 1);
  app.add_option("--rate", o.rate, "messages a second and channel, peaks held; 0: every sample")
      ->capture_default_str();
  app.add_option("--realtime", o.realtime,
                 "the loop before all ordinary programs (1 to 99), its memory in RAM")
      ->type_name("[PRIORITY]")
      ->expected(0, 1)
      ->default_str(std::to_string(Realtime::kUsual));
  app.add_option("--speed", o.pace.speed, "simulated seconds in a second")->capture_default_str();
  app.add_flag("--loop", o.pace.again, "begin again at the end");
  app.add_option("--duration", o.pace.duration, "end after so many seconds; 0: never")
      ->capture_default_str();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Estimates in real time, or shows a stream. Opens no socket unless asked to.\n"
      "  tauext-live --robot wallmobot3 --scenario contact --estimator ekf,mo2 --lcm\n",
      "tauext-live");
  live::Options o;
  bool list = false, listen = false;
  add_source_flags(app, o, listen);
  add_run_flags(app, o);
  add_recording_flags(app, o.sensors, o.model_error, o.recording);
  std::string scenarios;
  app.add_option("--scenarios", scenarios);
  std::vector<const char*> of_scenarios = recording_flags();
  of_scenarios.push_back("--scenarios");
  for (const char* flag : of_scenarios) app.get_option(flag)->group("");
  app.add_flag("--list", list, "list robots, scenarios, estimators and detectors, and stop");
  app.footer(
      "With --scenario: tauext-record's --scenarios --sensors --model_error --degrade --seed --kp "
      "--kd.");
  return run_program(app, argc, argv, [&]() -> int {
    if (list) {
      fmt::print("{}", list_known(o.robot, o.lock));
      return kGood;
    }
    o.stream = app.count("--lcm") > 0;
    if (app.count("--plotjuggler") > 0 && o.plotjuggler.empty())
      o.plotjuggler = live::PlotJuggler::kUsual;
    require_mode(app, !o.scenario.empty(), "--scenario", of_scenarios);
    require_mode(app, !o.from.empty(), "--from", {"--channel", "--columns"});
    require_mode(app, !o.subscribe.empty(), "--subscribe", {"--type"});
    require_mode(app, o.subscribe.empty() && !listen, "--scenario and --from",
                 {"--speed", "--loop"});
    require_mode(app, !listen, "--scenario, --from and --subscribe", {"--realtime"});
    require_mode(app, (o.stream || o.page || !o.plotjuggler.empty()) && !listen,
                 "--lcm, --page and --plotjuggler", {"--rate"});
    live::check(o, listen);
    if (listen) return live::run_listen(o);
    if (!scenarios.empty()) add_scenarios(scenarios, robot(o.robot, o.lock));
    return o.subscribe.empty() ? live::run_recorded(o) : live::run_subscribed(o);
  });
}

// SPDX-License-Identifier: Apache-2.0
// tauext-live: estimates while it happens, and streams them.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/live/live_listen.h"
#include "bench/live/live_modes.h"
#include "bench/live/view/viewers.h"
#include "bench/program/program.h"
#include "bench/program/realtime.h"
#include "bench/roster/robots.h"
#include "bench/run/recording_flags.h"
#include "bench/run/scenario_file.h"

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
      fmt::print("{}", list_known(with_lock(o.robot, o.lock)));
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
    if (!scenarios.empty()) add_scenarios(scenarios, robot(with_lock(o.robot, o.lock)));
    return o.subscribe.empty() ? live::run_recorded(o) : live::run_subscribed(o);
  });
}

// SPDX-License-Identifier: Apache-2.0
// tauext-record: writes a ground-truth trace.
#include <fmt/format.h>

#include "bench/cli.h"
#include "bench/lcm_trace.h"
#include "bench/robot.h"
#include "mjcf/atomic_file.h"

int main(int argc, char** argv) {
  using namespace tauext;
  CLI::App app(
      "Records a scenario on a simulated robot with its true tau_ext, 1 kHz, as CSV:\n"
      "t,q1..,qd1..,tau1..,tau_ext1..,contact  [s, rad, rad/s, N m; sign: see README];\n"
      "or, to a file that ends in .lcm, as an LCM log with simulated times.\n\n"
      "  tauext-record --robot wallmobot3 --scenario step --out step.csv\n",
      "tauext-record");
  std::string robot_name, scenario_name, out, stop, type = "tauext";
  Sensors sensors;
  ModelError model_error;
  Recording recording;
  bool list = false;
  app.add_option("--robot", robot_name, "robot (see --list)");
  app.add_option("--scenario", scenario_name, "scenario (see --list)");
  app.add_option("--out", out, "file to write; - is standard output");
  app.add_option("--type", type, "of an LCM log's messages: tauext, iiwa or panda")
      ->capture_default_str();
  app.add_option("--stop", stop, "ESTIMATOR+DETECTOR whose first mark stops the motor");
  add_recording_flags(app, sensors, model_error, recording);
  app.add_flag("--list", list, "list robots and scenarios, and stop");
  return run_program(app, argc, argv, [&] {
    if (list) {
      fmt::print("{}", list_known());
      return kGood;
    }
    if (robot_name.empty() || scenario_name.empty() || out.empty()) {
      throw std::invalid_argument(
          "--robot, --scenario and --out are required; see tauext-record --help");
    }
    const bool lcm = is_lcm_log(out);
    if (message_type(type) != MessageType::kTauext && !lcm) {
      throw std::invalid_argument(fmt::format("--type {}: --out {} is no LCM log", type, out));
    }
    const Robot& r = robot(robot_name);
    const Scenario& s = scenario(r.name, scenario_name);
    const auto plus = stop.find('+');
    if (!stop.empty() && plus == std::string::npos) {
      throw std::invalid_argument(
          fmt::format("--stop {}: ESTIMATOR+DETECTOR, like ekf+pan_tompkins", stop));
    }
    const Supervisor supervisor =
        stop.empty() ? nullptr : r.supervisor(stop.substr(0, plus), stop.substr(plus + 1));
    const Trace trace = measure(
        simulate(load_for(r.name, s, model_error), s, recording, sensors, supervisor), sensors);
    if (lcm) {
      LogBuffer log;
      append_samples(readings_of(trace), message_type(type), log);
      AtomicFile file(out);
      file.write(log.bytes());
      file.commit();
    } else {
      write_csv(trace, out);
    }
    fmt::print(stderr, "{}: {} samples of {}/{}{}\n", out, trace.size(), robot_name, scenario_name,
               trace.stopped_at < 0 ? stop.empty() ? "" : "; nothing stopped it"
                                    : fmt::format("; stopped at {} s", trace.t[trace.stopped_at]));
    return kGood;
  });
}

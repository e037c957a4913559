// SPDX-License-Identifier: Apache-2.0
// tauext-record: writes a ground-truth trace.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cctype>

#include "bench/logs/lcm_trace.h"
#include "bench/program/program.h"
#include "bench/roster/robots.h"
#include "bench/run/recording_flags.h"
#include "bench/run/scenario_file.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/read/npy_writer.h"

namespace {

// What --stop names on this robot: nothing if it is empty.
tauext::Supervisor supervisor_of(const tauext::Robot& robot, const std::string& stop) {
  if (stop.empty()) {
    return nullptr;
  }
  // the last one that a name follows: numbers of a specification may have a sign
  auto plus = stop.rfind('+');
  while (plus != std::string::npos && plus > 0 && std::isalpha(stop[plus + 1]) == 0) {
    plus = stop.rfind('+', plus - 1);
  }
  if (plus == std::string::npos) {
    throw std::invalid_argument(
        fmt::format("--stop {}: ESTIMATOR+DETECTOR, like ekf+pan_tompkins", stop));
  }
  return robot.supervisor(stop.substr(0, plus), stop.substr(plus + 1));
}

// as its name ends
void write(const tauext::Trace& trace, tauext::MessageType type, const std::string& out) {
  using namespace tauext;
  if (out.ends_with(".npz")) return write_npz(out, trace);
  if (!is_lcm_log(out)) return write_csv(trace, out);
  LogBuffer log;
  append_samples(readings_of(trace), type, log);
  AtomicFile file(out);
  file.write(log.bytes());
  file.commit();
}

}  // namespace

int main(int argc, char** argv) {
  using namespace tauext;
  CLI::App app(
      "Records a scenario on a simulated robot with its true tau_ext, 1 kHz, as CSV:\n"
      "t,q1..,qd1..,tau1..,tau_ext1..,contact  [s, rad, rad/s, N m; sign: see README];\n"
      "or, to a file that ends in .npz, as NumPy's arrays t, q, .., or in .lcm, as an LCM log.\n\n"
      "  tauext-record --robot wallmobot3 --scenario step --out step.csv\n",
      "tauext-record");
  std::string robot_name, lock, scenario_name, scenario_file, out, stop, type = "tauext";
  Sensors sensors;
  ModelError model_error;
  Recording recording;
  bool list = false;
  app.add_option("--robot", robot_name, "robot (see --list), or a file of MJCF or URDF")
      ->type_name("NAME|FILE");
  app.add_option("--lock", lock, "joints of that file to fix, like grippers'")
      ->type_name("REGEX")
      ->check(not_empty);
  app.add_option("--scenario", scenario_name, "scenario (see --list)");
  app.add_option("--scenarios", scenario_file, "add those of a JSON file (bench/run/README.md)")
      ->type_name("FILE");
  app.add_option("--out", out, "file to write; - is standard output");
  app.add_option("--type", type, "of an LCM log's messages: tauext, iiwa or panda")
      ->capture_default_str();
  app.add_option("--stop", stop, "ESTIMATOR+DETECTOR whose first mark stops the motor");
  add_recording_flags(app, sensors, model_error, recording);
  app.add_flag("--list", list, "list robots and scenarios, and stop");
  return run_program(app, argc, argv, [&] {
    if (list) {
      fmt::print("{}", list_known(with_lock(robot_name, lock)));
      return kGood;
    }
    if (robot_name.empty() || scenario_name.empty() || out.empty()) {
      throw std::invalid_argument(
          "--robot, --scenario and --out are required; see tauext-record --help");
    }
    if (message_type(type) != MessageType::kTauext && !is_lcm_log(out)) {
      throw std::invalid_argument(fmt::format("--type {}: --out {} is no LCM log", type, out));
    }
    const Robot& r = robot(with_lock(robot_name, lock));
    if (!scenario_file.empty()) add_scenarios(scenario_file, r);
    const Scenario& s = scenario_of(r, scenario_name);
    sensors = sensors_for(s, sensors);
    const Supervisor supervisor = supervisor_of(r, stop);
    const Trace trace =
        measure(simulate(r.load_for(s, model_error), s, recording, sensors, supervisor), sensors);
    write(trace, message_type(type), out);
    const std::string stopped = trace.stopped_at >= 0
                                    ? fmt::format("; stopped at {} s", trace.t[trace.stopped_at])
                                : stop.empty() ? ""
                                               : "; nothing stopped it";
    say(fmt::format("{}: {} samples of {}/{}{}", out, trace.size(), robot_name, scenario_name,
                    stopped));
    return kGood;
  });
}

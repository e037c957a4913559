// SPDX-License-Identifier: Apache-2.0
// tauext-record: writes a ground-truth trace.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cctype>
#include <filesystem>
#include <iterator>
#include <utility>

#include "bench/logs/lcm_trace.h"
#include "bench/logs/mcap_samples.h"
#include "bench/program/program.h"
#include "bench/roster/robots.h"
#include "bench/run/recording_flags.h"
#include "bench/run/scenario_file.h"
#include "bench/run/study_flags.h"
#include "bench/score/entry.h"
#include "bench/score/parallel.h"
#include "bench/study/detection/calibration.h"
#include "bench/study/study_runs.h"
#include "mjcf/plant/coordinates.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/read/layout_writer.h"
#include "mjcf/trace/read/npy_writer.h"

namespace {

using namespace tauext;

struct Flags {
  std::string robot, lock, scenario, scenarios, out, stop, layout, type = "tauext", set, seeds;
  int every = 1;
  Sensors sensors;
  ModelError model_error;
  Recording recording;
  bool list = false;
};

void add_flags(CLI::App& app, Flags& f) {
  add_robot_flags(app, f.robot, f.lock);
  app.add_option("--scenario", f.scenario,
                 "scenario (see --list; --scenarios FILE.json adds yours)");
  app.add_option("--scenarios", f.scenarios)->group("");  // bench/run/README.md
  app.add_option("--set", f.set, "training or test instead: runs of --seeds 1-100 to --out FOLDER")
      ->check(CLI::IsMember({"training", "test"}).description(""))
      ->type_name("NAME");
  app.add_option("--seeds", f.seeds)->group("");
  app.add_option("--out", f.out, "file to write; - is standard output");
  app.add_option("--type", f.type, "of an LCM log's messages: tauext, iiwa or panda")
      ->capture_default_str();
  app.add_option("--layout", f.layout, "of other people's logs: libfranka, ur_rtde or joint_state")
      ->type_name("NAME");
  app.add_option("--every", f.every,
                 "write each N-th sample, 8 for 125 Hz; tau is tau_instant1.. then")
      ->check(CLI::Range(1, 1000).description(""))
      ->type_name("N");
  app.add_option("--stop", f.stop, "ESTIMATOR+DETECTOR whose first mark stops the motor");
  add_recording_flags(app, f.sensors, f.model_error, f.recording);
  app.add_flag("--list", f.list, "list robots and scenarios, and stop");
}

// What --stop names on this robot: nothing if it is empty.
Supervisor supervisor_of(const Robot& robot, const std::string& stop, const Drives& drives) {
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
  return robot.supervisor(stop.substr(0, plus), stop.substr(plus + 1), drives);
}

// with the torques that the robot's sensors say: whoever reads them multiplies them by its file's
// torque_gain
Trace sensed(Trace trace, const Robot& r) {
  if (r.is_from_file())
    trace.tau = torque_gains_of(r.model()).cwiseInverse().asDiagonal() * trace.tau;
  return trace;
}

// in the layout that is asked for, or as its name ends
void write(const Trace& moved, const Flags& f, const Robot& r) {
  if (f.layout == "ur_rtde") return write_layout(moved, f.layout, r.gains(), r.joints(), f.out);
  const Trace trace = sensed(moved, r);
  if (!f.layout.empty()) return write_layout(trace, f.layout, r.gains(), r.joints(), f.out);
  if (f.out.ends_with(".npz")) return write_npz(f.out, trace);
  if (f.out.ends_with(".mcap")) return write_mcap(trace, f.out);
  if (!is_lcm_log(f.out)) return write_csv(trace, f.out);
  LogBuffer log;
  append_samples(readings_of(trace), message_type(f.type), log);
  AtomicFile file(f.out);
  file.write(log.bytes());
  file.commit();
}

// runs that seeds draw, each with touches of one kind, as NumPy's arrays; no seed of a training set
// is one of a study or of a test set
int record_set(const Flags& f) {
  if (f.robot.empty() || f.seeds.empty() || f.out.empty())
    throw std::invalid_argument("--set wants --robot, --seeds and --out FOLDER");
  constexpr std::pair<const char*, TouchKind> kKinds[] = {{"blow", TouchKind::kBlow},
                                                          {"slow_push", TouchKind::kSlowPush},
                                                          {"brisk_push", TouchKind::kBriskPush},
                                                          {"clamp", TouchKind::kClamp}};
  const study::StudyRuns& runs = study::touched_runs(&robot(f.robot, f.lock));
  const std::vector<std::uint64_t> seeds = seeds_of(f.seeds);
  study::Condition condition;
  condition.panel = runs.carries;
  condition.degradation = {f.sensors, f.model_error, f.recording.drives};
  const study::PlantKey plant = study::plant_of(condition);
  const Model model = runs.model(plant);
  for (const std::uint64_t seed : seeds) {
    if (seed >= study::kTrainingSeed)
      throw std::invalid_argument(
          fmt::format("--seeds: {} is not below {}", seed, study::kTrainingSeed));
  }
  std::error_code error;
  std::filesystem::create_directories(f.out, error);
  if (error) throw std::runtime_error(fmt::format("{}: cannot create: {}", f.out, error.message()));
  Progress progress("recording");
  const auto record = [&](int i) {
    const std::uint64_t seed = seeds[static_cast<std::size_t>(i)];
    std::vector<study::Job> jobs;
    for (const auto& [name, kind] : kKinds)
      jobs.push_back({plant, kind, seed + (f.set == "training" ? study::kTrainingSeed : 0)});
    const std::vector<Trace> truths = study::simulated(runs, jobs, model);
    for (std::size_t k = 0; k < jobs.size(); ++k) {
      const Trace trace = sensed(study::measured(truths[k], f.sensors, jobs[k]), *runs.robot);
      write_npz(fmt::format("{}/{}_{:04}.npz", f.out, kKinds[k].first, seed),
                study::thinned(trace, f.every));
    }
  };
  parallel_for(static_cast<int>(seeds.size()), 0, record, progress.callback());
  say(fmt::format("{}: {} runs of {}, 30 s each", f.out, std::size(kKinds) * seeds.size(),
                  f.robot));
  return kGood;
}

int run(const CLI::App& app, const Flags& f) {
  if (f.list) {
    fmt::print("{}", list_known(f.robot, f.lock));
    return kGood;
  }
  require_mode(app, !f.set.empty(), "--set", {"--seeds"});
  require_mode(
      app, f.set.empty(), "one run, not with --set",
      {"--scenario", "--scenarios", "--type", "--layout", "--stop", "--kp", "--kd", "--seed"});
  if (!f.set.empty()) return record_set(f);
  if (f.robot.empty() || f.scenario.empty() || f.out.empty()) {
    throw std::invalid_argument(
        "--robot, --scenario and --out are required; see tauext-record --help");
  }
  if (message_type(f.type) != MessageType::kTauext && !is_lcm_log(f.out)) {
    throw std::invalid_argument(fmt::format("--type {}: --out {} is no LCM log", f.type, f.out));
  }
  if (f.out.ends_with(".npy"))
    throw std::invalid_argument(f.out + ": a run is several arrays, and so an .npz");
  const bool bag = f.layout == "joint_state";
  if (f.out != "-" && f.out.ends_with(".db3") != bag)
    throw std::invalid_argument(fmt::format(
        "--out {}: --layout joint_state makes a bag, whose name ends in .db3, and no other's",
        f.out));
  if (!f.layout.empty() &&
      (is_lcm_log(f.out) || f.out.ends_with(".npz") || f.out.ends_with(".mcap")))
    throw std::invalid_argument(
        fmt::format("--layout {} writes text or a bag, and --out is {}", f.layout, f.out));
  const Robot& r = robot(f.robot, f.lock);
  if (!f.scenarios.empty()) add_scenarios(f.scenarios, r);
  const Scenario& s = scenario_of(r, f.scenario);
  const Sensors sensors = sensors_for(s, f.sensors);
  const Supervisor supervisor = supervisor_of(r, f.stop, f.recording.drives);
  const Trace trace =
      measure(simulate(r.load_for(s, f.model_error), s, f.recording, sensors, supervisor), sensors);
  const Trace thin = study::thinned(trace, f.every);
  write(thin, f, r);
  if (is_lcm_log(f.out) && thin.torque_at_instants)
    say(f.out +
        ": messages cannot say that tau was read at instants: add --torque instant to "
        "tauext-replay");
  if (bag && std::count(thin.contact.begin(), thin.contact.end(), 0) < thin.size())
    say(f.out + ": joint_state has no place for labels of contacts, so they are left out");
  const std::string stopped = trace.stopped_at >= 0
                                  ? fmt::format("; stopped at {} s", trace.t[trace.stopped_at])
                              : f.stop.empty() ? ""
                                               : "; nothing stopped it";
  say(fmt::format("{}: {} samples of {}/{}{}", f.out, thin.size(), f.robot, f.scenario, stopped));
  return kGood;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Records a scenario on a simulated robot with its true tau_ext, 1 kHz, as CSV:\n"
      "t,q1..,qd1..,tau1..,tau_ext1..,contact  [s, rad, rad/s, N m; sign: see README];\n"
      "or, to a file that ends in .npz, as NumPy's arrays t, q, .., in .mcap, for Foxglove or\n"
      "PlotJuggler, or in .lcm, as an LCM log.\n\n"
      "  tauext-record --robot wallmobot3 --scenario step --out step.csv\n",
      "tauext-record");
  Flags flags;
  add_flags(app, flags);
  return run_program(app, argc, argv, [&] { return run(app, flags); });
}

// SPDX-License-Identifier: Apache-2.0
// tauext-replay: runs estimators over a recorded log.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "bench/logs/lcm_trace.h"
#include "bench/logs/read_log.h"
#include "bench/logs/torque_sampling.h"
#include "bench/program/program.h"
#include "bench/replay/replayed.h"
#include "bench/roster/robots.h"
#include "bench/roster/threshold_file.h"
#include "mjcf/trace/known.h"
#include "mjcf/trace/printable.h"

namespace {

using namespace tauext;

// what the unit of t seems to be, if arms are sampled at 50 Hz to 10 kHz
std::string looks_like(double step) {
  if (step >= 0.1 && step <= 20) return ", so t looks like milliseconds";
  if (step >= 100 && step <= 20000) return ", so t looks like microseconds";
  if (step >= 1e5 && step <= 2e7) return ", so t looks like nanoseconds";
  return "";
}

// statuses that an engineer has to know of; false if most samples could not be used, with those
// that the reader has skipped
bool report_status(const Trace& trace, const Replayed& c, std::int64_t skipped) {
  const StatusCounts& counts = c.output.counts;
  if (!counts.text().empty()) {
    say(fmt::format("{}: of {} samples {}", c.estimator, counts.samples(), counts.sentence()));
  }
  if (2 * (counts.left_out() + skipped) <= counts.samples() + skipped) return true;
  if (2 * counts.left_out() <= counts.samples()) {
    say(
        fmt::format("{}: most rows could not be used: {} were skipped (see above), {} of the other "
                    "{} left out",
                    c.estimator, skipped, counts.left_out(), counts.samples()));
    return false;
  }
  if (2 * counts.of(Status::kFrozen) > counts.samples()) {
    say(
        fmt::format("{}: most readings repeat the one before, so these are no estimates. Is the "
                    "log faster than its sensors?",
                    c.estimator));
    return false;
  }
  std::vector<double> steps;
  for (int k = 1; k < trace.size(); ++k) steps.push_back(trace.t[k] - trace.t[k - 1]);
  if (steps.empty()) return false;
  std::nth_element(steps.begin(), steps.begin() + steps.size() / 2, steps.end());
  const double step = steps[steps.size() / 2];
  say(fmt::format(
      "{}: most samples could not be used, so these are no estimates. Samples are {:g} s apart{}. "
      "Is q in rad, qd in rad/s, tau in N m?",
      c.estimator, step, looks_like(step)));
  return false;
}

// where the log shows that tau is not what is assumed
void warn_of_torque(const Robot& r, const Trace& trace, bool assumed_instant) {
  constexpr double kBandwidth = 30;  // [rad/s]
  const auto run = [&](const char* torque) {
    return r.runner(fmt::format("mo2:bandwidth={}:torque={}", kBandwidth, torque), "", trace)
        ->run();
  };
  const Output held = run("held");
  const auto w =
      torque_weight(trace, held.tau_ext, run("instant").tau_ext, held.status, kBandwidth);
  if (!w || !w->contradicts(assumed_instant)) return;
  say(
      fmt::format("tau seems to be {} t (weight {:.2f} +- {:.2f} of 0 held, 1 instant), and is "
                  "taken as the other: see --torque",
                  assumed_instant ? "held from each" : "read at each", w->weight, w->sure));
}

struct Flags {
  std::string log, channel, columns, robot, lock, detector, thresholds, torque, wrench, out;
  std::vector<std::string> estimators;
  double score_from = -std::numeric_limits<double>::infinity();
  bool list = false;
};

void add_flags(CLI::App& app, Flags& f) {
  app.add_option("log", f.log, "log to read: CSV, .npy, .npz, .db3 (ROS 2) or LCM");
  app.add_option("--channel", f.channel, "of an LCM log, or topic of a bag, with several of them");
  app.add_option("--columns", f.columns,
                 "what the log's columns mean: a map, or libfranka, ur_rtde, ..")
      ->type_name("PRESET|FILE.toml");
  add_robot_flags(app, f.robot, f.lock);
  app.add_option("--estimator", f.estimators, "NAME[:KEY=VALUE].., one or more apart by commas")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--detector", f.detector, "NAME[:KEY=VALUE].. behind each estimator");
  app.add_option("--thresholds", f.thresholds, "of the detector: file of tauext-detect --calibrate")
      ->type_name("FILE");
  app.add_option("--torque", f.torque,
                 "when tau acted: held from t on, or at t; else as the log says")
      ->type_name("held|instant")
      ->check(CLI::IsMember({"held", "instant"}));
  app.add_option("--wrench", f.wrench,
                 "the force at this site or body (end_effector), and the link touched")
      ->type_name("SITE")
      ->check(not_empty);
  app.add_option("--out", f.out, "CSV to write, or .npz; - is standard output");
  app.add_option("--score_from", f.score_from,
                 "errors count from this time on [s]; else from the begin")
      ->type_name("S");
  app.add_flag("--list", f.list, "list robots, estimators and detectors, and stop");
}

// checks them, too, and puts --torque into them
std::vector<DetectorSettings> settings_of(Flags& f, const Robot& r) {
  if (!f.thresholds.empty() && f.detector.empty())
    throw std::invalid_argument("--thresholds needs a --detector");
  const Thresholds trained = f.thresholds.empty() ? Thresholds() : read_thresholds(f.thresholds);
  std::vector<DetectorSettings> settings;  // of each estimator
  for (std::string& e : f.estimators) {
    r.check(e, f.detector);
    settings.push_back({trained_for(trained, r.name(), 0, e, f.detector)});
    if (f.torque.empty()) continue;
    if (key_of(e, "torque")) {
      throw std::invalid_argument(fmt::format("--torque {}: {} says it, too", f.torque, e));
    }
    e = with_key(e, "torque", f.torque, r.estimator_fields(name_of_specification(e)));
  }
  return settings;
}

int replay(Flags& f) {
  if (f.log.empty() || f.robot.empty() || f.estimators.empty() || f.out.empty()) {
    throw std::invalid_argument(
        "a log, --robot, --estimator and --out are required; see tauext-replay --help");
  }
  if (is_lcm_log(f.out) || f.out.ends_with(".npy") || f.out.ends_with(".db3")) {
    throw std::invalid_argument(
        fmt::format("--out {}: estimates are written as CSV, or to an .npz", f.out));
  }
  refuse_twice("estimator", f.estimators);
  const Robot& r = robot(with_lock(f.robot, f.lock));
  const std::vector<DetectorSettings> settings = settings_of(f, r);
  const auto forces =
      f.wrench.empty() ? nullptr : r.forces_at(f.wrench, r.dof() >= kJointsOfMoment);
  RecordedLog recorded = read_any_log(f.log, {f.channel, f.columns, true});
  r.require_joints(recorded.trace, f.log);
  r.make_torques(recorded.trace);
  const Trace& trace = recorded.trace;
  if (!(f.score_from <= trace.t.back())) {
    throw std::invalid_argument(
        fmt::format("--score_from {}: the log ends at {} s", f.score_from, trace.t.back()));
  }
  std::vector<Replayed> columns;
  for (std::size_t i = 0; i < f.estimators.size(); ++i) {
    const std::string& e = f.estimators[i];
    columns.push_back({e, f.detector, r.runner(e, f.detector, trace, settings[i])->run(), {}});
    if (forces) columns.back().acting = acting(*forces, trace, columns.back().output);
  }
  const std::string by_log = trace.torque_at_instants ? "instant" : "held";
  bool good = recorded.usable();
  for (const Replayed& c : columns) good = report_status(trace, c, recorded.skipped) && good;
  for (const bool instant : {false, true}) {
    if (std::any_of(columns.begin(), columns.end(), [&](const Replayed& c) {
          const auto fields = r.estimator_fields(name_of_specification(c.estimator));
          const bool has = std::any_of(fields.begin(), fields.end(),
                                       [](const FieldHelp& h) { return h.key == "torque"; });
          return has && (key_of(c.estimator, "torque").value_or(by_log) == "instant") == instant;
        })) {
      warn_of_torque(r, trace, instant);
    }
  }
  write_estimates(trace, columns, f.out);
  std::FILE* const to = f.out == "-" ? stderr : stdout;
  if (!trace.has_truth())
    fmt::print(to, "{} samples; no errors, as the log has no tau_ext\n", trace.size());
  if (good) print_metrics(trace, columns, f.score_from, to);
  if (good) print_forces(trace, columns, to);
  return good ? kGood : kAnswerIsNo;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Runs estimators over a recorded log (an LCM log, or CSV with the columns of tauext-record;\n"
      "tau_ext and contact may be missing) and writes their estimates, one row per usable sample.\n"
      "Status: 0 ok, 1 started, 2 bad sample, 3 singular inertia, 4 diverged, 5 bad time,\n"
      "6 beyond a limit, 7 jump, 8 frozen, 9 unlikely; with all but 0 the old estimate is held.\n"
      "With the truth in the log, prints the errors too. Exit code 1 if most rows or samples "
      "were unusable.\n\n"
      "  tauext-replay log.csv --robot wallmobot3 --estimator ekf,ndob --out est.csv\n",
      "tauext-replay");
  Flags flags;
  add_flags(app, flags);
  return run_program(app, argc, argv, [&]() -> int {
    if (!flags.list) return replay(flags);
    fmt::print("{}", list_known(with_lock(flags.robot, flags.lock)));
    return kGood;
  });
}

// SPDX-License-Identifier: Apache-2.0
// tauext-score: scores estimates that were made elsewhere.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <limits>
#include <set>

#include "bench/logs/read_log.h"
#include "bench/outside/outside_score.h"
#include "bench/program/program.h"
#include "bench/roster/robots.h"
#include "bench/run/recording_flags.h"
#include "bench/run/suite_run.h"
#include "bench/score/suite.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/known.h"

namespace {

using namespace tauext;

struct Flags {
  std::vector<std::string> files, ours;
  std::string log, channel, columns, robot, lock, scenario, name, out, format = "text";
  double score_from = -std::numeric_limits<double>::infinity();
  Sensors sensors;
  ModelError error;
  Recording recording;
};

void add_flags(CLI::App& app, Flags& f) {
  app.add_option("estimates", f.files, "files: CSV, .npy or .npz; or --estimator alone");
  app.add_option("--log", f.log, "log that they are made of (--columns, --channel: tauext-replay)");
  app.add_option("--channel", f.channel)->group("");
  app.add_option("--columns", f.columns)->group("");
  app.add_option("--robot", f.robot, "robot, or a file of MJCF or URDF (with --lock REGEX)")
      ->type_name("NAME|FILE");
  app.add_option("--lock", f.lock)->group("")->check(not_empty);
  app.add_option("--scenario", f.scenario, "instead of a log: the run that tauext-record makes");
  add_recording_flags(app, f.sensors, f.error, f.recording);
  app.add_option("--name", f.name, "of an estimator that its file does not name; else the file's");
  app.add_option("--estimator", f.ours, "ours beside them, like mo2:bandwidth=50,ekf")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--score_from", f.score_from, "errors count from this time on [s]")
      ->type_name("S");
  app.add_option("--format", f.format, "of the table: text, csv, json, md or latex")
      ->type_name("NAME");
  app.add_option("--out", f.out, "JSON to write, as tauext-bench does")->type_name("FILE");
}

// the rows of these files and of ours, on one trace
std::vector<Row> scored(const Flags& f, const OutsideRun& run) {
  std::vector<Row> rows;
  std::set<std::string> names;
  for (const std::string& file : f.files) {
    const std::string name = f.name.empty() ? std::filesystem::path(file).stem().string() : f.name;
    for (const OutsideEstimates& e : read_estimates(file, name, *run.trace)) {
      rows.push_back(score_outside(run, e));
      if (!names.insert(rows.back().entry.name()).second)
        throw std::invalid_argument(fmt::format(
            "{}: {} is there already; --name calls it otherwise", file, rows.back().entry.name()));
    }
  }
  for (const std::string& e : f.ours) {
    const Output out = run.robot->runner(e, "", *run.trace)->run();
    rows.push_back(score_outside(run, {e, "", out}));
  }
  return rows;
}

int score(const Flags& f) {
  const bool simulated = !f.scenario.empty();
  if (simulated == !f.log.empty())
    throw std::invalid_argument("a --log, or --robot and --scenario, are required");
  if (f.robot.empty() && (simulated || !f.ours.empty()))
    throw std::invalid_argument("--scenario and --estimator want a --robot");
  if (f.files.empty() && f.ours.empty())
    throw std::invalid_argument("files of estimates, or --estimator, are required");
  const TableFormat format = table_format(f.format);
  OutsideRun run;
  if (!f.robot.empty()) run.robot = &robot(with_lock(f.robot, f.lock));
  refuse_twice("estimator", f.ours);
  for (const std::string& e : f.ours) run.robot->check(e, "");
  RecordedLog log;
  if (simulated) {
    run.scenario = &scenario_of(*run.robot, f.scenario);
    const Sensors sensors = sensors_for(*run.scenario, f.sensors);
    log.trace =
        record(run.robot->load_for(*run.scenario, f.error), *run.scenario, sensors, f.recording);
    run.group = run.robot->label() + "/" + run.scenario->name;
  } else {
    log = read_any_log(f.log, {f.channel, f.columns, true});
    if (!f.ours.empty()) run.robot->make_torques(log.trace);
    run.group = std::filesystem::path(f.log).stem().string();
  }
  run.trace = &log.trace;
  run.score_from = simulated ? std::max(run.scenario->score_from, f.score_from) : f.score_from;
  const std::vector<Row> rows = scored(f, run);
  std::vector<Metric> also;
  if (!log.trace.has_truth()) also = {Metric::kRecall, Metric::kFalseAlarmsPerHour};
  fmt::print("{}", format_table(rows, format, also));
  if (format == TableFormat::kText) fmt::print("\n{}", table_legend(rows, also));
  if (!f.out.empty()) {
    AtomicFile file(f.out);
    file.write(results_json(rows, build()));
    file.commit();
  }
  const bool good =
      std::all_of(rows.begin(), rows.end(), [](const Row& r) { return r.score.error.empty(); });
  return good && log.usable() ? kGood : kAnswerIsNo;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Scores files of estimates made elsewhere: t, [NAME_]tau_ext1.., mark. Exit code 1: one "
      "fails.\n\n"
      "  tauext-score theirs.npz --robot wallmobot3 --scenario step --estimator mo2,ekf\n",
      "tauext-score");
  Flags flags;
  add_flags(app, flags);
  return run_program(app, argc, argv, [&] { return score(flags); });
}

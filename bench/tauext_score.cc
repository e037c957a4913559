// SPDX-License-Identifier: Apache-2.0
// tauext-score: scores estimates that were made elsewhere.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <optional>
#include <set>

#include "bench/outside/outside_score.h"
#include "bench/program/program.h"
#include "bench/replay/robot_log.h"
#include "bench/report/provenance.h"
#include "bench/roster/robots.h"
#include "bench/roster/threshold_file.h"
#include "bench/run/recording_flags.h"
#include "bench/score/degradation.h"
#include "bench/score/suite.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/known.h"
#include "mjcf/trace/printable.h"

namespace {

using namespace tauext;

struct Flags {
  std::vector<std::string> files, ours, logs;
  std::string detector, thresholds, channel, columns, contacts, robot, lock, scenario, name, out,
      format = "text";
  double score_from = -std::numeric_limits<double>::infinity();
  Sensors sensors;
  ModelError error;
  Recording recording;
};

void add_flags(CLI::App& app, Flags& f) {
  app.add_option("estimates", f.files, "files: CSV, .npy or .npz; or --estimator alone");
  app.add_option("--log", f.logs, "their log; alone several (--columns, --contacts: tauext-replay)")
      ->allow_extra_args(false)
      ->type_name("LOG");
  app.add_option("--channel", f.channel)->group("");
  app.add_option("--columns", f.columns)->group("");
  app.add_option("--contacts", f.contacts)->group("")->check(not_empty);
  app.add_option("--robot", f.robot, "robot, or a file of MJCF or URDF (with --lock REGEX)")
      ->type_name("NAME|FILE");
  app.add_option("--lock", f.lock)->group("")->check(not_empty);
  app.add_option("--scenario", f.scenario, "instead of a log: the run that tauext-record makes");
  add_recording_flags(app, f.sensors, f.error, f.recording);
  app.add_option("--name", f.name, "of an estimator that its file does not name; else the file's");
  app.add_option("--estimator", f.ours, "ours beside them, like mo2:bandwidth=50,ekf")
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--detector", f.detector,
                 "behind ours, like cusum; --thresholds FILE of tauext-detect");
  app.add_option("--thresholds", f.thresholds)->group("");
  app.add_option("--score_from", f.score_from, "errors count from this time on [s]")
      ->type_name("S");
  app.add_option("--out", f.out, "JSON to write; --format csv|json|md|latex is that of the table")
      ->type_name("FILE");
  app.add_option("--format", f.format)->group("");
}

// the rows of these files, on one trace
void add_files(const Flags& f, const OutsideRun& run, std::vector<Row>& rows) {
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
}

// and of ours
void add_ours(const Flags& f, const std::vector<OutsideRun>& runs, std::vector<Row>& rows) {
  if (f.ours.empty()) return;
  const Robot& r = *runs.front().robot;
  const Thresholds trained = f.thresholds.empty() ? Thresholds() : read_thresholds(f.thresholds);
  for (const std::string& log : f.logs) {
    if (trained.trained_on.find(std::filesystem::path(log).filename().string()) !=
        std::string::npos)
      say(log + ": the thresholds were trained on it, so it has no false alarms by itself");
  }
  for (const std::string& e : f.ours) {
    const DetectorSettings settings{trained_for(trained, r, 0, e, f.detector)};
    std::vector<OutsideEstimates> all;
    for (const OutsideRun& run : runs)
      all.push_back({e, f.detector, r.pair(e, f.detector, *run.trace, settings).run(*run.trace)});
    rows.push_back(runs.size() == 1 ? score_outside(runs.front(), all.front())
                                    : score_outside(runs, all));
    for (const Row& row : rows) {
      if (&row == &rows.back() || row.entry.name() != rows.back().entry.name()) continue;
      throw std::invalid_argument(fmt::format(
          "{} of {} is ours, too; --name or its columns must call it otherwise", e, f.files[0]));
    }
  }
}

void require_flags(const CLI::App& app, const Flags& f) {
  const bool simulated = !f.scenario.empty();
  if (simulated == !f.logs.empty())
    throw std::invalid_argument("either --log, or --robot and --scenario, is required");
  if (f.robot.empty() && (simulated || !f.ours.empty()))
    throw std::invalid_argument("--scenario and --estimator want a --robot");
  if (f.files.empty() && f.ours.empty())
    throw std::invalid_argument("files of estimates, or --estimator, are required");
  if (f.logs.size() > 1 && !f.files.empty())
    throw std::invalid_argument(
        fmt::format("{}: a file of estimates goes with one --log", f.files.front()));
  require_mode(app, !f.ours.empty(), "--estimator", {"--detector", "--thresholds"});
  require_mode(app, simulated, "--scenario, not with --log", recording_flags());
  require_mode(app, !simulated, "--log", {"--contacts"});
  if (!f.thresholds.empty() && f.detector.empty())
    throw std::invalid_argument("--thresholds needs a --detector");
  const std::string kind = std::filesystem::path(f.out).extension();
  if (!kind.empty() && kind != ".json")
    throw std::invalid_argument(
        fmt::format("--out {}: the file is JSON, so its name ends in .json; --format is that of "
                    "the printed table",
                    f.out));
  refuse_twice("estimator", f.ours);
  refuse_twice("log", f.logs);
}

// what is scored: a simulated run, or logs
struct Recorded {
  std::vector<RecordedLog> logs;
  std::vector<OutsideRun> runs;  // whose traces are these
  bool usable = true;
};

Recorded recorded(const Flags& f) {
  Recorded all;
  const Robot* const r = f.robot.empty() ? nullptr : &robot(f.robot, f.lock);
  for (const std::string& e : f.ours) r->check(e, f.detector);
  if (!f.scenario.empty()) {
    const Scenario& s = scenario_of(*r, f.scenario);
    const Sensors sensors = sensors_for(s, f.sensors);
    all.logs.push_back({record(r->load_for(s, f.error), s, sensors, f.recording)});
    all.runs.push_back(
        {nullptr, r->label() + "/" + s.name, r, &s, std::max(s.score_from, f.score_from)});
  }
  if (!f.scenario.empty() && !(f.score_from < all.logs[0].trace.t.back()))
    throw std::invalid_argument(fmt::format("--score_from {}: {} ends at {} s", f.score_from,
                                            f.scenario, all.logs[0].trace.t.back()));
  const std::string group = f.logs.size() == 1 ? std::filesystem::path(f.logs[0]).stem().string()
                                               : fmt::format("{}_logs", f.logs.size());
  const auto contacts = contacts_of(f.contacts, f.logs);
  for (const std::string& path : f.logs) {
    if (f.ours.empty()) {
      all.logs.push_back(read_any_log(
          path, {f.channel, f.columns, r == nullptr ? std::vector<std::string>() : r->joints(),
                 true, contacts}));
      if (r != nullptr) r->require_joints(all.logs.back().trace, path);
    } else {
      all.logs.push_back(robot_log(*r, path, f.channel, f.columns, contacts));
    }
    RecordedLog& log = all.logs.back();
    if (log.trace.size() < 3)
      throw std::invalid_argument(
          fmt::format("{}: {} samples say nothing", path, log.trace.size()));
    if (!(f.score_from < log.trace.t.back()))
      throw std::invalid_argument(
          fmt::format("--score_from {}: {} ends at {} s", f.score_from, path, log.trace.t.back()));
    if (r != nullptr) take_sensor(*r, log.trace);
    all.usable = all.usable && log.usable();
    all.runs.push_back({nullptr, group, r, nullptr, f.score_from, path});
  }
  for (std::size_t i = 0; i < all.runs.size(); ++i) all.runs[i].trace = &all.logs[i].trace;
  return all;
}

// where so little was watched that a number of false alarms in an hour means nothing
void say_what_is_short(const std::vector<Row>& rows) {
  constexpr double kUnknown = 300;  // [1/h] that 44 s without a false alarm do not exclude
  for (const Row& r : rows) {
    const auto high = r.score.get(Metric::kFalseAlarmsHigh);
    const double low = r.score.get(Metric::kFalseAlarmsLow).value_or(0);
    if (!high || *high < kUnknown || low > *high / 2) continue;
    say(
        fmt::format("{}: so little was watched that {:.3g} to {:.3g} false alarms an hour are "
                    "possible (95 %); longer recordings tell",
                    r.entry.name(), low, *high));
  }
}

int score(const CLI::App& app, const Flags& f) {
  require_flags(app, f);
  const TableFormat format = table_format(f.format);
  std::optional<AtomicFile> out;
  if (!f.out.empty()) out.emplace(f.out);
  const Recorded all = recorded(f);
  std::vector<Row> rows;
  if (!f.files.empty()) add_files(f, all.runs.front(), rows);
  add_ours(f, all.runs, rows);
  const bool truth = std::all_of(all.logs.begin(), all.logs.end(),
                                 [](const RecordedLog& l) { return l.trace.has_truth(); });
  std::vector<Metric> also;
  if (!truth) also = {Metric::kRecall, Metric::kFalseAlarmsPerHour};
  std::FILE* const tables = f.out == "-" ? stderr : stdout;  // standard output is for JSON alone
  fmt::print(tables, "{}", format_table(rows, format, also));
  if (format == TableFormat::kText) fmt::print(tables, "\n{}", table_legend(rows, also));
  say_what_is_short(rows);
  if (out) {
    const std::string degraded = describe({f.sensors, f.error, f.recording.drives});
    const std::string run = f.scenario.empty()
                                ? "recordings: " + all.runs.front().group
                                : fmt::format("seed {}{}{}", f.sensors.seed,
                                              degraded.empty() ? "" : "\ndegraded: ", degraded);
    out->write(results_json(rows, provenance(run)));
    out->commit();
  }
  const bool good =
      std::all_of(rows.begin(), rows.end(), [](const Row& r) { return r.score.error.empty(); });
  return good && all.usable ? kGood : kAnswerIsNo;
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
  return run_program(app, argc, argv, [&] { return score(app, flags); });
}

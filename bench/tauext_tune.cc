// SPDX-License-Identifier: Apache-2.0
// tauext-tune: the best parameters of an estimator, and of a detector behind it.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/outside/outside_score.h"
#include "bench/program/interrupt.h"
#include "bench/program/program.h"
#include "bench/replay/robot_log.h"
#include "bench/roster/robots.h"
#include "bench/run/recording_flags.h"
#include "bench/run/scenario_file.h"
#include "bench/run/study_flags.h"
#include "bench/score/degradation.h"
#include "bench/score/table.h"
#include "bench/seeds/golden.h"
#include "bench/seeds/seed_tables.h"
#include "bench/seeds/seeds.h"
#include "bench/study/detection/tuned.h"
#include "bench/tune/study_tuning.h"
#include "bench/tune/tune.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/input_file.h"
#include "mjcf/trace/known.h"
#include "mjcf/trace/printable.h"
#include "mjcf/trace/table_writer.h"

namespace {

using namespace tauext;

struct Flags {
  std::string robot, lock, minimize, scenarios, seeds = "1-3", test_seeds = "101-110";
  std::string columns, channel, contacts, format = "text";
  TunedPair pair;
  std::vector<std::string> keys, limits, scenario, logs, test_logs;
  std::vector<std::string> conditions, parts;  // of the study; to merge
  std::string shard, out;
  int evaluations = 60;
  SuiteOptions suite;
};

void add_flags(CLI::App& app, Flags& f) {
  const auto list = [&](const char* name, std::vector<std::string>& to, const char* help) {
    return app.add_option(name, to, help)->delimiter(',')->allow_extra_args(false);
  };
  app.add_option("--robot", f.robot, "robot, or its file (with --lock REGEX)")
      ->type_name("NAME|FILE");
  app.add_option("--lock", f.lock)->group("")->check(not_empty);
  app.add_option("--estimator", f.pair.estimator, "to tune, like mo2")->type_name("SPEC");
  app.add_option("--detector", f.pair.detector, "behind it, like high_pass")->type_name("SPEC");
  list("--tune", f.keys, "of either, KEY or KEY=LOW:HIGH (tauext-replay --list shows them)")
      ->type_name("KEY,..");
  app.add_option("--minimize", f.minimize, "a metric; unless said rmse_Nm, with a detector delay_s")
      ->type_name("METRIC");
  list("--limit", f.limits, "that the mean over seeds must keep in each scenario, like noise_Nm=1")
      ->type_name("METRIC=X,..");
  list("--scenario", f.scenario,
       "on these; else step,sine,in_motion, or a detector's blows, pushes")
      ->type_name("NAME,..");
  app.add_option("--scenarios", f.scenarios)->group("");
  app.add_option("--seeds", f.seeds, "of the sensors, to tune on")->type_name("1-3");
  app.add_option("--test_seeds", f.test_seeds, "to test on")->type_name("101-110");
  list("--log", f.logs, "labelled recordings to tune on (--columns, --contacts: tauext-replay)")
      ->type_name("LOG");
  list("--test_log", f.test_logs, "labelled recordings to test on")->type_name("LOG");
  app.add_option("--contacts", f.contacts)->group("")->check(not_empty);
  app.add_option("--columns", f.columns)->group("");
  app.add_option("--channel", f.channel)->group("");
  list("--conditions", f.conditions,
       "tune all pairs of tauext-detect (in parts: --shard I/N, merge PART..)")
      ->type_name("NAME,..");
  app.add_option("--out", f.out, "file of pairs and thresholds, of --conditions, to which is added")
      ->type_name("FILE.json")
      ->check(not_empty);
  app.add_option("--shard", f.shard)->group("")->check(not_empty);
  app.add_option("--evaluations", f.evaluations, "that may be made")
      ->check(CLI::Range(3, 100000).description(""))
      ->capture_default_str()
      ->type_name("N");
  app.add_option("--format", f.format, "of the table: text, csv, json, md or latex")
      ->type_name("NAME");
  add_recording_flags(app, f.suite.sensors, f.suite.model_error, f.suite.recording);
  for (const char* less_used : {"--kp", "--velocity_noise", "--degrade", "--seed"})
    app.get_option(less_used)->group("");
}

Metric metric_of(const std::string& key) {
  return find_known(kMetrics, "metric", key, [](const MetricRow& m) { return std::string(m.key); })
      .metric;
}

std::vector<Limit> limits_of(const std::vector<std::string>& texts) {
  std::vector<Limit> limits;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == text.npos)
      throw std::invalid_argument(
          fmt::format("--limit {}: METRIC=X, like {}=1", text, key_of(metric_of(text))));
    const std::string key = text.substr(0, equals);
    limits.emplace_back(metric_of(key),
                        detail::number_of("--limit " + key, text.substr(equals + 1), -1e12, 1e12));
  }
  return limits;
}

// what is usual, of those that the robot has
std::vector<std::string> scenarios_of(const Flags& f, const Robot& r) {
  if (!f.scenario.empty()) return f.scenario;
  std::vector<std::string> wanted = {"step", "sine", "in_motion"};
  if (!f.pair.detector.empty()) wanted = {"collision", "blow", "push"};
  std::vector<std::string> all, there;
  for (const Scenario& s : r.scenarios()) {
    all.push_back(s.name);
    if (std::count(wanted.begin(), wanted.end(), s.name) > 0) there.push_back(s.name);
  }
  if (there.empty())
    throw std::invalid_argument(fmt::format("--scenario is required: {} has none of {}; it has: {}",
                                            r.name(), fmt::join(wanted, ", "),
                                            fmt::join(all, ", ")));
  return there;
}

using Scores = std::vector<std::vector<Score>>;  // by run, by seed

// scores on simulated runs
class Simulated {
 public:
  Simulated(const Flags& f, const Robot& r, const char* flag, const std::string& seeds)
      : robot_(r.name()), scenarios_(scenarios_of(f, r)), scorer_(f.suite, seeds_of(seeds, flag)) {}

  std::vector<SeededRow> rows(const std::vector<TunedPair>& pairs) {
    std::vector<Entry> entries;
    for (const std::string& s : scenarios_)
      for (const TunedPair& p : pairs) entries.emplace_back(robot_, s, p.estimator, p.detector);
    return scorer_(entries);
  }
  Scores operator()(const TunedPair& p) {
    Scores scores;
    for (SeededRow& row : rows({p})) scores.push_back(std::move(row.scores));
    return scores;
  }

 private:
  std::string robot_;
  std::vector<std::string> scenarios_;
  SeedScorer scorer_;
};

// scores on recordings, all of them together
class Recordings {
 public:
  Recordings(const Flags& f, const Robot& r, const std::vector<std::string>& paths) : robot_(r) {
    std::vector<std::string> all = f.logs;
    all.insert(all.end(), f.test_logs.begin(), f.test_logs.end());
    const auto contacts = contacts_of(f.contacts, all);
    for (const std::string& path : paths) {
      logs_.push_back(robot_log(r, path, f.channel, f.columns, contacts));
      logs_.back().require_consistent(path);
    }
    for (const RecordedLog& log : logs_)
      runs_.push_back(
          {&log.trace, fmt::format("{}_logs", paths.size()), &r, nullptr, log.trace.t.front()});
  }
  Recordings(const Recordings&) = delete;
  Recordings& operator=(const Recordings&) = delete;

  Row row(const TunedPair& p) const {
    std::vector<OutsideEstimates> all;
    for (const OutsideRun& run : runs_)
      all.push_back({p.estimator, p.detector,
                     robot_.pair(p.estimator, p.detector, *run.trace).run(*run.trace)});
    return score_outside(runs_, all);
  }
  Scores operator()(const TunedPair& p) const { return {{row(p).score}}; }

 private:
  const Robot& robot_;
  std::vector<RecordedLog> logs_;
  std::vector<OutsideRun> runs_;
};

std::string name_of(const TunedPair& p) {
  return p.detector.empty() ? p.estimator : p.estimator + "+" + p.detector;
}

void print_found(const Tuned& t, Metric minimize, std::FILE* to) {
  const auto value = [&](double x, const std::string& breaks) {
    return std::isnan(x) ? breaks : fmt::format("{} {:.4g}", key_of(minimize), x);
  };
  fmt::print(to, "start  {}  {}\n{:<5}  {}  {}\n{} evaluations\n", name_of(t.start),
             value(t.of_start, t.start_breaks), std::isnan(t.of_best) ? "nearest" : "best",
             name_of(t.best), value(t.of_best, t.best_breaks), t.evaluations);
  if (!t.at_bound.empty())
    fmt::print(to, "at an end of its range: {}; a wider one may have a better value\n",
               fmt::join(t.at_bound, ", "));
}

void require_flags(const Flags& f) {
  if (f.robot.empty() || f.pair.estimator.empty() || f.keys.empty())
    throw std::invalid_argument(
        "--robot, --estimator and --tune are required; see tauext-tune --help");
  if (f.logs.empty() != f.test_logs.empty())
    throw std::invalid_argument(
        "--log and --test_log go together: no recording says what tuning on itself is worth");
  for (const std::string& log : f.logs) {
    for (const std::string& test : f.test_logs) {
      if (std::filesystem::weakly_canonical(log) == std::filesystem::weakly_canonical(test))
        throw std::invalid_argument(test + ": --test_log cannot be what was tuned on");
    }
  }
  if (!f.logs.empty()) return;
  if (!f.contacts.empty()) throw std::invalid_argument("--contacts goes with --log and --test_log");
  for (const std::uint64_t seed : seeds_of(f.seeds)) {
    const std::vector<std::uint64_t> test = seeds_of(f.test_seeds, "--test_seeds");
    if (std::count(test.begin(), test.end(), seed) > 0)
      throw std::invalid_argument(fmt::format("seed {} is in both --seeds and --test_seeds", seed));
  }
}

int tune_on_recordings(const Flags& f, const Robot& r, TuneOptions o, TableFormat format) {
  std::FILE* const words = format == TableFormat::kText ? stdout : stderr;
  const Recordings training(f, r, f.logs), test(f, r, f.test_logs);
  o.score = [&](const TunedPair& p) { return training(p); };
  const Tuned t = tune(o);
  print_found(t, o.minimize, words);
  fmt::print(words, "\nOn recordings that no tuning has seen:\n\n");
  const std::vector<Row> rows = {test.row(t.start), test.row(t.best)};
  const std::vector<Metric> also = {Metric::kRecall, Metric::kFalseAlarmsPerHour, o.minimize};
  fmt::print("{}", format_table(rows, format, also));
  if (format == TableFormat::kText) fmt::print("\n{}", table_legend(rows, also));
  return std::isnan(t.of_best) ? kAnswerIsNo : kGood;
}

// pairs of the study to tune into a file
struct ConditionsToTune {
  const Robot* robot;                   // null for the first one that has runs
  std::vector<std::string> conditions;  // names
  std::string estimators, detectors;    // specifications, apart by commas; "" for all
  int evaluations;                      // of each pair
  std::string shard;                    // "I/N", or "" for all of it
  std::string out;                      // the file, to which is added
  std::string format;                   // of the table
};

// the texts between commas
std::vector<std::string> list_of(const std::string& text) {
  std::vector<std::string> all;
  std::istringstream in(text);
  for (std::string item; std::getline(in, item, ',');) all.push_back(item);
  return all;
}

std::string command_of(const ConditionsToTune& f) {
  std::string text = "tauext-tune";
  if (f.robot != nullptr) text += " --robot " + f.robot->name();
  text +=
      fmt::format(" --conditions {} --evaluations {}", fmt::join(f.conditions, ","), f.evaluations);
  if (!f.estimators.empty()) text += " --estimator " + f.estimators;
  if (!f.detectors.empty()) text += " --detector " + f.detectors;
  return text + " --out FILE.json";  // whose name says nothing, nor that it was made in parts
}

// tunes the pairs that the file does not have, adds them, and prints them; kInterrupted if there
// are pairs left
int tune_conditions(const ConditionsToTune& f) {
  if (f.out.empty())
    throw std::invalid_argument("--conditions needs --out FILE.json, for pairs and thresholds");
  const TableFormat format = table_format(f.format);
  const auto known = [&] {
    if (!std::filesystem::exists(f.out)) return study::TunedStudy();
    study::TunedStudy all = study::read_tuned(f.out);
    release_input(f.out);
    return all;
  };
  { const AtomicFile probe(f.out); }  // an unwritable path should not cost a run
  const Interrupt interrupt;
  std::atomic<bool> told = false;
  std::vector<study::TunedRow> rows;
  Progress progress("tuning");
  StudyTuning o;
  o.robot = f.robot;
  o.conditions = f.conditions;
  o.estimators = list_of(f.estimators);
  o.detectors = list_of(f.detectors);
  o.evaluations = f.evaluations;
  if (!f.shard.empty()) o.shard = study::shard_of(f.shard);
  o.progress = progress.callback();
  o.stop = [&] {
    if (interrupt.seen() && !told.exchange(true))
      say("stopping: what was tuned gets its thresholds first, which takes a minute");
    return interrupt.seen();
  };
  o.found = [&](const study::TunedStudy& more) {
    study::TunedStudy all = known();  // as it is now: somebody else may have added to it
    study::TunedStudy adds = more;
    adds.made_by = command_of(f);
    append(adds, all);
    study::write_tuned(all, f.out);
    rows.insert(rows.end(), more.rows.begin(), more.rows.end());
  };
  tune_study(o, known().rows);
  progress.clear();
  TableWriter table({{"condition", "", true},
                     {"before", "", true},
                     {"recall", "%"},
                     {"tuned", "", true},
                     {"recall", "%"},
                     {"evaluations", ""}});
  const auto share = [](double x) { return std::isnan(x) ? "-" : percent(x, 1); };
  for (const study::TunedRow& p : rows)
    table.add({p.condition, p.before, share(p.recall_before), p.estimator + "+" + p.detector,
               share(p.recall), fmt::to_string(p.evaluations)});
  if (rows.empty())
    say(f.out + ": nothing was added: it has all of these pairs that make estimates");
  else
    fmt::print("{}", table.format(format));
  if (told) say("stopped; the same command goes on from here");
  return told ? kInterrupted : int{kGood};
}

int run(const CLI::App& app, Flags& f) {
  require_mode(app, !f.conditions.empty(), "--conditions", {"--out", "--shard"});
  if (!f.conditions.empty()) {
    const char* const why = "one pair, not with --conditions";
    require_mode(app, false, why,
                 {"--tune", "--minimize", "--limit", "--scenario", "--scenarios", "--seeds",
                  "--test_seeds", "--log", "--test_log", "--columns", "--channel", "--contacts"});
    require_mode(app, false, why, recording_flags());
    const bool named = !f.robot.empty() || !f.lock.empty();
    return tune_conditions({named ? &robot(f.robot, f.lock) : nullptr, f.conditions,
                            f.pair.estimator, f.pair.detector, f.evaluations, f.shard, f.out,
                            f.format});
  }
  require_flags(f);
  const TableFormat format = table_format(f.format);
  const char* const simulated = "simulated runs, not with --log";
  require_mode(app, f.logs.empty(), simulated,
               {"--scenario", "--scenarios", "--seeds", "--test_seeds"});
  require_mode(app, f.logs.empty(), simulated, recording_flags());
  const Robot& r = robot(f.robot, f.lock);
  if (!f.scenarios.empty()) add_scenarios(f.scenarios, r);
  r.check(f.pair.estimator, f.pair.detector);
  if (f.suite.sensors.ideal()) f.suite.sensors = golden_sensors();
  TuneOptions o;
  o.keys = keys_of(
      f.keys, f.pair, r.estimator_fields(f.pair.estimator),
      f.pair.detector.empty() ? std::vector<FieldHelp>() : r.detector_fields(f.pair.detector));
  o.pair = without(f.pair, o.keys);
  o.check = [&](const TunedPair& p) { r.check(p.estimator, p.detector); };
  o.minimize = !f.minimize.empty()       ? metric_of(f.minimize)
               : f.pair.detector.empty() ? Metric::kRmse
                                         : Metric::kDelay;
  o.limits = limits_of(f.limits);
  if (o.minimize == Metric::kDelay && o.limits.empty()) {
    // else the lowest threshold is the quickest, and a missed collision is never late
    o.limits = {{Metric::kFalseAlarms, 0}, {Metric::kRecall, 1}};
    say("no --limit is given: false_alarms=0,recall=1 is taken");
  }
  o.evaluations = f.evaluations;
  Progress progress("tuning");
  o.progress = progress.callback();
  std::FILE* const words = format == TableFormat::kText ? stdout : stderr;
  if (f.logs.empty()) {
    Simulated training(f, r, "--seeds", f.seeds), test(f, r, "--test_seeds", f.test_seeds);
    o.score = [&](const TunedPair& p) { return training(p); };
    const Tuned t = tune(o);
    print_found(t, o.minimize, words);
    fmt::print(words, "\nOn seeds that no tuning has seen, {}:\n\n",
               describe({f.suite.sensors, f.suite.model_error, f.suite.recording.drives}));
    fmt::print("{}", format_seeds(test.rows({t.start, t.best}), name_of(t.start), format));
    return std::isnan(t.of_best) ? kAnswerIsNo : kGood;
  }
  return tune_on_recordings(f, r, std::move(o), format);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Finds the best parameters of an estimator, and of a detector behind it, on training seeds\n"
      "or recordings, and tells what they are worth on others. Exit code 1: none keeps a limit.\n\n"
      "  tauext-tune --robot wallmobot3 --estimator mo2 --tune bandwidth=5:300 --limit "
      "noise_Nm=1\n",
      "tauext-tune");
  Flags f;
  add_flags(app, f);
  CLI::App* const merging = app.add_subcommand("merge", "put files of --shard together");
  merging->group("")->add_option("parts", f.parts, "their files")->required();
  merging->add_option("--out", f.out, "file of all of them")->required();
  for (CLI::Option* of_tuning : app.get_options()) merging->excludes(of_tuning);
  return run_program(app, argc, argv,
                     [&] { return merging->parsed() ? merge_tuned(f.parts, f.out) : run(app, f); });
}

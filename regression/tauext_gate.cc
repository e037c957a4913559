// SPDX-License-Identifier: Apache-2.0
// Judges a build of estimators beside another one and beside what was committed.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "bench/program/program.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/input_file.h"
#include "mjcf/trace/known.h"
#include "mjcf/trace/printable.h"
#include "regression/accept.h"
#include "regression/counts/instructions.h"
#include "regression/history/drift.h"
#include "regression/history/history.h"
#include "regression/host/child.h"
#include "regression/host/ending.h"
#include "regression/report/explain.h"
#include "regression/report/findings.h"
#include "regression/report/layers.h"
#include "regression/report/report.h"
#include "regression/time/calibrate.h"
#include "regression/time/time_worker.h"
#include "regression/update.h"

namespace tauext::gate {
namespace {

// of the subcommands append and history
struct HistoryFlags {
  std::string file, markdown, charts;
  MeasureOptions measure;
  bool all = false;
};

struct Flags {
  GateOptions gate;
  UpdateOptions update;
  CalibrateOptions calibrate;
  HistoryFlags history;
  std::string junit, markdown, base_json, head_json, subject, accept, base_commit;
  bool all = false;
};

void write(const std::string& path, const std::string& text) {
  if (path.empty()) return;
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

// an unwritable report should not cost a run
void require_writable(const Flags& f) {
  for (const std::string* path : {&f.junit, &f.markdown, &f.base_json, &f.head_json}) {
    if (!path->empty()) AtomicFile{*path};
  }
}

void require_plugin(const std::string& path, const char* flag = "--head") {
  if (!path.empty()) return;
  throw std::invalid_argument(fmt::format(
      "no tauext_plugin.so beside this program: build that target, or name one by {}", flag));
}

// a terminal shows what is going on, a log gets a line for each layer
std::function<void(const std::string&)> shown_by(Progress& progress) {
  if (progress.shown()) return [&progress](const std::string& what) { progress.show(what); };
  return [last = std::string()](const std::string& what) mutable {
    const std::string begin = what.substr(0, what.find(' '));
    if (begin != last) say("gate: " + what.substr(0, what.find(':')));
    last = begin;
  };
}

int check(const CLI::App& sub, Flags& f) {
  if (!(f.gate.period > 0)) throw std::invalid_argument("--period: more than 0 s");
  if (sub.get_option_no_throw("--accept") && sub.count("--accept") > 0) {
    if (f.accept.empty()) throw std::invalid_argument("--accept: say why");
    if (f.base_commit.empty()) {
      throw std::invalid_argument(
          "--accept: beside which --base-commit? ci/gate --accept knows it");
    }
  }
  if (f.gate.time || f.gate.instructions) require_plugin(f.gate.head);
  require_writable(f);
  read_acceptances(accepted_path(f.gate.baselines));  // no run for a file that is broken
  Progress progress("gate");
  f.gate.progress = shown_by(progress);
  GateResult r = run_layers(f.gate);
  progress.clear();
  accept_findings(f.gate, f.base_commit, f.accept, r);
  fmt::print("{}", printable(format_terminal(r, f.all)));
  write(f.junit, format_junit(r));
  write(f.markdown, format_markdown(r));
  if (timed(r) && !f.base_json.empty()) write(f.base_json, format_benchmark(r, false));
  if (timed(r) && !f.head_json.empty()) write(f.head_json, format_benchmark(r, true));
  return exit_code(r);
}

int update(Flags& f) {
  const UpdateResult r = update_baselines(f.update);
  fmt::print("{}", r.text);
  return r.code;
}

int calibrate(const CLI::App& sub, Flags& f) {
  if (!f.calibrate.head.empty() && sub.count("--slowdowns") > 0) {
    throw std::invalid_argument(
        "--slowdowns: nothing is injected where --head says what is slower");
  }
  require_plugin(f.calibrate.base, "--base");
  if (f.calibrate.trials < 1) throw std::invalid_argument("--trials: at least 1");
  Progress progress("trying");
  f.calibrate.progress = progress.callback();
  const std::vector<Power> power = gate::calibrate(f.calibrate);
  progress.clear();
  fmt::print("{}", format_power(power, f.calibrate));
  return kGood;
}

// measures a commit and adds its line to the history
ExitCode append(const HistoryFlags& f) {
  check_record(f.measure.record);
  if (f.measure.bench.empty()) say("no --bench: no metrics are recorded");
  const std::vector<Record> history = read_history(f.file);
  std::string text = history.empty() ? "" : read_whole(f.file);
  if (!text.empty() && text.back() != '\n') text += '\n';
  release_input(f.file);  // it is made of what it was
  AtomicFile file(f.file);
  const Record record = measure(f.measure, history);
  file.write(text + format_record(record) + "\n");
  file.commit();
  fmt::print("{}: commits on record: {}, the last is {}\n", f.file, history.size() + 1,
             printable_name(record.commit));
  return kGood;
}

// what the history says of its last commit
ExitCode show_history(const HistoryFlags& f) {
  const std::vector<Record> history = parse_history(read_json_text(f.file), f.file);
  if (history.empty()) throw std::runtime_error(f.file + ": no commit is on record");
  const Drift drift = drift_of(history);
  fmt::print("{}", printable(format_drift(history, drift, f.all, false)));
  write(f.markdown, printable(format_drift(history, drift, f.all, true)));
  if (!f.charts.empty()) write(f.charts, format_for_charts(history.back()));
  if (!drift.any()) return kGood;
  return drift.slower() ? kSlower : kLessAccurate;
}

// beside this program, where it is built and installed
std::string sibling(const std::string& name) {
  const auto path = std::filesystem::path(this_program()).parent_path() / name;
  return std::filesystem::exists(path) ? path.string() : "";
}

CLI::Option* add_regex(CLI::App* sub, const char* name, std::string& to, const char* help) {
  return sub->add_option(name, to, help)->type_name("REGEX")->check(regular_expression);
}

void add_plugins(CLI::App* sub, Flags& f) {
  sub->add_option("--base", f.gate.base, "plug-in to compare with")->type_name("SO");
  sub->add_option("--head", f.gate.head, "plug-in to be judged; else the one beside this program")
      ->type_name("SO");
  add_regex(sub, "--kernels", f.gate.kernels, "those that match alone");
}

void add_bench(CLI::App* sub, Flags& f) {
  sub->add_option("--bench", f.gate.bench,
                  "program with --golden; else the tauext-bench beside this one")
      ->type_name("PROGRAM");
  add_regex(sub, "--entries", f.gate.entries, "those that match alone");
}

void add_baselines(CLI::App* sub, std::string& to) {
  sub->add_option("--baselines", to, "folder of what was committed")
      ->type_name("FOLDER")
      ->capture_default_str();
}

void add_reports(CLI::App* sub, Flags& f) {
  sub->add_flag("--all", f.all, "show what is well, too");
  sub->add_option("--junit", f.junit, "JUnit XML")->type_name("FILE");
  sub->add_option("--markdown", f.markdown, "for a CI job's summary")->type_name("FILE");
  sub->add_option("--base-json", f.base_json, "times of base, for Google Benchmark's compare.py")
      ->type_name("FILE");
  sub->add_option("--head-json", f.head_json, "times of head, for the same")->type_name("FILE");
}

void add_time(CLI::App* sub, Flags& f) {
  sub->add_flag("--even-if-identical", f.gate.even_if_identical, "time also what is the same code");
  sub->add_option("--period", f.gate.period, "of control [s]; a step may take a tenth")
      ->capture_default_str();
}

void add_memory(CLI::App* sub, Flags& f) {
  sub->add_option("--accept", f.accept, "accept what fails, as it is, and say why")
      ->type_name("REASON");
  // what ci/gate_commits knows of the two commits; the help is full
  const auto add = [&](const char* name, std::string& to) { sub->add_option(name, to)->group(""); };
  add("--base-baselines", f.gate.base_committed.baselines);
  add("--base-changelog", f.gate.base_committed.changelog);
  add("--changelog", f.gate.changelog);
  add("--base-commit", f.base_commit);
  add("--no-base", f.gate.no_base);
}

// each of these judges one layer or all of them
void add_judging(CLI::App& app, Flags& f) {
  CLI::App* sub = app.add_subcommand("check", "every layer: time, instructions, accuracy");
  add_plugins(sub, f), add_bench(sub, f), add_baselines(sub, f.gate.baselines);
  add_time(sub, f), add_reports(sub, f), add_memory(sub, f);

  sub = app.add_subcommand(
      "time", "base against head, interleaved in one process, in many layouts of both");
  add_plugins(sub, f), add_time(sub, f), add_reports(sub, f);
  sub->get_option("--base")->required();
  sub->callback([&f] { f.gate.instructions = f.gate.accuracy = false; });

  sub = app.add_subcommand("count", "instructions of head beside base's and beside the committed");
  add_plugins(sub, f), add_baselines(sub, f.gate.baselines), add_reports(sub, f);
  sub->callback([&f] { f.gate.time = f.gate.accuracy = false; });

  sub =
      app.add_subcommand("accuracy", "metrics of every entry, seed by seed, beside the committed");
  add_bench(sub, f), add_baselines(sub, f.gate.baselines), add_reports(sub, f);
  add_memory(sub, f);
  sub->callback([&f] { f.gate.time = f.gate.instructions = false; });
}

void add_update(CLI::App& app, UpdateOptions& o) {
  CLI::App* sub = app.add_subcommand("update", "write what head has as the new baselines");
  sub->add_option("--reason", o.reason, "why, for the changelog")->required();
  sub->add_option("--accept-worse", o.accept_worse, "why what is worse is right");
  sub->add_option("--head", o.head, "plug-in; \"\": no counts")->type_name("SO");
  sub->add_option("--bench", o.bench, "program with --golden; \"\": no accuracy")
      ->type_name("PROGRAM");
  add_regex(sub, "--kernels", o.kernels, "those that match alone; others stay");
  add_regex(sub, "--entries", o.entries, "those that match alone; others stay");
  sub->add_option("--changelog", o.changelog)->type_name("FILE")->capture_default_str();
  add_baselines(sub, o.baselines);
}

void add_calibrate(CLI::App& app, CalibrateOptions& o) {
  CLI::App* sub =
      app.add_subcommand("calibrate", "this machine's false alarms, and what slowdowns are found");
  sub->add_option("--base", o.base, "plug-in")->type_name("SO");
  sub->add_option("--head", o.head, "one that is slower, instead of injected steps")
      ->type_name("SO");
  add_regex(sub, "--kernels", o.kernels, "those that match alone");
  sub->add_option("--slowdowns", o.slowdowns, "to inject [1]; 0: none, for false alarms")
      ->delimiter(',')
      ->check(CLI::Range(0., 1.))
      ->capture_default_str();
  sub->add_option("--trials", o.trials, "complete runs")->capture_default_str();
}

// what every commit measured, and what added up
void add_history(CLI::App& app, HistoryFlags& f) {
  CLI::App* sub = app.add_subcommand("append", "measure a commit and add it to a history");
  const auto add = [&](const char* name, std::string& to, const char* help, const char* type) {
    return sub->add_option(name, to, help)->type_name(type);
  };
  Record& r = f.measure.record;
  add("history", f.file, "JSON, a line for each commit", "FILE")->required();
  add("--commit", r.commit, "that is measured", "SHA")->required();
  add("--date", r.date, "of that commit", "ISO-DATE")->required();
  add("--title", r.title, "of that commit", "TEXT");
  add("--reference", r.reference, "the commit that it is measured beside, as the last release",
      "SHA")
      ->required();
  add("--base", f.measure.base, "plug-in of the reference", "SO")->required();
  add("--head", f.measure.head, "plug-in of the commit", "SO");
  add("--bench", f.measure.bench, "program with --golden; \"\": no metrics", "PROGRAM");
  add("--kernels", f.measure.kernels, "those that match alone", "REGEX")->check(regular_expression);
  add("--entries", f.measure.entries, "those that match alone", "REGEX")->check(regular_expression);
  add("--baselines", f.measure.baselines, "folder with what the commit accepts", "FOLDER")
      ->capture_default_str();

  sub = app.add_subcommand("history", "what has added up in a history since the last release");
  add("history", f.file, "as append writes it", "FILE")->required();
  sub->add_flag("--all", f.all, "show kernels that never changed, too");
  add("--markdown", f.markdown, "the same for a page", "FILE");
  add("--charts", f.charts, "its last commit for github-action-benchmark", "FILE.json");
}

void add_flags(CLI::App& app, Flags& f) {
  f.gate.head = f.update.head = f.calibrate.base = f.history.measure.head =
      sibling("tauext_plugin.so");
  f.gate.bench = f.update.bench = f.history.measure.bench = sibling("tauext-bench");
  f.gate.baselines = f.update.baselines = f.history.measure.baselines = "regression/baselines";
  f.gate.changelog = f.update.changelog = "regression/CHANGELOG.md";
  add_judging(app, f);
  add_update(app, f.update);
  add_calibrate(app, f.calibrate);
  add_history(app, f.history);
  CLI::App* sub = app.add_subcommand("explain", "all that is known of one kernel or entry");
  sub->add_option("subject", f.subject, "<robot>/<kernel> or <robot>/<scenario>/<estimator>")
      ->required();
  add_plugins(sub, f), add_bench(sub, f), add_baselines(sub, f.gate.baselines);
  app.require_subcommand(1);
}

int run(const CLI::App& app, Flags& f) {
  const CLI::App& sub = *app.get_subcommands().front();
  const std::string name = sub.get_name();
  if (name == "update") return update(f);
  if (name == "calibrate") return calibrate(sub, f);
  if (name == "history") return show_history(f.history);
  if (name == "append") {
    require_plugin(f.history.measure.head);
    Progress progress("gate");
    f.history.measure.progress = shown_by(progress);
    return append(f.history);
  }
  if (name != "explain") return check(sub, f);
  if (std::count(f.subject.begin(), f.subject.end(), '/') == 1) require_plugin(f.gate.head);
  fmt::print("{}", explain(f.gate, f.subject));
  return kGood;
}

// CLI11 would say that it was not expected
void refuse_unknown_subcommand(const CLI::App& app, const std::string& name) {
  if (name.empty() || name.starts_with('-')) return;
  const auto all = app.get_subcommands([](const CLI::App*) { return true; });
  find_known(all, "subcommand", name, [](const CLI::App* sub) { return sub->get_name(); });
}

int main(int argc, char** argv) {
  const std::string first = argc > 1 ? argv[1] : "";
  // children of this program itself
  if (first == "count-worker" && argc == 4) return count_main(argv[2], argv[3]);
  end_with_children_and_folders();
  if (first == "worker" && argc == 3) return worker_main(argv[2]);
  if (first == "long-worker" && argc == 3) return long_worker_main(argv[2]);
  CLI::App app(
      "Judges estimators beside another build and beside committed numbers.\n\n"
      "  tauext-gate check --base build/base/tauext_plugin.so\n"
      "  tauext-gate accuracy --entries wallmobot3/step/\n\n"
      "ci/gate builds both sides and calls it.",
      "tauext-gate");
  app.footer(
      "Exit codes: 0 passed, 1 slower, 5 less accurate, 3 no baseline or update needed, 4 "
      "inconclusive\n"
      "(too noisy, or no base), 2 could not run: wrong flags, or a harness error. Each subcommand "
      "has a --help.");
  Flags f;
  add_flags(app, f);
  app.preparse_callback([&](std::size_t) { refuse_unknown_subcommand(app, first); });
  return run_program(app, argc, argv, [&] { return run(app, f); });
}

}  // namespace
}  // namespace tauext::gate

int main(int argc, char** argv) {
  try {
    return tauext::gate::main(argc, argv);
  } catch (const std::exception& e) {  // of a child of this program, which has no flags
    tauext::say(fmt::format("tauext-gate {}: {}", argc > 1 ? argv[1] : "", e.what()));
    return tauext::kCouldNotRun;
  }
}

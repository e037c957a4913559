// SPDX-License-Identifier: Apache-2.0
#include "bench/run/suite_run.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <stdexcept>
#include <vector>

#include "bench/live/entry_tap.h"
#include "bench/program/program.h"
#include "bench/report/page.h"
#include "bench/report/provenance.h"
#include "bench/report/traces.h"
#include "bench/roster/robots.h"
#include "bench/run/reporter.h"
#include "bench/score/degradation.h"
#include "bench/score/table.h"
#include "bench/study/table3.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

using Rows = std::vector<Row>;

// the metrics that were asked for and have no value, for the JSON, in which NaN cannot stand
std::string never_label(const Score& score) {
  std::vector<std::string> never;
  for (const auto& [key, value] : score.by_key()) {
    if (std::isnan(value)) never.push_back(key);
  }
  return never.empty() ? "" : fmt::format("never: {}", fmt::join(never, " "));
}

// score first; a wrong answer is an error and is not timed
void run_entry(benchmark::State& state, Suite& suite, Row& row, const EntryTap& tap) {
  if (row.score.empty()) {
    row.score = suite.score(row.entry);
    try {
      if (tap.logs()) tap.log(row.entry, suite.run(row.entry), row.score);
    } catch (const std::exception& e) {  // a full disk costs this entry, not the run
      row.score.error = e.what();
    }
  }
  if (!row.score.error.empty()) {
    state.SkipWithError(row.score.error.c_str());
    return;
  }
  const auto runner = suite.runner(row.entry);
  for (auto _ : state) {
    runner->batch();
    benchmark::ClobberMemory();
  }
  for (const auto& [key, value] : row.score.by_key()) state.counters[key] = value;
  state.SetLabel(never_label(row.score));
  using C = benchmark::Counter;
  state.counters[key_of(Metric::kCpu)] =
      C(Runner::kBatch * 1e-9, C::kIsIterationInvariantRate | C::kInvert);
}

std::unique_ptr<benchmark::BenchmarkReporter> make_display(
    const std::optional<std::string>& format) {
  if (!format) return nullptr;
  if (*format == "console")
    return std::make_unique<benchmark::ConsoleReporter>(benchmark::ConsoleReporter::OO_Tabular);
  if (*format == "json") return std::make_unique<benchmark::JSONReporter>();
  throw std::invalid_argument(fmt::format("--benchmark_format={}: console or json", *format));
}

// what results depend on beside the build
std::string run_line(const SuiteOptions& o) {
  std::string line = fmt::format("seed {}", o.sensors.seed);
  if (o.recording.Kp) line += fmt::format(", Kp {:g} 1/s^2", *o.recording.Kp);
  if (o.recording.Kd) line += fmt::format(", Kd {:g} 1/s", *o.recording.Kd);
  const std::string degraded = describe({o.sensors, o.model_error, o.recording.drives});
  if (!degraded.empty()) line += "\ndegraded: " + degraded;
  return line;
}

void add_time(const Reporter& reporter, Row& row) {
  const auto time = reporter.cpu_ns().find(row.entry.name());
  if (time != reporter.cpu_ns().end()) row.score.set(Metric::kCpu, time->second);
}

// the entry that is through, with its time
void publish(const std::string& name, const Rows& rows, const Reporter& reporter, EntryTap& tap) {
  const auto it =
      std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.entry.name() == name; });
  if (it == rows.end()) return;
  Row row = *it;
  add_time(reporter, row);
  tap.publish(row.entry, row.score);
}

void register_benchmarks(Suite& suite, Rows& rows, const EntryTap& tap) {
  for (Row& row : rows) {
    benchmark::RegisterBenchmark(
        row.entry.name().c_str(),
        [&suite, &row, &tap](benchmark::State& s) { run_entry(s, suite, row, tap); });
  }
}

// for people a table for each robot and scenario, for programs one
void print_tables(const Rows& rows, TableFormat format, std::FILE* to) {
  if (format == TableFormat::kCsv || format == TableFormat::kJson) {
    fmt::print(to, "{}", format_table(rows, format));
    return;
  }
  for (auto first = rows.begin(); first != rows.end();) {
    const auto last = std::find_if(
        first, rows.end(), [&](const Row& r) { return r.entry.group() != first->entry.group(); });
    fmt::print(to, "{}\n", format_table({first, last}, format));
    first = last;
  }
}

// where tables go, and where sentences go
std::FILE* tables_of(const SuiteRun& run) {
  return run.display == "json" ? stderr : stdout;
}
std::FILE* words_of(const SuiteRun& run) {
  return run.format == TableFormat::kText ? tables_of(run) : stderr;
}

void print_results(const SuiteRun& run, const Rows& rows) {
  std::FILE* const words = words_of(run);
  fmt::print(words, "{}\n\n", provenance(run_line(run.suite)).front().second);
  print_tables(rows, run.format, tables_of(run));
  fmt::print(words, "{}", table_legend(rows));
  const bool step = std::any_of(rows.begin(), rows.end(), [](const Row& r) {
    return r.entry.group() == "wallmobot3/step";  // what Table III is about
  });
  if (run.paper && step) fmt::print(words, "\n{}", study::format_table3());
}

void write_json(const SuiteRun& run, const Reporter& reporter) {
  AtomicFile file(*run.out);
  file.write(reporter.json());
  file.commit();
  fmt::print(words_of(run), "\n{}: results as JSON\n", *run.out);
}

using Forces = std::map<std::string, std::unique_ptr<const ArmForces>>;  // by robot

// of all that are selected
Forces forces_of(const SuiteRun& run, const Rows& rows) {
  Forces all;
  for (const Row& row : rows) {
    const Robot& r = row.entry.robot();
    auto& of_robot = all[r.name()];
    if (run.wrench.empty() || of_robot) continue;
    try {
      of_robot = r.forces_at(run.wrench, r.dof() >= kJointsOfMoment);
    } catch (const std::invalid_argument& e) {
      throw std::invalid_argument(
          fmt::format("--wrench: {}: {} (--robot selects one)", r.name(), e.what()));
    }
  }
  return all;
}

void write_report(const SuiteRun& run, Suite& suite, const Rows& rows, const Reporter& reporter,
                  const Forces& forces) {
  Progress progress("drawing");
  report::Traces traces(run.wrench);
  for (const Row& row : rows) {
    if (row.score.error.empty())
      traces.add(row.entry, suite.run(row.entry), forces.at(row.entry.robot().name()).get());
    progress.show(static_cast<double>(&row - rows.data()) / static_cast<double>(rows.size()));
  }
  AtomicFile file(*run.report);
  file.write(
      report::page_of({checked_result(report::kOwnResults, reporter.json()),
                       checked_result(report::kOwnTraces, traces.json(run_line(run.suite)))}));
  file.commit();
  progress.clear();
  fmt::print(words_of(run), "\n{}: the report; open it in a browser\n", *run.report);
}

// that the filter selects something, before any file is written
void require_match(const Rows& rows) {
  const std::string filter = benchmark::GetBenchmarkFilter();
  const bool negative = filter.starts_with('-');
  const auto wanted = entry_filter(filter == "all" ? "" : filter.substr(negative ? 1 : 0));
  if (std::none_of(rows.begin(), rows.end(),
                   [&](const Row& r) { return wanted(r.entry.name()) != negative; }))
    throw std::invalid_argument(
        fmt::format("--benchmark_filter={} matches nothing; see tauext-bench --list", filter));
}

// whether everything that was asked for by name ran somewhere; says what did not
bool all_ran(const Selection& wanted, const Rows& rows) {
  bool all = true;
  const auto look = [&](const std::vector<std::string>& names, auto name_of) {
    for (const std::string& name : names) {
      if (std::any_of(rows.begin(), rows.end(),
                      [&](const Row& r) { return name_of(r.entry) == name; })) {
        continue;
      }
      all = false;
      say(name + ": nothing ran it; see --benchmark_filter and tauext-bench --list");
    }
  };
  look(wanted.estimators, [](const Entry& e) { return e.estimator(); });
  look(wanted.detectors, [](const Entry& e) { return e.detector(); });
  return all;
}

}  // namespace

int run_suite(const SuiteRun& run) {
  Rows rows;
  for (const Entry& e : entries(run.selection)) rows.push_back({e, {}});
  require_match(rows);
  for (const auto& path : {run.out, run.report}) {
    if (path) AtomicFile{*path};  // an unwritable path should not cost a run
  }
  const auto display = make_display(run.display);
  Suite suite(run.suite);
  const Forces forces = forces_of(run, rows);
  EntryTap tap(run.lcm, run.lcm_log.value_or(""));
  register_benchmarks(suite, rows, tap);
  for (const auto& [key, text] : provenance(run_line(run.suite))) {
    if (key != "date") benchmark::AddCustomContext(key, text);  // which it writes itself
  }
  Reporter reporter(display.get(), run.all ? static_cast<int>(rows.size()) : 0);
  reporter.on_done = [&](const std::string& name) { publish(name, rows, reporter, tap); };
  benchmark::RunSpecifiedBenchmarks(&reporter);

  std::erase_if(rows, [](const Row& r) { return r.score.empty(); });
  if (rows.empty() && run.list_tests) return kGood;
  if (rows.empty()) throw std::invalid_argument("no benchmark ran: check --benchmark_repetitions");
  for (Row& row : rows) add_time(reporter, row);
  print_results(run, rows);
  if (run.out) write_json(run, reporter);
  if (run.report) write_report(run, suite, rows, reporter, forces);
  if (!tap.heard()) say("no summary could be published");
  const bool all = all_ran(run.selection, rows);
  if (reporter.any_error() || !tap.heard()) return kAnswerIsNo;
  return all ? kGood : kCouldNotRun;
}

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
#include "bench/run/suite/suite_run.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <vector>

#include "bench/program/program.h"
#include "bench/report/provenance.h"
#include "bench/run/suite/reporter.h"
#include "bench/score/degradation.h"
#include "bench/score/table.h"
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
void run_entry(benchmark::State& state, Suite& suite, Row& row, const SuiteHooks& hooks) {
  if (row.score.empty()) {
    row.score = suite.score(row.entry);
    try {
      if (hooks.scored) hooks.scored(row, suite.run(row.entry));
    } catch (const std::exception& e) {  // a full disk costs this entry, not the run
      row.score.error = e.what();
    }
  }
  if (!row.score.error.empty()) {
    state.SkipWithError(row.score.error.c_str());
    return;
  }
  Runner runner = suite.runner(row.entry);
  for (auto _ : state) {
    runner.batch();
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

// tells of the entry that is through, with its time
void tell(const std::string& name, const Rows& rows, const Reporter& reporter,
          const SuiteHooks& hooks) {
  if (!hooks.through) return;
  const auto it =
      std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.entry.name() == name; });
  if (it == rows.end()) return;
  Row row = *it;
  add_time(reporter, row);
  hooks.through(row);
}

void register_benchmarks(Suite& suite, Rows& rows, const SuiteHooks& hooks) {
  for (Row& row : rows) {
    benchmark::RegisterBenchmark(
        row.entry.name().c_str(),
        [&suite, &row, &hooks](benchmark::State& s) { run_entry(s, suite, row, hooks); });
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
}

void write_json(const SuiteRun& run, const std::string& json) {
  AtomicFile file(*run.out);
  file.write(json);
  file.commit();
  fmt::print(words_of(run), "\n{}: results as JSON\n", *run.out);
}

// that the filter selects something, before any file is written
void require_match(const std::string& filter, const Rows& rows) {
  const bool negative = filter.starts_with('-');
  const auto wanted = entry_filter(filter.substr(negative ? 1 : 0));
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

int run_suite(const SuiteRun& run, const SuiteHooks& hooks) {
  Rows rows;
  for (const Entry& e : entries(run.selection)) rows.push_back({e, {}});
  require_match(run.filter, rows);
  if (run.out) AtomicFile{*run.out};  // an unwritable path should not cost a run
  const auto display = make_display(run.display);
  if (hooks.begin) hooks.begin(rows);
  Suite suite(run.suite);
  register_benchmarks(suite, rows, hooks);
  const std::string line = run_line(run.suite);
  for (const auto& [key, text] : provenance(line)) {
    if (key != "date") benchmark::AddCustomContext(key, text);  // which it writes itself
  }
  Reporter reporter(display.get(), run.filter.empty() ? static_cast<int>(rows.size()) : 0);
  reporter.on_done = [&](const std::string& name) { tell(name, rows, reporter, hooks); };
  benchmark::RunSpecifiedBenchmarks(&reporter);

  std::erase_if(rows, [](const Row& r) { return r.score.empty(); });
  if (rows.empty() && run.list_tests) return kGood;
  if (rows.empty()) throw std::invalid_argument("no benchmark ran: check --benchmark_repetitions");
  for (Row& row : rows) add_time(reporter, row);
  print_results(run, rows);
  const SuiteResults results{suite, rows, reporter.json(), line, words_of(run)};
  if (hooks.printed) hooks.printed(results);
  if (run.out) write_json(run, results.json);
  if (hooks.written) hooks.written(results);
  const bool all = all_ran(run.selection, rows);
  if (reporter.any_error()) return kAnswerIsNo;
  return all ? kGood : kCouldNotRun;
}

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
#include "bench/bench_main.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "bench/bandwidth_study.h"
#include "bench/cli.h"
#include "bench/degradation.h"
#include "bench/entry_tap.h"
#include "bench/golden.h"
#include "bench/reliability.h"
#include "bench/reporter.h"
#include "bench/suite.h"
#include "bench/table.h"
#include "bench/table3.h"
#include "mjcf/atomic_file.h"

namespace tauext {
namespace {

// takes --name=value (or --name value) out of argv
std::optional<std::string> take_flag(std::vector<std::string>& args, const std::string& name) {
  for (std::size_t i = 1; i < args.size(); ++i) {
    if (args[i].starts_with(name + "=")) {
      std::string value = args[i].substr(name.size() + 1);
      args.erase(args.begin() + static_cast<std::ptrdiff_t>(i));
      return value;
    }
    if (args[i] == name && i + 1 < args.size()) {
      std::string value = args[i + 1];
      args.erase(args.begin() + static_cast<std::ptrdiff_t>(i),
                 args.begin() + static_cast<std::ptrdiff_t>(i) + 2);
      return value;
    }
  }
  return std::nullopt;
}

// the metrics that were asked for and have no value, for the JSON, in which NaN cannot stand
std::string never_label(const Score& score) {
  std::vector<std::string> never;
  for (const auto& [key, value] : score.metrics) {
    if (std::isnan(value)) never.push_back(key);
  }
  return never.empty() ? "" : fmt::format("never: {}", fmt::join(never, " "));
}

// score first; a wrong answer is an error and is not timed
void run_entry(benchmark::State& state, Suite& suite, Row& row, const EntryTap& tap) {
  if (row.score.metrics.empty()) {
    row.score = suite.score(row.entry);
    try {
      if (tap.logs()) tap.log(row.entry, suite.run(row.entry), row.score);
    } catch (const std::runtime_error& e) {  // a full disk costs this entry, not the run
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
  for (const auto& [key, value] : row.score.metrics) state.counters[key] = value;
  state.SetLabel(never_label(row.score));
  using C = benchmark::Counter;
  state.counters["cpu_ns"] = C(Runner::kBatch * 1e-9, C::kIsIterationInvariantRate | C::kInvert);
}

std::unique_ptr<benchmark::BenchmarkReporter> make_display(
    const std::optional<std::string>& format) {
  if (!format) return nullptr;
  if (*format == "console")
    return std::make_unique<benchmark::ConsoleReporter>(benchmark::ConsoleReporter::OO_Tabular);
  if (*format == "json") return std::make_unique<benchmark::JSONReporter>();
  throw std::invalid_argument(fmt::format("--benchmark_format={}: console or json", *format));
}

std::string build_line(const Suite& suite) {
  const SuiteOptions& o = suite.options();
  std::string line = fmt::format("tauext {}, {}, {}, MuJoCo {}, seed {}", TAUEXT_VERSION,
                                 TAUEXT_COMPILER, TAUEXT_FLAGS, mujoco_version(), o.sensors.seed);
  if (o.recording.Kp) line += fmt::format(", Kp {:g} 1/s^2", *o.recording.Kp);
  if (o.recording.Kd) line += fmt::format(", Kd {:g} 1/s", *o.recording.Kd);
  const std::string degraded = describe({o.sensors, o.model_error});
  if (!degraded.empty()) line += "\ndegraded: " + degraded;
  return line;
}

struct Flags {
  SuiteOptions suite;
  bool list = false, list_tests = false, paper = false, reliability = false, pareto = false;
  std::optional<double> equal_bandwidth;  // [rad/s]
  std::optional<std::string> out, format, golden, lcm, lcm_log;
  std::vector<std::uint64_t> seeds = GoldenOptions().seeds;

  // what runs instead of the suite
  bool study() const { return reliability || pareto || equal_bandwidth; }
};

// the share that is done, on a terminal; nothing elsewhere
std::function<void(double)> share_done() {
  if (::isatty(STDERR_FILENO) != 1) return nullptr;
  return [](double share) {
    fmt::print(stderr, "\r\033[K");
    if (share < 1) fmt::print(stderr, "{:.0f} %", 100 * share);
  };
}

// at the noise that was asked for, or at a good and at a poor encoder's
void run_reliability(const Sensors& sensors) {
  std::vector<Trials> all(sensors.ideal() ? 2 : 1);
  for (Trials& trials : all) trials.sensors = sensors;
  if (sensors.ideal()) {
    all[0].sensors.velocity_noise = 1e-4;
    all[1].sensors.velocity_noise = 1e-3;
  }
  for (const Trials& trials : all) {
    fmt::print("{}\n", format_reliability(trials, reliability(trials, share_done())));
  }
}

int run_study(const Flags& f) {
  const SuiteOptions& o = f.suite;
  const bool degraded = !o.sensors.ideal() || !o.model_error.none();
  if (degraded && !f.reliability) {
    throw std::invalid_argument(
        "--equal-bandwidth and --pareto bring their own sensors and errors");
  }
  if (f.reliability) run_reliability(o.sensors);
  if (f.equal_bandwidth) {
    const auto rows = at_equal_bandwidth(*f.equal_bandwidth, 0, share_done());
    fmt::print("{}", format_equal_bandwidth(*f.equal_bandwidth, rows));
  }
  if (f.pareto) fmt::print("{}", format_pareto(pareto(0, share_done())));
  return kGood;
}

int run_golden(const Flags& f, const std::string& filter) {
  AtomicFile file(*f.golden);
  GoldenOptions o{.suite = f.suite, .seeds = f.seeds, .filter = filter};
  o.built = fmt::format("tauext {}, {}, {}", TAUEXT_VERSION, TAUEXT_COMPILER, TAUEXT_FLAGS);
  o.progress = share_done();
  file.write(golden_metrics(o));
  file.commit();
  return kGood;
}

// the entry that is through, with its time
void publish(const std::string& name, const std::vector<Row>& rows, const Reporter& reporter,
             EntryTap& tap) {
  const auto row =
      std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.entry.name() == name; });
  if (row == rows.end()) return;
  Score score = row->score;
  const auto time = reporter.cpu_ns().find(name);
  if (time != reporter.cpu_ns().end()) score.metrics["cpu_ns"] = time->second;
  tap.publish(row->entry, score);
}

int run(const Flags& flags) {
  const std::string filter = benchmark::GetBenchmarkFilter();
  const bool all = filter.empty() || filter == "." || filter == "all";
  if (flags.study() && (flags.out || flags.list || !all)) {
    throw std::invalid_argument(
        "--reliability, --equal-bandwidth and --pareto run instead of the suite: no "
        "--benchmark_filter, --benchmark_out or --list");
  }
  if (flags.lcm_log == "")
    throw std::invalid_argument("--lcm-log: the name of a folder is missing");
  if ((flags.study() || flags.golden) && (flags.lcm || flags.lcm_log)) {
    throw std::invalid_argument("--lcm and --lcm-log go with the suite alone");
  }
  if (flags.study()) return run_study(flags);
  if (flags.golden) return run_golden(flags, all ? "" : filter);
  if (flags.list) {
    for (const Entry& e : entries()) fmt::print("{}\n", e.name());
    return kGood;
  }
  if (flags.out) AtomicFile{*flags.out};  // an unwritable path should not cost a run
  const auto display = make_display(flags.format);

  Suite suite(flags.suite);
  EntryTap tap(flags.lcm, flags.lcm_log.value_or(""));
  std::vector<Row> rows;
  for (const Entry& e : entries()) rows.push_back({e, {}});
  for (Row& row : rows) {
    benchmark::RegisterBenchmark(
        row.entry.name().c_str(),
        [&suite, &row, &tap](benchmark::State& s) { run_entry(s, suite, row, tap); });
  }
  benchmark::AddCustomContext("tauext", build_line(suite));
  Reporter reporter(display.get(), ::isatty(STDERR_FILENO) == 1,
                    all ? static_cast<int>(rows.size()) : 0);
  reporter.on_done = [&](const std::string& name) { publish(name, rows, reporter, tap); };
  if (benchmark::RunSpecifiedBenchmarks(&reporter) == 0) {
    throw std::invalid_argument("--benchmark_filter matches nothing; see tauext-bench --list");
  }

  std::erase_if(rows, [](const Row& r) { return r.score.metrics.empty(); });
  if (rows.empty() && flags.list_tests) return kGood;
  if (rows.empty()) throw std::invalid_argument("no benchmark ran: check --benchmark_repetitions");
  for (Row& row : rows) {
    const auto time = reporter.cpu_ns().find(row.entry.name());
    if (time != reporter.cpu_ns().end()) row.score.metrics["cpu_ns"] = time->second;
  }
  std::FILE* const to = flags.format == "json" ? stderr : stdout;
  fmt::print(to, "{}\n\n", build_line(suite));
  for (auto first = rows.begin(); first != rows.end();) {  // a table for each robot and scenario
    const auto last = std::find_if(
        first, rows.end(), [&](const Row& r) { return r.entry.group() != first->entry.group(); });
    fmt::print(to, "{}\n", format_table({first, last}));
    first = last;
  }
  fmt::print(to, "{}", table_legend());
  const bool step = std::any_of(rows.begin(), rows.end(), [](const Row& r) {
    return r.entry.group() == "wallmobot3/step";  // what Table III is about
  });
  if (flags.paper && step) fmt::print(to, "\n{}", format_table3());
  if (flags.out) {
    AtomicFile file(*flags.out);
    file.write(reporter.json());
    file.commit();
    fmt::print(to, "\n{}: results as JSON\n", *flags.out);
  }
  if (!tap.heard()) fmt::print(stderr, "no summary could be published\n");
  return reporter.any_error() || !tap.heard() ? kAnswerIsNo : kGood;
}

}  // namespace

int bench_main(int argc, char** argv) {
  CLI::App app(
      "Scores every estimator on every scenario, then times its step, and prints a table.\n"
      "Exit code 1 if an entry failed. Google Benchmark's flags work, csv output excepted.\n\n"
      "  tauext-bench --benchmark_filter=step/ --benchmark_out=results.json\n",
      "tauext-bench");
  Flags flags;
  app.add_flag("--list", flags.list, "list the entries <robot>/<scenario>/<estimator>, and stop");
  app.add_flag("--paper", flags.paper,
               "print Table III of the paper beside ours, too, after wallmobot3/step");
  app.add_flag("--reliability", flags.reliability,
               "instead: 200 blows and an hour of a human's hand, on testbed1");
  app.add_option("--equal-bandwidth", flags.equal_bandwidth,
                 "instead: every estimator at so many rad/s, 1 to 200")
      ->type_name("W");
  app.add_flag("--pareto", flags.pareto, "instead: noise against delay at every bandwidth");
  app.add_option("--golden", flags.golden,
                 "instead: every metric for --seeds 1,2,.., as tauext-gate wants it")
      ->type_name("FILE");
  app.add_option("--seeds", flags.seeds)->delimiter(',')->group("");
  app.add_option_function<std::string>(
         "--thresholds",
         [&](const std::string& path) { flags.suite.thresholds = read_thresholds(path); },
         "the detectors' thresholds, as tauext-detect --calibrate writes them")
      ->type_name("FILE");
  app.add_option("--lcm", flags.lcm, "publish each entry's summary as it finishes")
      ->type_name("[URL]")
      ->expected(0, 1);
  app.add_option("--lcm-log", flags.lcm_log, "write each entry's samples and estimates as LCM log")
      ->type_name("DIR");
  app.add_option("--noise_probe", flags.suite.noise_probe)->group("");  // bench/README.md
  add_recording_flags(app, flags.suite.sensors, flags.suite.model_error, flags.suite.recording);
  for (const char* less_used : {"--kp", "--kd"}) app.get_option(less_used)->group("");
  app.footer(
      "Google Benchmark's: --benchmark_filter=REGEX --benchmark_out=FILE (JSON)\n"
      "  --benchmark_repetitions=N --benchmark_min_time=SECONDS --benchmark_format=console|json");

  std::vector<std::string> args(argv, argv + argc);
  flags.out = take_flag(args, "--benchmark_out");
  flags.format = take_flag(args, "--benchmark_format");
  const auto out_format = take_flag(args, "--benchmark_out_format");
  std::vector<char*> rest;
  bool help = false;
  for (std::string& a : args) {
    help = help || a == "--help" || a == "-h";
    flags.list_tests = flags.list_tests || a.starts_with("--benchmark_list_tests");
    rest.push_back(a.data());
  }
  int count = static_cast<int>(rest.size());
  rest.push_back(nullptr);
  if (!help) benchmark::Initialize(&count, rest.data());
  return run_program(app, count, rest.data(), [&] {
    if (out_format && *out_format != "json") {
      throw std::invalid_argument(
          "--benchmark_out_format: json is the only format; rows have different counters");
    }
    return run(flags);
  });
}

}  // namespace tauext

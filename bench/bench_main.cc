// SPDX-License-Identifier: Apache-2.0
#include "bench/bench_main.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/commands.h"
#include "bench/program.h"
#include "bench/recording_flags.h"
#include "bench/roster/threshold_file.h"
#include "bench/score/entry.h"
#include "bench/score/golden.h"
#include "bench/score/suite.h"
#include "bench/score/table.h"
#include "bench/study/study_flags.h"
#include "bench/suite_run.h"
#include "mjcf/trace/atomic_file.h"

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

struct Flags {
  SuiteOptions suite;
  Selection selection;
  StudyFlags studies;  // what runs instead of the suite; its format is that of all tables
  bool list = false, list_metrics = false, list_tests = false, paper = false;
  std::optional<std::string> out, out_format, format, golden, commands, lcm, lcm_log;
  std::vector<std::uint64_t> seeds = GoldenOptions().seeds;
};

int run_golden(const Flags& f, const std::string& filter) {
  AtomicFile file(*f.golden);
  GoldenOptions o{.suite = f.suite, .selection = f.selection, .seeds = f.seeds, .filter = filter};
  o.built = fmt::format("tauext {}, {}, {}", TAUEXT_VERSION, TAUEXT_COMPILER, TAUEXT_FLAGS);
  Progress progress("scoring");
  o.progress = progress.callback();
  file.write(golden_metrics(o));
  file.commit();
  return kGood;
}

int run(const Flags& flags) {
  if (flags.list_metrics) {
    fmt::print("{}", list_of_metrics());
    return kGood;
  }
  const std::string filter = benchmark::GetBenchmarkFilter();
  const bool all = filter.empty() || filter == "." || filter == "all";
  const bool study = wants_study(flags.studies);
  if (flags.commands && (study || flags.golden)) {
    throw std::invalid_argument("--commands goes with neither a study nor --golden");
  }
  if (study && (flags.out || flags.format || flags.list || flags.golden || flags.paper || !all)) {
    throw std::invalid_argument(
        "--reliability, --equal-bandwidth and --pareto run instead of the suite: no --paper, "
        "--golden, --list or --benchmark_...; they have --format and --out");
  }
  if (study && !flags.selection.empty()) {
    throw std::invalid_argument("--estimator and --detector go with the suite and --golden alone");
  }
  if (flags.lcm_log == "")
    throw std::invalid_argument("--lcm-log: the name of a folder is missing");
  if ((study || flags.golden) && (flags.lcm || flags.lcm_log)) {
    throw std::invalid_argument("--lcm and --lcm-log go with the suite alone");
  }
  if (study) return run_study(flags.studies, flags.suite);
  if (flags.golden) return run_golden(flags, all ? "" : filter);
  if (flags.commands) {
    fmt::print("{}", record_and_replay(*flags.commands, flags.suite));
    return kGood;
  }
  if (flags.list) {
    for (const Entry& e : entries(flags.selection)) fmt::print("{}\n", e.name());
    return kGood;
  }
  return run_suite({.suite = flags.suite,
                    .selection = flags.selection,
                    .all = all,
                    .paper = flags.paper,
                    .list_tests = flags.list_tests,
                    .format = table_format(flags.studies.format.value_or("text")),
                    .display = flags.format,
                    .out = flags.out,
                    .lcm = flags.lcm,
                    .lcm_log = flags.lcm_log});
}

// Google Benchmark takes its own flags out of what is left
struct Arguments {
  std::vector<std::string> texts;
  std::vector<char*> pointers;
  int count = 0;
};

Arguments take_benchmark_flags(int argc, char** argv, Flags& flags) {
  Arguments a{.texts = {argv, argv + argc}, .pointers = {}};
  flags.out = take_flag(a.texts, "--benchmark_out");
  flags.format = take_flag(a.texts, "--benchmark_format");
  flags.out_format = take_flag(a.texts, "--benchmark_out_format");
  bool help = false;
  for (std::string& text : a.texts) {
    help = help || text == "--help" || text == "-h";
    flags.list_tests = flags.list_tests || text.starts_with("--benchmark_list_tests");
    a.pointers.push_back(text.data());
  }
  a.count = static_cast<int>(a.pointers.size());
  a.pointers.push_back(nullptr);
  if (!help) benchmark::Initialize(&a.count, a.pointers.data());
  return a;
}

void add_selection_flags(CLI::App& app, Flags& flags) {
  app.add_option("--estimator", flags.selection.estimators,
                 "these alone, as NAME[:KEY=VALUE].., like mo2:bandwidth=50")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("SPEC,..");
  app.add_option("--detector", flags.selection.detectors, "these alone, like high_pass:w=60")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("SPEC,..");
}

void add_output_flags(CLI::App& app, Flags& flags) {
  app.add_option("--golden", flags.golden,
                 "instead: every metric for --seeds 1,2,.., as tauext-gate wants it")
      ->type_name("FILE");
  app.add_option("--seeds", flags.seeds)->delimiter(',')->group("");
  app.add_option("--commands", flags.commands)->group("");  // of an entry; tauext-gate explain
  app.add_option("--lcm", flags.lcm, "publish each entry's summary as it finishes")
      ->type_name("[URL]")
      ->expected(0, 1);
  app.add_option("--lcm-log", flags.lcm_log, "write each entry's samples and estimates as LCM log")
      ->type_name("DIR");
}

void add_flags(CLI::App& app, Flags& flags) {
  app.add_flag("--list", flags.list, "list the entries <robot>/<scenario>/<estimator>, and stop");
  app.add_flag("--list-metrics", flags.list_metrics, "say what each metric means, and stop");
  add_selection_flags(app, flags);
  app.add_flag("--paper", flags.paper,
               "print Table III of the paper beside ours, too, after wallmobot3/step");
  add_study_flags(app, flags.studies);
  add_output_flags(app, flags);
  app.add_option_function<std::string>(
         "--thresholds",
         [&](const std::string& path) { flags.suite.thresholds = read_thresholds(path); },
         "the detectors' thresholds, as tauext-detect --calibrate writes them")
      ->type_name("FILE");
  app.add_option("--noise_probe", flags.suite.noise_probe)->group("");  // bench/score/README.md
  add_recording_flags(app, flags.suite.sensors, flags.suite.model_error, flags.suite.recording);
  for (const char* less_used :
       {"--kp", "--kd", "--velocity_noise", "--loadcell", "--degrade", "--list-metrics"}) {
    app.get_option(less_used)->group("");
  }
}

}  // namespace

int bench_main(int argc, char** argv) {
  CLI::App app(
      "Scores every estimator on every scenario, then times its step, and prints a table.\n"
      "Exit code 1 if an entry failed. Google Benchmark's flags work, csv output excepted.\n\n"
      "  tauext-bench --benchmark_filter=step/ --benchmark_out=results.json\n",
      "tauext-bench");
  Flags flags;
  add_flags(app, flags);
  app.footer(
      "Of tauext-record: --loadcell --degrade --velocity_noise --kp --kd. Google Benchmark's:\n"
      "  --benchmark_filter=REGEX --benchmark_out=FILE (JSON) --benchmark_min_time=SECONDS\n"
      "  --benchmark_repetitions=N --benchmark_format=console|json");
  Arguments rest = take_benchmark_flags(argc, argv, flags);
  return run_program(app, rest.count, rest.pointers.data(), [&] {
    if (flags.out_format && *flags.out_format != "json") {
      throw std::invalid_argument(
          "--benchmark_out_format: json is the only format; rows have different counters");
    }
    return run(flags);
  });
}

}  // namespace tauext

// SPDX-License-Identifier: Apache-2.0
#include "bench/bench_main.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "bench/detect_main.h"
#include "bench/program/program.h"
#include "bench/report/page.h"
#include "bench/report/provenance.h"
#include "bench/roster/threshold_file.h"
#include "bench/run/commands.h"
#include "bench/run/recording_flags.h"
#include "bench/run/scenario_file.h"
#include "bench/run/study_flags.h"
#include "bench/run/suite_run.h"
#include "bench/score/entry.h"
#include "bench/score/suite.h"
#include "bench/score/table.h"
#include "bench/seeds/golden.h"
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
  std::string lock;
  std::optional<std::string> scenarios, out, out_format, format, golden, commands, report, lcm,
      lcm_log;
  std::string wrench;
  std::optional<std::string> seeds;
};

int run_golden(const Flags& f, const std::string& filter) {
  AtomicFile file(*f.golden);
  GoldenOptions o{.suite = f.suite, .selection = f.selection, .filter = filter};
  if (f.seeds) o.seeds = seeds_of(*f.seeds);
  o.built = build();
  Progress progress("scoring");
  o.progress = progress.callback();
  file.write(golden_metrics(o));
  file.commit();
  return kGood;
}

// a flag that the asked-for mode would not read is refused
void require_mode_of_flags(const CLI::App& app, const Flags& f, bool study, bool all) {
  const bool listing = f.list || f.list_metrics;
  const bool golden = f.golden.has_value(), commands = f.commands.has_value();
  if (study + f.list + f.list_metrics + golden + commands > 1) {
    throw std::invalid_argument(
        "one at a time: --list, --list-metrics, --golden, --commands, or a study (--seeds, "
        "--reliability, --equal-bandwidth, --pareto)");
  }
  const bool suite = !study && !listing && !golden && !commands;
  require_mode(app, suite, "the suite alone", {"--paper", "--report", "--lcm", "--lcm-log"});
  if (f.report) report::require_page(*f.report, "--report");
  if (f.report && f.report == f.out)
    throw std::invalid_argument(fmt::format(
        "--report and --benchmark_out both name {}; the page and the JSON need two files",
        *f.report));
  require_mode(app, f.report.has_value(), "--report", {"--wrench"});
  require_mode(app, suite || study, "the suite and the studies", {"--format"});
  const bool tuned = f.studies.equal_bandwidth || f.studies.pareto;
  const bool seeds = !f.studies.seeds.empty();
  const bool selects = suite || golden || f.list || seeds;
  require_mode(app, selects, "the suite, --seeds, --golden and --list", {"--detector"});
  require_mode(app, selects || (tuned && !f.studies.reliability),
               "the suite, --seeds, --golden, --list, --equal-bandwidth and --pareto",
               {"--estimator"});
  require_mode(app, seeds, "--seeds", {"--against"});
  require_mode(app, !golden && !seeds, "one seed, not with --seeds or --golden", {"--seed"});
  if (!suite && (f.out || f.format)) {
    throw std::invalid_argument(
        "--benchmark_out and --benchmark_format go with the suite alone; a study has --out and "
        "--format");
  }
  if (!all && !suite && !golden && !seeds) {
    throw std::invalid_argument(
        "--benchmark_filter goes with the suite, --seeds and --golden (there "
        "--benchmark_list_tests lists what it selects); leave it out here");
  }
}

int run(const CLI::App& app, Flags& flags) {
  std::optional<std::string>& name = flags.studies.robot;
  if (!name && !flags.lock.empty()) throw std::invalid_argument("--lock: of which --robot FILE?");
  if (!name && flags.scenarios) throw std::invalid_argument("--scenarios: of which --robot?");
  if (name) {
    name = with_lock(*name, flags.lock);
    flags.selection.robot = &robot(*name);
    if (flags.scenarios) add_scenarios(*flags.scenarios, *flags.selection.robot);
  }
  const std::string filter = benchmark::GetBenchmarkFilter();
  const bool all = filter.empty() || filter == "." || filter == "all";
  const std::string pattern = filter.starts_with('-') ? filter.substr(1) : filter;
  if (const std::string trouble = regular_expression(pattern); !trouble.empty())
    throw std::invalid_argument(fmt::format("--benchmark_filter={}: {}", filter, trouble));
  if (flags.seeds && !flags.golden) flags.studies.seeds = seeds_of(*flags.seeds);
  const bool study = wants_study(flags.studies);
  require_mode_of_flags(app, flags, study, all);
  if (flags.lcm_log == "")
    throw std::invalid_argument("--lcm-log: the name of a folder is missing");
  if (flags.list_metrics) {
    fmt::print("{}", list_of_metrics());
    return kGood;
  }
  if (study) {
    flags.studies.selection = flags.selection;
    flags.studies.filter = all ? "" : filter;
    return run_study(flags.studies, flags.suite);
  }
  if (flags.golden) return run_golden(flags, all ? "" : filter);
  if (flags.commands) {
    fmt::print("{}", record_and_replay(*flags.commands, flags.suite, flags.selection));
    return kGood;
  }
  if (flags.list) {
    for (const Entry& e : entries(flags.selection)) fmt::print("{}\n", e.name());
    fmt::print("\n{}", list_fields(flags.selection.robot));
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
                    .report = flags.report,
                    .wrench = flags.wrench,
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
  const auto given = [&](std::string_view flag) {
    return std::any_of(a.texts.begin(), a.texts.end(),
                       [&](const std::string& text) { return text.starts_with(flag); });
  };
  const bool help = given("--help") || given("-h");
  if (!help && !given("--benchmark_min_time"))  // its own 0.5 s would be minutes
    a.texts.insert(a.texts.begin() + 1, "--benchmark_min_time=0.05");
  for (std::string& text : a.texts) {
    flags.list_tests = flags.list_tests || text.starts_with("--benchmark_list_tests");
    a.pointers.push_back(text.data());
  }
  a.count = static_cast<int>(a.pointers.size());
  a.pointers.push_back(nullptr);
  if (!help) benchmark::Initialize(&a.count, a.pointers.data());
  return a;
}

// Google Benchmark has taken its own flags out: what still begins so is wrong
void refuse_unknown_benchmark_flags(const Arguments& rest) {
  for (int i = 1; i < rest.count; ++i) {
    const std::string_view flag = rest.pointers[i];
    if (!flag.starts_with("--benchmark_")) continue;
    throw std::invalid_argument(fmt::format(
        "{}: {}", flag,
        flag.starts_with("--benchmark_context=")
            ? "write KEY=VALUE,KEY=VALUE; a value cannot contain a comma"
            : "Google Benchmark does not know this flag, or not with this value; see --help"));
  }
}

void add_selection_flags(CLI::App& app, Flags& flags) {
  app.add_option("--robot", flags.studies.robot,
                 "only this one, or that of an MJCF or URDF file (with --lock REGEX)")
      ->type_name("NAME|FILE");
  app.add_option("--lock", flags.lock)->group("")->check(not_empty);
  app.add_option("--scenarios", flags.scenarios)->group("");
  app.add_option("--estimator", flags.selection.estimators,
                 "run only these, as NAME[:KEY=VALUE].., like mo2:bandwidth=50")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("SPEC,..");
  app.add_option("--detector", flags.selection.detectors, "run only these, like high_pass:w=60")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("SPEC,..");
}

void add_output_flags(CLI::App& app, Flags& flags) {
  app.add_option("--golden", flags.golden,
                 "write every metric of --seeds 1,2,.. for tauext-gate, and stop")
      ->type_name("FILE");
  app.add_option("--seeds", flags.seeds,
                 "study instead: means and intervals over these (--against mo2)")
      ->type_name("1-30");
  app.add_option("--against", flags.studies.against)->group("");
  app.add_option("--commands", flags.commands)->group("");  // of an entry; tauext-gate explain
  app.add_option("--report", flags.report,
                 "a page for a browser, with traces; --wrench SITE adds forces")
      ->type_name("FILE.html");
  app.add_option("--wrench", flags.wrench)->group("")->check(not_empty);
  app.add_option("--lcm", flags.lcm, "publish each entry's summary as it finishes")
      ->type_name("[URL]")
      ->expected(0, 1);
  app.add_option("--lcm-log", flags.lcm_log, "write each entry's samples and estimates as LCM log")
      ->type_name("DIR");
}

void add_flags(CLI::App& app, Flags& flags) {
  app.add_flag("--list", flags.list, "list the entries and the keys of specifications, and stop");
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
  for (const char* less_used : {"--kp", "--kd", "--velocity_noise", "--loadcell", "--degrade",
                                "--list-metrics", "--lcm-log", "--golden", "--paper"}) {
    app.get_option(less_used)->group("");
  }
}

}  // namespace

int bench_main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "detect") return detect_main(argc - 1, argv + 1);
  CLI::App app(
      "Scores every estimator on every scenario, then times its step, and prints a table.\n"
      "Exit code 1 if an entry failed. Google Benchmark's flags work, csv output excepted.\n\n"
      "  tauext-bench --benchmark_filter=step/ --benchmark_out=results.json\n",
      "tauext-bench");
  Flags flags;
  add_flags(app, flags);
  app.footer(
      "Of tauext-record: --scenarios --loadcell --degrade --velocity_noise --kp --kd. Google "
      "Benchmark's:\n"
      "  --benchmark_filter=REGEX --benchmark_out=FILE (JSON) --benchmark_min_time=0.05\n"
      "  --benchmark_repetitions=N --benchmark_format=console|json");
  Arguments rest = take_benchmark_flags(argc, argv, flags);
  app.preparse_callback([&](std::size_t) { refuse_unknown_benchmark_flags(rest); });
  return run_program(app, rest.count, rest.pointers.data(), [&] {
    if (flags.out_format && *flags.out_format != "json") {
      throw std::invalid_argument(
          "--benchmark_out_format: json is the only format; rows have different counters");
    }
    return run(app, flags);
  });
}

}  // namespace tauext

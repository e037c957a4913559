// SPDX-License-Identifier: Apache-2.0
#include "bench/bench_main.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
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
#include "bench/run/recording_flags.h"
#include "bench/run/scenario_file.h"
#include "bench/run/study_flags.h"
#include "bench/run/suite/benchmark_flags.h"
#include "bench/run/suite_outputs.h"
#include "bench/score/entry.h"
#include "bench/score/suite.h"
#include "bench/score/table.h"
#include "bench/seeds/golden.h"
#include "mjcf/trace/atomic_file.h"

namespace tauext {
namespace {

struct Flags {
  SuiteOptions suite;
  Selection selection;
  StudyFlags studies;  // what runs instead of the suite; its format is that of all tables
  SuiteOutputs outputs;
  bool list = false, list_metrics = false;
  std::string lock;
  std::optional<std::string> scenarios, golden, seeds;
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
void require_mode_of_flags(const CLI::App& app, const Flags& f, const BenchmarkFlags& benchmark,
                           bool study) {
  const std::optional<std::string>& report = f.outputs.report;
  const bool listing = f.list || f.list_metrics;
  const bool golden = f.golden.has_value();
  if (study + f.list + f.list_metrics + golden > 1) {
    throw std::invalid_argument(
        "one at a time: --list, --list-metrics, --golden, or a study (--seeds, "
        "--equal-bandwidth, --pareto)");
  }
  const bool suite = !study && !listing && !golden;
  require_mode(app, suite, "the suite alone", {"--paper", "--report", "--lcm", "--lcm-log"});
  if (report) report::require_page(*report, "--report");
  if (report && report == benchmark.out())
    throw std::invalid_argument(fmt::format(
        "--report and --benchmark_out both name {}; the page and the JSON need two files",
        *report));
  require_mode(app, report.has_value(), "--report", {"--wrench"});
  require_mode(app, suite || study, "the suite and the studies", {"--format"});
  const bool tuned = f.studies.equal_bandwidth || f.studies.pareto;
  const bool seeds = !f.studies.seeds.empty();
  const bool selects = suite || golden || f.list || seeds;
  require_mode(app, selects, "the suite, --seeds, --golden and --list", {"--detector"});
  require_mode(app, selects || tuned,
               "the suite, --seeds, --golden, --list, --equal-bandwidth and --pareto",
               {"--estimator"});
  require_mode(app, seeds, "--seeds", {"--against"});
  require_mode(app, !golden && !seeds, "one seed, not with --seeds or --golden", {"--seed"});
  if (!suite && (benchmark.out() || benchmark.format())) {
    throw std::invalid_argument(
        "--benchmark_out and --benchmark_format go with the suite alone; a study has --out and "
        "--format");
  }
  if (!benchmark.filter().empty() && !suite && !golden && !seeds) {
    throw std::invalid_argument(
        "--benchmark_filter goes with the suite, --seeds and --golden (there "
        "--benchmark_list_tests lists what it selects); leave it out here");
  }
}

int run(const CLI::App& app, Flags& flags, const BenchmarkFlags& benchmark) {
  std::optional<std::string>& name = flags.studies.robot;
  if (!name && !flags.lock.empty()) throw std::invalid_argument("--lock: of which --robot FILE?");
  if (!name && flags.scenarios) throw std::invalid_argument("--scenarios: of which --robot?");
  if (name) {
    name = with_lock(*name, flags.lock);
    flags.selection.robot = &robot(*name);
    if (flags.scenarios) add_scenarios(*flags.scenarios, *flags.selection.robot);
  }
  const std::string filter = benchmark.filter();
  if (flags.seeds && !flags.golden) flags.studies.seeds = seeds_of(*flags.seeds);
  const bool study = wants_study(flags.studies);
  require_mode_of_flags(app, flags, benchmark, study);
  if (flags.outputs.lcm_log == "")
    throw std::invalid_argument("--lcm-log: the name of a folder is missing");
  if (flags.list_metrics) {
    fmt::print("{}", list_of_metrics());
    return kGood;
  }
  if (study) {
    flags.studies.selection = flags.selection;
    flags.studies.filter = filter;
    return run_study(flags.studies, flags.suite);
  }
  if (flags.golden) return run_golden(flags, filter);
  if (flags.list) {
    for (const Entry& e : entries(flags.selection)) fmt::print("{}\n", e.name());
    fmt::print("\n{}", list_fields(flags.selection.robot));
    return kGood;
  }
  SuiteRun suite{.suite = flags.suite,
                 .selection = flags.selection,
                 .format = table_format(flags.studies.format.value_or("text"))};
  benchmark.put(suite);
  return run_suite_with_outputs(suite, flags.outputs);
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
  app.add_option("--report", flags.outputs.report,
                 "a page for a browser, with traces; --wrench SITE adds forces")
      ->type_name("FILE.html");
  app.add_option("--wrench", flags.outputs.wrench)->group("")->check(not_empty);
  app.add_option("--lcm", flags.outputs.lcm, "publish each entry's summary as it finishes")
      ->type_name("[URL]")
      ->expected(0, 1);
  app.add_option("--lcm-log", flags.outputs.lcm_log,
                 "write each entry's samples and estimates as LCM log")
      ->type_name("DIR");
}

void add_flags(CLI::App& app, Flags& flags) {
  app.add_flag("--list", flags.list, "list the entries and the keys of specifications, and stop");
  app.add_flag("--list-metrics", flags.list_metrics, "say what each metric means, and stop");
  add_selection_flags(app, flags);
  app.add_flag("--paper", flags.outputs.paper,
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
  app.footer(std::string("Of tauext-record: --scenarios --loadcell --degrade --velocity_noise --kp "
                         "--kd. Google Benchmark's:\n") +
             kBenchmarkHelp);
  BenchmarkFlags benchmark(argc, argv);
  app.preparse_callback([&](std::size_t) { benchmark.require_known(); });
  return run_program(app, benchmark.argc(), benchmark.argv(), [&] {
    benchmark.require_values();
    return run(app, flags, benchmark);
  });
}

}  // namespace tauext

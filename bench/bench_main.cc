// SPDX-License-Identifier: Apache-2.0
#include "bench/bench_main.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "bench/detect_main.h"
#include "bench/live/entry_tap.h"
#include "bench/program/program.h"
#include "bench/report/page.h"
#include "bench/report/provenance.h"
#include "bench/report/traces.h"
#include "bench/roster/threshold_file.h"
#include "bench/run/recording_flags.h"
#include "bench/run/scenario_file.h"
#include "bench/run/study_flags.h"
#include "bench/run/suite/benchmark_flags.h"
#include "bench/run/suite/suite_run.h"
#include "bench/score/entry.h"
#include "bench/score/suite.h"
#include "bench/score/table.h"
#include "bench/seeds/golden.h"
#include "bench/study/table3.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/printable.h"

namespace tauext {
namespace {

// what a run of the suite leaves beside its tables and its JSON
struct SuiteOutputs {
  bool paper = false;                  // whether Table III is printed beside ours
  std::optional<std::string> report;   // file for the page of the results
  std::string wrench;                  // the point of which it shows forces; "": none
  std::optional<std::string> lcm;      // URL for summaries
  std::optional<std::string> lcm_log;  // folder for logs
};

struct Flags {
  SuiteOptions suite;
  Selection selection;
  StudyFlags studies;  // what runs instead of the suite; its format is that of all tables
  SuiteOutputs outputs;
  bool list = false, list_metrics = false;
  std::string lock;
  std::optional<std::string> robot, scenarios, golden, seeds;
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

using Rows = std::vector<Row>;
using Forces = std::map<std::string, std::unique_ptr<const ArmForces>>;  // by robot

// of all that are selected
Forces forces_of(const std::string& wrench, const Rows& rows) {
  Forces all;
  for (const Row& row : rows) {
    const Robot& r = row.entry.robot();
    auto& of_robot = all[r.name()];
    if (wrench.empty() || of_robot) continue;
    try {
      of_robot = r.forces_at(wrench, r.dof() >= kJointsOfMoment);
    } catch (const std::invalid_argument& e) {
      throw std::invalid_argument(
          fmt::format("--wrench: {}: {} (--robot selects one)", r.name(), e.what()));
    }
  }
  return all;
}

void print_table3(const SuiteResults& results) {
  const bool step = std::any_of(results.rows.begin(), results.rows.end(), [](const Row& r) {
    return r.entry.group() == "wallmobot3/step";  // what Table III is about
  });
  if (step) fmt::print(results.words, "\n{}", study::format_table3());
}

void write_report(const SuiteOutputs& outputs, const SuiteResults& results, const Forces& forces) {
  Progress progress("drawing");
  report::Traces traces(outputs.wrench);
  const Rows& rows = results.rows;
  for (const Row& row : rows) {
    if (row.score.error.empty())
      traces.add(row.entry, results.suite.run(row.entry),
                 forces.at(row.entry.robot().name()).get());
    progress.show(static_cast<double>(&row - rows.data()) / static_cast<double>(rows.size()));
  }
  AtomicFile file(*outputs.report);
  file.write(report::page_of({checked_result(report::kOwnResults, results.json),
                              checked_result(report::kOwnTraces, traces.json(results.line))}));
  file.commit();
  progress.clear();
  fmt::print(results.words, "\n{}: the report; open it in a browser\n", *outputs.report);
}

// run_suite(), with these; returns the exit code
int run_suite_with_outputs(const SuiteRun& run, const SuiteOutputs& outputs) {
  bool ran = false;
  Forces forces;
  std::optional<EntryTap> tap;
  SuiteHooks hooks;
  hooks.begin = [&](const Rows& rows) {
    if (outputs.report) AtomicFile{*outputs.report};  // an unwritable path should not cost a run
    forces = forces_of(outputs.wrench, rows);
    tap.emplace(outputs.lcm, outputs.lcm_log.value_or(""));
  };
  if (outputs.lcm_log)
    hooks.scored = [&](const Row& row, const Suite::Run& of) {
      tap->log(row.entry, of, row.score);
    };
  hooks.through = [&](const Row& row) { tap->publish(row.entry, row.score); };
  hooks.printed = [&](const SuiteResults& results) {
    ran = true;
    if (outputs.paper) print_table3(results);
  };
  if (outputs.report)
    hooks.written = [&](const SuiteResults& results) { write_report(outputs, results, forces); };
  const int code = run_suite(run, hooks);
  if (!ran || tap->heard()) return code;
  say("no summary could be published");
  return kAnswerIsNo;
}

int run(const CLI::App& app, Flags& flags, const BenchmarkFlags& benchmark) {
  if (!flags.robot && !flags.lock.empty())
    throw std::invalid_argument("--lock: of which --robot FILE?");
  if (!flags.robot && flags.scenarios)
    throw std::invalid_argument("--scenarios: of which --robot?");
  if (flags.robot) {
    flags.selection.robot = &robot(*flags.robot, flags.lock);
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
  app.add_option("--robot", flags.robot,
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

// SPDX-License-Identifier: Apache-2.0
#include "bench/run/study_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <stdexcept>
#include <vector>

#include "bench/program/program.h"
#include "bench/report/provenance.h"
#include "bench/roster/robots.h"
#include "bench/score/degradation.h"
#include "bench/seeds/golden.h"
#include "bench/seeds/seed_tables.h"
#include "bench/seeds/seeds.h"
#include "bench/study/equal_bandwidth.h"
#include "bench/study/pareto.h"
#include "mjcf/trace/atomic_file.h"
#include "mjcf/trace/text.h"

namespace tauext {
namespace {

TableFormat format_of(const StudyFlags& f) {
  return table_format(f.format.value_or("text"));
}

const Robot& robot_of(const StudyFlags& f) {
  return *robots_of(f.selection).front();
}

// a file of JSON is one for tauext-report, with where it comes from
std::string for_file(const StudyFlags& f, const char* format, const std::string& run,
                     const std::string& table) {
  return f.out && format_of(f) == TableFormat::kJson ? result_file(format, run, table) : table;
}

std::string run_equal_bandwidth(const StudyFlags& f) {
  Progress progress("tuning");
  const double w = *f.equal_bandwidth;
  const auto rows =
      study::at_equal_bandwidth(robot_of(f), w, 0, progress.callback(), f.selection.estimators);
  return for_file(f, "tauext-equal-bandwidth-1",
                  fmt::format("{} at {:g} rad/s", robot_of(f).label(), w),
                  study::format_equal_bandwidth(robot_of(f), w, rows, format_of(f)));
}

std::string run_pareto(const StudyFlags& f) {
  Progress progress("sweeping");
  const auto points = study::pareto(robot_of(f), 0, progress.callback(), f.selection.estimators);
  return for_file(f, "tauext-pareto-1", robot_of(f).label(),
                  study::format_pareto(robot_of(f), points, format_of(f)));
}

std::vector<Entry> chosen_entries(const StudyFlags& f) {
  const auto wanted = entry_filter(f.filter);
  std::vector<Entry> all = entries(f.selection);
  std::erase_if(all, [&](const Entry& e) { return !wanted(e.name()); });
  if (all.empty()) fail_no_match(f.filter);
  return all;
}

std::string run_seeds(const StudyFlags& f, const SuiteOptions& suite) {
  SeedOptions o{.suite = suite, .entries = chosen_entries(f), .seeds = f.seeds};
  const bool there = std::any_of(o.entries.begin(), o.entries.end(), [&](const Entry& e) {
    return e.estimator() == f.against || e.estimator() + "+" + e.detector() == f.against;
  });
  if (!there && f.against != StudyFlags().against)
    throw std::invalid_argument(
        fmt::format("--against {}: no entry that runs is called so", f.against));
  if (o.suite.sensors.ideal()) o.suite.sensors = golden_sensors();
  Progress progress("scoring");
  o.progress = progress.callback();
  const std::vector<SeededRow> rows = score_over_seeds(o);
  const TableFormat format = format_of(f);
  const std::string table = format_seeds(rows, f.against, format);
  const std::string degraded =
      describe({o.suite.sensors, o.suite.model_error, o.suite.recording.drives});
  if (format == TableFormat::kText) return fmt::format("sensors: {}\n\n{}", degraded, table);
  return for_file(f, "tauext-seeds-1",
                  fmt::format("{} seeds from {}, {}", f.seeds.size(), f.seeds[0], degraded), table);
}

// one, or the ends of a range
void add_seeds(std::string_view part, const char* flag, std::vector<std::uint64_t>& to) {
  constexpr std::size_t kMost = 10'000;
  const std::size_t dash = part.find('-');
  const std::string_view first = part.substr(0, dash),
                         last = dash == part.npos ? first : part.substr(dash + 1);
  const auto from = number_in<std::uint64_t>(first), until = number_in<std::uint64_t>(last);
  if (!from || !until)
    throw std::invalid_argument(
        fmt::format("{}: '{}' is no seed, nor a range like 1-30", flag, part));
  if (*until < *from)
    throw std::invalid_argument(fmt::format("{}: '{}' ends before it begins; {}-{} has these seeds",
                                            flag, part, last, first));
  if (*until - *from >= kMost || to.size() + (*until - *from) >= kMost)
    throw std::invalid_argument(
        fmt::format("{}: with '{}' they are more than {}; take fewer", flag, part, kMost));
  for (std::uint64_t n = 0; n <= *until - *from; ++n) to.push_back(*from + n);
}

}  // namespace

std::vector<std::uint64_t> seeds_of(const std::string& text, const char* flag) {
  std::vector<std::uint64_t> all;
  for (const std::string_view part : split(text, ',')) add_seeds(part, flag, all);
  std::vector<std::uint64_t> sorted = all;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
    throw std::invalid_argument(fmt::format("{} {}: one is there twice", flag, text));
  return all;
}

void add_study_flags(CLI::App& app, StudyFlags& f) {
  app.add_option("--equal-bandwidth", f.equal_bandwidth,
                 "study instead: every estimator at so many rad/s, 1 to 200")
      ->type_name("W");
  app.add_flag("--pareto", f.pareto, "study instead: noise against delay (all of them: --out)");
  app.add_option("--format", f.format, "of the tables: text, csv, json, md or latex")
      ->type_name("NAME");
  app.add_option("--out", f.out)->group("");  // the help fits a screen: bench/study/README.md
}

bool wants_study(const StudyFlags& f) {
  if (f.studies() == 0 && f.out) {
    throw std::invalid_argument(
        "--out goes with --seeds, --equal-bandwidth or --pareto; the suite has "
        "--benchmark_out=FILE and --report FILE.html");
  }
  if (format_of(f) != TableFormat::kText && f.studies() > 1) {
    throw std::invalid_argument(
        fmt::format("--format {} holds one study: ask for one at a time", *f.format));
  }
  return f.studies() > 0;
}

int run_study(const StudyFlags& f, const SuiteOptions& suite) {
  const bool others = f.equal_bandwidth || f.pareto;
  if (others && !suite.model_error.none()) {
    throw std::invalid_argument("a study brings its own model errors, or none: no --model_error");
  }
  const bool seed = suite.sensors.seed != Sensors().seed;
  if ((seed || !suite.sensors.ideal()) && others) {
    throw std::invalid_argument(
        "--equal-bandwidth and --pareto bring their own sensors: they take no faults and no "
        "--seed");
  }
  const Recording& r = suite.recording;
  if (others && (!suite.thresholds.sets.empty() || r.Kp || r.Kd || r.drives != Drives())) {
    throw std::invalid_argument("a study takes no --thresholds, --drives, --kp and --kd");
  }
  AtomicFile file(f.out.value_or("-"));  // an unwritable path should not cost a run
  if (!f.seeds.empty()) file.write(run_seeds(f, suite));
  if (f.equal_bandwidth) file.write(run_equal_bandwidth(f));
  if (f.pareto) file.write(run_pareto(f));
  file.commit();
  return kGood;
}

}  // namespace tauext

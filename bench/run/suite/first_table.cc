// SPDX-License-Identifier: Apache-2.0
// What ci/bench prints first: the suite of tauext-bench, with Google Benchmark's flags alone. It
// compiles in a third of the time of tauext-bench.
#include <CLI/CLI.hpp>
#include <memory>
#include <stdexcept>
#include <string>

#include "bench/program/program.h"
#include "bench/roster/tree_robot.h"
#include "bench/run/suite/benchmark_flags.h"
#include "bench/run/suite/suite_run.h"

std::unique_ptr<const tauext::Robot> tauext::detail::tree_robot(int, const std::string&,
                                                                const Model&) {
  throw std::invalid_argument("tauext-first-table is without robots from files: tauext-bench");
}

int main(int argc, char** argv) {
  tauext::BenchmarkFlags flags(argc, argv);
  CLI::App app(
      "Scores and times every estimator, and prints a table: tauext-bench, with Google Benchmark's "
      "flags alone.",
      "tauext-first-table");
  app.footer(std::string("Google Benchmark's flags:\n") + tauext::kBenchmarkHelp);
  app.preparse_callback([&](std::size_t) { flags.require_known(); });
  return tauext::run_program(app, flags.argc(), flags.argv(), [&] {
    flags.require_values();
    tauext::SuiteRun run;
    flags.put(run);
    return run_suite(run);
  });
}

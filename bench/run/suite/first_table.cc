// SPDX-License-Identifier: Apache-2.0
// What ci/bench prints first: the suite of tauext-bench, with Google Benchmark's flags alone. It
// links a third of what tauext-bench does, so that nobody waits for the rest to compile.
#include <CLI/CLI.hpp>

#include "bench/program/program.h"
#include "bench/run/suite/benchmark_flags.h"
#include "bench/run/suite/suite_run.h"

int main(int argc, char** argv) {
  tauext::BenchmarkFlags flags(argc, argv);
  CLI::App app(
      "Scores and times every estimator, and prints a table: tauext-bench, with Google Benchmark's "
      "flags alone.",
      "tauext-first-table");
  app.preparse_callback([&](std::size_t) { flags.require_known(); });
  return tauext::run_program(app, flags.argc(), flags.argv(), [&] {
    tauext::SuiteRun run;
    flags.put(run);
    return run_suite(run);
  });
}

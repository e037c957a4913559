// SPDX-License-Identifier: Apache-2.0
/// @file
/// Takes Google Benchmark's results: progress to a terminal, times for the table, valid JSON.
#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <map>
#include <sstream>
#include <string>

#include "bench/program/program.h"

namespace tauext {

/// Whether Google Benchmark is 1.7. What 1.8 calls a run's `skipped` is `error_occurred` there, and
/// it refuses the "s" of --benchmark_min_time without which 1.8 warns once a row.
template <class Run = benchmark::BenchmarkReporter::Run>
inline constexpr bool kBenchmark17 = requires(Run run) {
  run.error_occurred;
};

/// A display reporter that also builds the JSON of --benchmark_out. Google Benchmark writes a bare
/// NaN, which is no JSON, for a counter without a value; here such a counter is left out.
class Reporter : public benchmark::BenchmarkReporter {
 public:
  /// @param display prints to standard output; nullptr for none
  /// @param total number of benchmarks, 0 if it is not known
  Reporter(benchmark::BenchmarkReporter* display, int total);

  bool ReportContext(const Context& context) override;
  void ReportRuns(const std::vector<Run>& runs) override;
  void Finalize() override;

  /// The whole document; valid once all benchmarks are done.
  std::string json() const { return json_text_.str(); }

  bool any_error() const { return any_error_; }

  /// [ns] CPU time of a step by benchmark name: the median if there are repetitions.
  const std::map<std::string, double>& cpu_ns() const { return cpu_ns_; }

  /// Called with the name of each benchmark that is through, its repetitions included.
  std::function<void(const std::string&)> on_done;

 private:
  benchmark::BenchmarkReporter* display_;
  benchmark::JSONReporter json_;
  std::ostringstream json_text_;
  std::map<std::string, double> cpu_ns_;
  Progress progress_{""};
  bool any_error_ = false;
  int done_ = 0, total_;
};

}  // namespace tauext

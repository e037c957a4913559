// SPDX-License-Identifier: Apache-2.0
#include "bench/run/suite/reporter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace tauext::test {
namespace {

using Result = benchmark::BenchmarkReporter::Run;

Result run_of(const char* name, double cpu_ns) {
  Result r;
  r.run_name.function_name = name;
  r.run_type = Result::RT_Iteration;
  r.iterations = 10;
  r.counters["cpu_ns"] = benchmark::Counter(cpu_ns);
  return r;
}

TEST(Reporter, ItsJsonIsValidWhateverTheCountersHold) {
  benchmark::RegisterBenchmark("a/b/odd", [](benchmark::State& state) {
    for ([[maybe_unused]] auto _ : state) continue;
    state.counters["cpu_ns"] = 3;
    state.counters["cv"] = std::nan("");
    state.counters["settling_s"] = -INFINITY;
  })->Iterations(10);
  benchmark::RegisterBenchmark(
      "a/b/failed", [](benchmark::State& state) { state.SkipWithError("wrong \"answer\""); });
  Reporter reporter(nullptr, 2);
  benchmark::RunSpecifiedBenchmarks(&reporter, "a/b/.*");
  const auto json = nlohmann::json::parse(reporter.json());  // throws on a bare NaN
  ASSERT_EQ(json["benchmarks"].size(), 2u);
  EXPECT_EQ(json["benchmarks"][0]["cpu_ns"], 3);
  EXPECT_FALSE(json["benchmarks"][0].contains("cv"));
  EXPECT_EQ(json["benchmarks"][1]["error_occurred"], true);
  EXPECT_TRUE(reporter.any_error());
}

TEST(Reporter, TakesTheMedianOfRepetitions) {
  Reporter reporter(nullptr, 1);
  reporter.ReportContext({});
  Result median = run_of("a/b/c", 20);
  median.run_type = Result::RT_Aggregate;
  median.aggregate_name = "median";
  Result deviation = run_of("a/b/c", 5);
  deviation.run_type = Result::RT_Aggregate;
  deviation.aggregate_name = "stddev";
  reporter.ReportRuns({run_of("a/b/c", 10), run_of("a/b/c", 90), median, deviation});
  EXPECT_EQ(reporter.cpu_ns().at("a/b/c"), 20);
  EXPECT_FALSE(reporter.any_error());
}

}  // namespace
}  // namespace tauext::test

// SPDX-License-Identifier: Apache-2.0
#include "regression/report/report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "regression/accept.h"
#include "regression/report/findings.h"

namespace tauext::gate {
namespace {

KernelTime kernel(const std::string& name, double ratio, Verdict verdict) {
  KernelTime k{.kernel = name, .base_ns = 100, .head_ns = 100 * ratio};
  k.verdict = {.verdict = verdict, .ratio = ratio, .low = ratio - 0.001, .high = ratio + 0.001};
  k.verdict.layouts = verdict == Verdict::kIdentical ? 0 : 8;
  k.processes = {{.kernel = name, .base_ns = 100, .head_ns = 100 * ratio},
                 {.kernel = name, .base_ns = 101, .head_ns = 101 * ratio}};
  return k;
}

GateResult times(std::vector<KernelTime> kernels) {
  GateResult r{.base = "base.so", .head = "head.so", .bench = "tauext-bench"};
  r.time = TimeReport{.kernels = std::move(kernels)};
  return r;
}

GateResult metric(Change change) {
  GateResult r{.base = "base.so", .head = "head.so", .bench = "tauext-bench"};
  r.accuracy = AccuracyReport{.lines = 1};
  r.accuracy->changes.push_back({.entry = "arm/step/a+b",
                                 .metric = "rmse_Nm",
                                 .change = change,
                                 .before = 1,
                                 .after = 1.1,
                                 .standard_errors = 44,
                                 .worst_seed = "seed 3",
                                 .largest_error_at = "5.004"});
  return r;
}

TEST(ExitCode, IsThatOfTheWorstFinding) {
  EXPECT_EQ(exit_code(times({kernel("a", 1, Verdict::kPass)})), kGood);
  EXPECT_EQ(exit_code(times({kernel("a", 1, Verdict::kIdentical)})), kGood);
  EXPECT_EQ(exit_code(times({kernel("a", 1.1, Verdict::kFail)})), kSlower);
  EXPECT_EQ(exit_code(times({kernel("a", 1, Verdict::kInconclusive)})), kInconclusive);
  EXPECT_EQ(exit_code(metric(Change::kWorse)), kLessAccurate);
  for (const Change c : {Change::kBetter, Change::kChanged, Change::kNew, Change::kGone}) {
    EXPECT_EQ(exit_code(metric(c)), kUpdateNeeded);
  }
  GateResult both = metric(Change::kWorse);
  both.time = TimeReport{.kernels = {kernel("a", 1.1, Verdict::kFail)}};
  EXPECT_EQ(exit_code(both), kSlower);
  both.accuracy->not_repeated = {"x"};
  EXPECT_EQ(exit_code(both), kCouldNotRun);
  GateResult budget = times({kernel("a", 1, Verdict::kPass)});
  budget.time->kernels[0].over_budget = true;
  EXPECT_EQ(exit_code(budget), kSlower);
  GateResult blind = times({kernel("a", 1, Verdict::kInconclusive)});
  blind.time->kernels[0].verdict.harness_error = true;
  EXPECT_EQ(exit_code(blind), kCouldNotRun);
}

TEST(Acceptable, IsWhatComesAtSomeSeedsAloneAndChanged) {
  GateResult r = metric(Change::kWorse);
  MetricChange never = r.accuracy->changes.front();
  never.metric = "settling_s", never.change = Change::kChanged;
  never.before = never.after = std::numeric_limits<double>::quiet_NaN();
  r.accuracy->changes.push_back(never);
  const std::vector<Acceptance> all = acceptable(r, "abc", "calmer");
  ASSERT_EQ(all.size(), 2u);
  accept(all, "abc", r);
  EXPECT_EQ(exit_code(r), kGood) << "one that is left would want an update";
}

TEST(ExitCode, OfInstructions) {
  GateResult r;
  r.instructions = InstructionReport{.kernels = 1};
  EXPECT_EQ(exit_code(r), kGood);
  r.instructions->beside_committed = {{.kernel = "a", .before = 1000, .after = 1005}};
  EXPECT_EQ(exit_code(r), kGood) << "below the limit";
  r.instructions->no_baseline = "none";
  EXPECT_EQ(exit_code(r), kUpdateNeeded);
  r.instructions->beside_base = {{.kernel = "a", .before = 1000, .after = 1020}};
  EXPECT_EQ(exit_code(r), kSlower);
}

TEST(Terminal, FitsOnAScreenWhenAllIsWell) {
  std::vector<KernelTime> many;
  for (int i = 0; i < 60; ++i)
    many.push_back(kernel("arm/k" + std::to_string(i), 1, Verdict::kPass));
  const std::string text = format_terminal(times(many), false);
  EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 24) << text;
  EXPECT_NE(text.find("60 kernels, 60 ok"), std::string::npos) << text;
  EXPECT_NE(text.find("(-0.10 to +0.10)"), std::string::npos) << "an interval: " << text;
}

TEST(Terminal, SaysWhyAKernelIsSlower) {
  GateResult r = times({kernel("arm/ekf", 1.1, Verdict::kFail)});
  EXPECT_NE(format_terminal(r, false).find("whether by more work or by waiting"), std::string::npos)
      << "nothing was counted";
  r.instructions = InstructionReport{.kernels = 1};
  r.instructions->base = Counts{.kernels = {{"arm/ekf", 1000}}};
  EXPECT_NE(format_terminal(r, false).find("the same work, but slower"), std::string::npos);
  r.instructions->beside_base = {
      {.kernel = "arm/ekf", .before = 1000, .after = 1100, .gained = {"+0.1 a step in f"}}};
  const std::string text = format_terminal(r, false);
  EXPECT_NE(text.find("more work: +10.0 % instructions"), std::string::npos) << text;
  EXPECT_NE(text.find("+0.1 a step in f"), std::string::npos) << text;
  EXPECT_NE(text.find("--base base.so --head head.so --kernels '^arm/ekf$'"), std::string::npos)
      << text;
  r.time->kernels[0] = kernel("arm/ekf", 1, Verdict::kPass);
  EXPECT_NE(format_terminal(r, true).find("more instructions at no cost in time"),
            std::string::npos);
}

TEST(Terminal, NamesSeedSampleAndCommandOfALossInAccuracy) {
  const std::string text = format_terminal(metric(Change::kWorse), false);
  for (const char* part :
       {"arm/step/a+b rmse_Nm  1 -> 1.1 (+10 %)  LESS ACCURATE", "worst: seed 3", "t = 5.004 s",
        "tauext-bench --golden - --seeds 3 --benchmark_filter='^arm/step/a[+]b$'"}) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  }
}

TEST(Terminal, SaysThatAKernelStalls) {
  GateResult r = times({kernel("arm/ekf", 1, Verdict::kPass)});
  r.time->kernels[0].life = {.kernel = "arm/ekf", .worst_ratio = 100, .worst_more_ns = 1e6};
  EXPECT_EQ(exit_code(r), kSlower);
  EXPECT_NE(format_terminal(r, false).find("stalls: "), std::string::npos);
  EXPECT_NE(format_terminal(r, true).find("A longer run"), std::string::npos);
}

TEST(JUnit, CountsAndEscapes) {
  GateResult r =
      times({kernel("a<b>&\"c\"", 1.1, Verdict::kFail), kernel("d", 1, Verdict::kInconclusive)});
  const std::string text = format_junit(r);
  EXPECT_NE(text.find("tests=\"2\" failures=\"1\" skipped=\"1\""), std::string::npos) << text;
  EXPECT_NE(text.find("name=\"a&lt;b&gt;&amp;&quot;c&quot;\""), std::string::npos) << text;
}

TEST(JUnit, AHarnessErrorIsAFailure) {
  GateResult r = times({kernel("a", 1, Verdict::kInconclusive)});
  r.time->kernels[0].verdict.harness_error = true;
  EXPECT_NE(format_junit(r).find("failures=\"1\" skipped=\"0\""), std::string::npos)
      << format_junit(r);
}

TEST(ExitCode, OfWhatCannotBeCompared) {
  GateResult r = times({kernel("a", 1, Verdict::kPass)});
  r.time->gone = {"b"};
  EXPECT_EQ(exit_code(r), kUpdateNeeded);
  r = times({});
  r.instructions = InstructionReport{.kernels = 1};
  r.instructions->other_key = "compiler";
  EXPECT_EQ(exit_code(r), kInconclusive);
  r = times({});
  r.time->alone = {kernel("new", 1, Verdict::kPass)};
  EXPECT_EQ(exit_code(r), kGood);
  r.time->alone[0].over_budget = true;
  EXPECT_EQ(exit_code(r), kSlower) << "a new kernel has its budget, too";
}

TEST(ExitCode, WithoutABaseIsNeverGood) {
  GateResult r = times({});
  r.time->alone = {kernel("a", 1, Verdict::kPass)};
  r.no_base = "the first commit";
  EXPECT_EQ(exit_code(r), kInconclusive);
  for (const std::string& text : {format_terminal(r, false), format_markdown(r), format_junit(r)}) {
    EXPECT_NE(text.find("compared with what was before: the first commit"), std::string::npos)
        << text;
    EXPECT_EQ(text.find("passed"), std::string::npos) << text;
  }
  r.time->alone[0].over_budget = true;
  EXPECT_EQ(exit_code(r), kSlower) << "what is known counts";
}

TEST(Markdown, LeadsWithTheVerdict) {
  const std::string text = format_markdown(metric(Change::kWorse));
  EXPECT_EQ(text.find("## tauext-gate: LESS ACCURATE (exit 5)"), 0u) << text;
}

TEST(BenchmarkJson, HasARepetitionAProcess) {
  const GateResult r = times({kernel("arm/ekf", 1.1, Verdict::kFail)});
  const auto base = nlohmann::json::parse(format_benchmark(r, false));
  const auto head = nlohmann::json::parse(format_benchmark(r, true));
  ASSERT_EQ(head["benchmarks"].size(), 2u);
  EXPECT_EQ(head["benchmarks"][1]["repetition_index"], 1);
  EXPECT_NEAR(head["benchmarks"][0]["cpu_time"].get<double>() /
                  base["benchmarks"][0]["cpu_time"].get<double>(),
              1.1, 1e-12);
  EXPECT_THROW(format_benchmark(GateResult{}, true), std::invalid_argument);
}

}  // namespace
}  // namespace tauext::gate

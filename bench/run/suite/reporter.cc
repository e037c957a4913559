// SPDX-License-Identifier: Apache-2.0
#include "bench/run/suite/reporter.h"

#include <fmt/format.h>

#include <cmath>

#include "bench/score/metric_list.h"

namespace tauext {
namespace {

template <class Run>
bool has_failed(const Run& run) {
  if constexpr (kBenchmark17<Run>)
    return run.error_occurred;
  else
    return static_cast<bool>(run.skipped);
}

}  // namespace

Reporter::Reporter(benchmark::BenchmarkReporter* display, int total)
    : display_(display), total_(total) {
  json_.SetOutputStream(&json_text_);
  json_.SetErrorStream(&json_text_);
}

bool Reporter::ReportContext(const Context& context) {
  return json_.ReportContext(context) && (display_ == nullptr || display_->ReportContext(context));
}

void Reporter::ReportRuns(const std::vector<Run>& runs) {
  std::vector<Run> finite = runs;
  for (Run& run : finite) {
    std::erase_if(run.counters, [](const auto& c) { return !std::isfinite(c.second.value); });
    any_error_ = any_error_ || has_failed(run);
    const auto time = run.counters.find(key_of(Metric::kCpu));
    if (time == run.counters.end()) continue;
    const bool median = run.run_type == Run::RT_Aggregate && run.aggregate_name == "median";
    if (median || run.run_type == Run::RT_Iteration)
      cpu_ns_[run.run_name.function_name] = time->second.value;
  }
  json_.ReportRuns(finite);
  if (display_ != nullptr) display_->ReportRuns(finite);
  if (on_done && !runs.empty()) on_done(runs[0].run_name.function_name);
  if (runs.empty()) return;
  ++done_;
  const std::string of = total_ > 0 ? fmt::format("/{}", total_) : "";
  progress_.show(fmt::format("[{}{}] {}", done_, of, runs[0].run_name.function_name));
}

void Reporter::Finalize() {
  json_.Finalize();
  if (display_ != nullptr) display_->Finalize();
  progress_.clear();
}

}  // namespace tauext

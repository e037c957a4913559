// SPDX-License-Identifier: Apache-2.0
#include "regression/time_layer.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <stdexcept>

#include "regression/identity.h"
#include "regression/plugin_host.h"

namespace tauext::gate {
namespace {

// adds one process' results to those kernels that it ran
void collect(const std::vector<WorkerResult>& results, std::vector<KernelTime>& kernels) {
  for (const WorkerResult& r : results) {
    const auto it = std::find_if(kernels.begin(), kernels.end(),
                                 [&](const KernelTime& k) { return k.kernel == r.kernel; });
    it->processes.push_back(r);
  }
}

double median_of(const std::vector<WorkerResult>& all, double WorkerResult::*value) {
  std::vector<double> values;
  for (const WorkerResult& r : all) values.push_back(r.*value);
  return median(values);
}

void judge_kernel(KernelTime& k, const TimeOptions& o) {
  std::vector<ProcessRatios> ratios;
  for (const WorkerResult& r : k.processes) ratios.push_back({r.head, r.aa, r.canaries.at(0)});
  k.verdict = judge(ratios, o.limits);
  k.base_ns = median_of(k.processes, &WorkerResult::base_ns);
  k.head_ns = median_of(k.processes, &WorkerResult::head_ns);
  k.over_budget = k.head_ns * 1e-9 > o.period / 10;
}

}  // namespace

KernelNames kernel_names(const std::string& base, const std::string& head,
                         const std::string& filter) {
  const TemporaryFolder folder;
  const Plugin b(folder.copy(base, "base.so")), h(folder.copy(head, "head.so"));
  const std::regex wanted(filter);
  KernelNames names;
  for (int i = 0; i < b.count(); ++i) {
    if (!std::regex_search(b.name(i), wanted)) continue;
    (h.find(b.name(i)) < 0 ? names.gone : names.both).push_back(b.name(i));
  }
  for (int i = 0; i < h.count(); ++i) {
    if (std::regex_search(h.name(i), wanted) && b.find(h.name(i)) < 0) {
      names.added.push_back(h.name(i));
    }
  }
  if (names.both.empty() && names.gone.empty() && names.added.empty()) {
    throw std::invalid_argument(fmt::format("--kernels '{}' matches no kernel", filter));
  }
  return names;
}

TimeReport compare_times(const TimeOptions& o) {
  KernelNames names = kernel_names(o.base, o.head, o.kernels);
  TimeReport report{.gone = std::move(names.gone), .added = std::move(names.added)};
  for (const std::string& name : names.both) report.kernels.push_back({.kernel = name});
  report.identical = identical(o.base, o.head);
  if (report.kernels.empty()) return report;
  if (report.identical && !o.even_if_identical) {
    for (KernelTime& k : report.kernels) k.verdict.verdict = Verdict::kIdentical;
    return report;
  }
  WorkerOptions worker{.base = o.base,
                       .head = o.head,
                       .kernels = names.both,
                       .pairs = o.pairs,
                       .block = o.block,
                       .injected = {o.limits.canary}};
  int done = 0;
  for (const int stage : o.limits.stages) {
    for (; done < stage; ++done) {
      if (o.progress) {
        o.progress(fmt::format("timing {} kernels: process {} of {}", worker.kernels.size(),
                               done + 1, stage));
      }
      collect(run_worker(worker), report.kernels);
    }
    // the next stage is for those that are undecided
    worker.kernels.clear();
    for (KernelTime& k : report.kernels) {
      if (static_cast<int>(k.processes.size()) < stage) continue;
      judge_kernel(k, o);
      if (k.verdict.verdict == Verdict::kInconclusive) worker.kernels.push_back(k.kernel);
    }
    if (worker.kernels.empty()) break;
  }
  return report;
}

}  // namespace tauext::gate

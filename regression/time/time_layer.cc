// SPDX-License-Identifier: Apache-2.0
#include "regression/time/time_layer.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <stdexcept>

#include "regression/host/files.h"
#include "regression/host/plugin_host.h"
#include "regression/time/identity.h"

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

bool over_budget(double ns, const TimeOptions& o) {
  return ns * 1e-9 > o.period / 10;
}

void judge_kernel(KernelTime& k, const TimeOptions& o) {
  std::vector<ProcessRatios> ratios;
  for (const WorkerResult& r : k.processes) ratios.push_back({r.head, r.aa, r.canaries.at(0)});
  k.verdict = judge(ratios, o.limits);
  k.base_ns = median_of(k.processes, &WorkerResult::base_ns);
  k.head_ns = median_of(k.processes, &WorkerResult::head_ns);
  k.over_budget = over_budget(k.head_ns, o);
}

// L3 of kernels that nothing can be compared with
std::vector<KernelTime> beside_themselves(const TimeOptions& o,
                                          const std::vector<std::string>& names) {
  std::vector<KernelTime> kernels;
  if (names.empty()) return kernels;
  const WorkerOptions worker{
      .base = o.head, .head = o.head, .kernels = names, .pairs = 15, .block = o.block};
  for (const WorkerResult& r : run_worker(worker)) {
    KernelTime k{.kernel = r.kernel, .base_ns = 0, .head_ns = r.head_ns};
    k.over_budget = over_budget(r.head_ns, o);
    kernels.push_back(k);
  }
  return kernels;
}

void run_stages(const TimeOptions& o, const std::vector<std::string>& names,
                std::vector<KernelTime>& kernels) {
  WorkerOptions worker{.base = o.base,
                       .head = o.head,
                       .kernels = names,
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
      collect(run_worker(worker), kernels);
    }
    // the next stage is for those that are undecided
    worker.kernels.clear();
    for (KernelTime& k : kernels) {
      if (static_cast<int>(k.processes.size()) < stage) continue;
      judge_kernel(k, o);
      if (k.verdict.verdict == Verdict::kInconclusive) worker.kernels.push_back(k.kernel);
    }
    if (worker.kernels.empty()) return;
  }
}

// what a plug-in's hash would not see, and two commits of it would share in one process
void require_self_contained(const std::string& path) {
  for (const std::string& library : needed_libraries(path)) {
    constexpr const char* kOfTheSystem[] = {"libc.", "libm.", "libstdc++.", "libgcc_s.",
                                            "ld-linux"};
    if (std::none_of(std::begin(kOfTheSystem), std::end(kOfTheSystem),
                     [&](const char* known) { return library.starts_with(known); })) {
      throw std::runtime_error(fmt::format(
          "{}: needs {}, whose code two commits would share: link it statically", path, library));
    }
  }
}

}  // namespace

KernelNames kernel_names(const std::string& base, const std::string& head,
                         const std::string& filter) {
  const TemporaryFolder folder;
  const auto matching = [&](const std::string& plugin, const char* copy) {
    std::vector<std::string> found;
    if (plugin.empty()) return found;
    require_self_contained(plugin);
    const Plugin p(folder.copy(plugin, copy), plugin);
    const std::regex wanted(filter);
    for (int i = 0; i < p.count(); ++i) {
      if (std::regex_search(p.name(i), wanted)) found.push_back(p.name(i));
    }
    return found;
  };
  const std::vector<std::string> b = matching(base, "base.so"), h = matching(head, "head.so");
  const auto in = [](const std::vector<std::string>& all, const std::string& name) {
    return std::find(all.begin(), all.end(), name) != all.end();
  };
  KernelNames names;
  for (const std::string& name : b) (in(h, name) ? names.both : names.gone).push_back(name);
  for (const std::string& name : h) {
    if (!in(b, name)) names.added.push_back(name);
  }
  if (names.both.empty() && names.gone.empty() && names.added.empty()) {
    throw std::invalid_argument(fmt::format("--kernels '{}' matches no kernel", filter));
  }
  return names;
}

TimeReport compare_times(const TimeOptions& o) {
  KernelNames names = kernel_names(o.base, o.head, o.kernels);
  TimeReport report{.gone = names.gone, .alone = beside_themselves(o, names.added)};
  for (const std::string& name : names.both) report.kernels.push_back({.kernel = name});
  if (o.base.empty()) return report;
  report.identical = identical(o.base, o.head);
  if (report.identical && !o.even_if_identical) {
    for (KernelTime& k : report.kernels) k.verdict.verdict = Verdict::kIdentical;
  } else if (!report.kernels.empty()) {
    run_stages(o, names.both, report.kernels);
  }
  return report;
}

}  // namespace tauext::gate

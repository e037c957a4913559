// SPDX-License-Identifier: Apache-2.0
#include "regression/time/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <thread>

#include "mjcf/trace/table_writer.h"
#include "regression/code/layouts.h"
#include "regression/host/child.h"
#include "regression/time/time_layer.h"
#include "regression/time/time_worker.h"

namespace tauext::gate {
namespace {

// all slowdowns of one kernel in one trial share their layouts
struct Tried {
  std::vector<std::vector<LayoutRatios>> by_slowdown;
  std::vector<TimeVerdict> verdicts;
};
using ByKernel = std::map<std::string, Tried>;

// a layout's ratios as if `slowdown` number s were in head, too; the last canary is the canary
LayoutRatios as_head(const std::vector<WorkerResult>& processes, const CalibrateOptions& o,
                     std::size_t s) {
  std::vector<double> head, aa, canary;
  for (const WorkerResult& r : processes) {
    const bool as_it_is = o.slowdowns[s] == 0 || !o.head.empty();
    head.push_back(as_it_is ? r.head : r.head * r.canaries[s]);
    aa.push_back(r.aa);
    canary.push_back(r.canaries.back());
  }
  return {median(head), median(aa), median(canary)};
}

void run_one_layout(const Layouts& layouts, int seed, const WorkerOptions& worker,
                    const CalibrateOptions& o, ByKernel& tried) {
  for (const auto& [kernel, processes] : run_layout(layouts, seed, o.limits.processes, worker)) {
    Tried& t = tried[kernel];
    for (std::size_t s = 0; s < o.slowdowns.size(); ++s) {
      const TimeVerdict& v = t.verdicts[s];
      if (v.layouts > 0 && v.verdict != Verdict::kInconclusive) continue;  // it stays
      t.by_slowdown[s].push_back(as_head(processes, o, s));
    }
  }
}

// whether a slowdown of the kernel is undecided after so many layouts
bool judge_open(Tried& t, int layouts, int kernels, const TimeLimits& limits) {
  bool open = false;
  for (std::size_t s = 0; s < t.verdicts.size(); ++s) {
    if (static_cast<int>(t.by_slowdown[s].size()) == layouts) {
      t.verdicts[s] = judge(t.by_slowdown[s], limits, kernels);
    }
    open = open || t.verdicts[s].verdict == Verdict::kInconclusive;
  }
  return open;
}

ByKernel trial(const CalibrateOptions& o, const std::vector<std::string>& kernels, int number) {
  const Layouts layouts = o.head.empty()
                              ? Layouts::only_moved(o.base, static_cast<std::uint64_t>(number))
                              : Layouts(o.base, o.head);
  WorkerOptions worker{.kernels = kernels, .injected = o.slowdowns};
  worker.injected.push_back(o.limits.canary);
  ByKernel tried;
  for (const std::string& k : kernels) {
    tried[k] = {std::vector<std::vector<LayoutRatios>>(o.slowdowns.size()),
                std::vector<TimeVerdict>(o.slowdowns.size())};
  }
  int done = 0;
  for (const int stage : o.limits.stages) {
    for (; done < stage; ++done) {
      run_one_layout(layouts, number * o.limits.stages[3] + done, worker, o, tried);
    }
    worker.kernels.clear();
    for (auto& [kernel, t] : tried) {
      if (judge_open(t, stage, static_cast<int>(kernels.size()), o.limits)) {
        worker.kernels.push_back(kernel);
      }
    }
    if (worker.kernels.empty()) break;
  }
  return tried;
}

}  // namespace

std::vector<Power> calibrate(const CalibrateOptions& options) {
  CalibrateOptions o = options;
  if (!o.head.empty()) o.slowdowns = {0.05};  // what head really is, nobody injects
  const std::vector<std::string> kernels =
      kernel_names(o.base, o.head.empty() ? o.base : o.head, o.kernels).both;
  if (kernels.empty()) throw std::invalid_argument("the two plug-ins have no kernel in common");
  std::vector<Power> power;
  for (const double s : o.slowdowns) power.push_back({.slowdown = s});
  for (int i = 0; i < o.trials; ++i) {
    if (o.progress) o.progress(static_cast<double>(i) / o.trials);
    const ByKernel tried = trial(o, kernels, i);
    for (std::size_t s = 0; s < power.size(); ++s) {
      bool any = false;
      for (const auto& [kernel, t] : tried) {
        ++power[s].comparisons;
        power[s].failed += t.verdicts[s].verdict == Verdict::kFail;
        power[s].inconclusive += t.verdicts[s].verdict == Verdict::kInconclusive;
        any = any || t.verdicts[s].verdict == Verdict::kFail;
      }
      power[s].trials_with_a_failure += any;
    }
  }
  return power;
}

std::string format_power(const std::vector<Power>& power, const CalibrateOptions& o) {
  TableWriter table({{"slowdown"},
                     {"comparisons"},
                     {"failed"},
                     {"inconclusive"},
                     {"found", "%"},
                     {"trials that failed"}});
  for (const Power& p : power) {
    const std::string name = !o.head.empty()   ? "--head"
                             : p.slowdown == 0 ? "none (moved)"
                                               : fmt::format("{:.0f} %", 100 * p.slowdown);
    table.add({name, fmt::to_string(p.comparisons), fmt::to_string(p.failed),
               fmt::to_string(p.inconclusive),
               fmt::format("{:.2f}", 100. * p.failed / std::max(p.comparisons, 1)),
               fmt::format("{} of {}", p.trials_with_a_failure, o.trials)});
  }
  return fmt::format("{}, {} cores; limit {:+.0f} %, {} trials\n{}", processor(),
                     std::thread::hardware_concurrency(), 100 * o.limits.surely, o.trials,
                     table.format());
}

}  // namespace tauext::gate

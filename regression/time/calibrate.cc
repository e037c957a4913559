// SPDX-License-Identifier: Apache-2.0
#include "regression/time/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <stdexcept>
#include <thread>

#include "mjcf/trace/table_writer.h"
#include "regression/time/time_layer.h"
#include "regression/time/time_worker.h"

namespace tauext::gate {
namespace {

// all slowdowns of one kernel in one trial share their processes
struct Tried {
  std::vector<std::vector<ProcessRatios>> by_slowdown;
  std::vector<TimeVerdict> verdicts;
};

// a worker's ratios as if `slowdown` number s were head's; its last canary is the canary
ProcessRatios as_head(const WorkerResult& r, const CalibrateOptions& o, std::size_t s) {
  const bool copy = o.slowdowns[s] == 0;
  return {copy || !o.head.empty() ? r.head : r.canaries[s], r.aa, r.canaries.back()};
}

using ByKernel = std::map<std::string, Tried>;

void run_process(const WorkerOptions& worker, const CalibrateOptions& o, ByKernel& tried) {
  for (const WorkerResult& r : run_worker(worker)) {
    Tried& t = tried[r.kernel];
    for (std::size_t s = 0; s < o.slowdowns.size(); ++s) {
      const TimeVerdict& v = t.verdicts[s];
      if (v.processes > 0 && v.verdict != Verdict::kInconclusive) continue;  // it stays
      t.by_slowdown[s].push_back(as_head(r, o, s));
    }
  }
}

// whether a slowdown of the kernel is undecided after so many processes
bool judge_open(Tried& t, int processes, const TimeLimits& limits) {
  bool open = false;
  for (std::size_t s = 0; s < t.verdicts.size(); ++s) {
    if (static_cast<int>(t.by_slowdown[s].size()) == processes) {
      t.verdicts[s] = judge(t.by_slowdown[s], limits);
    }
    open = open || t.verdicts[s].verdict == Verdict::kInconclusive;
  }
  return open;
}

ByKernel trial(const CalibrateOptions& o, const std::vector<std::string>& kernels) {
  WorkerOptions worker{
      .base = o.base, .head = o.head.empty() ? o.base : o.head, .kernels = kernels};
  worker.injected = o.slowdowns;
  worker.injected.push_back(o.limits.canary);
  ByKernel tried;
  for (const std::string& k : kernels) {
    tried[k] = {std::vector<std::vector<ProcessRatios>>(o.slowdowns.size()),
                std::vector<TimeVerdict>(o.slowdowns.size())};
  }
  int done = 0;
  for (const int stage : o.limits.stages) {
    for (; done < stage; ++done) run_process(worker, o, tried);
    worker.kernels.clear();
    for (auto& [kernel, t] : tried) {
      if (judge_open(t, stage, o.limits)) worker.kernels.push_back(kernel);
    }
    if (worker.kernels.empty()) break;
  }
  return tried;
}

std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(": ") + 2);
  }
  return "unknown processor";
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
    const ByKernel tried = trial(o, kernels);
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
                             : p.slowdown == 0 ? "none (A/A)"
                                               : fmt::format("{:.0f} %", 100 * p.slowdown);
    table.add({name, fmt::to_string(p.comparisons), fmt::to_string(p.failed),
               fmt::to_string(p.inconclusive),
               fmt::format("{:.2f}", 100. * p.failed / std::max(p.comparisons, 1)),
               fmt::format("{} of {}", p.trials_with_a_failure, o.trials)});
  }
  return fmt::format("{}, {} cores; limit {:+.0f} %, {} trials\n{}", processor(),
                     std::thread::hardware_concurrency(), 100 * o.limits.limit, o.trials,
                     table.format());
}

}  // namespace tauext::gate

// SPDX-License-Identifier: Apache-2.0
#include "regression/time/time_layer.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <regex>
#include <stdexcept>
#include <utility>

#include "regression/code/elf.h"
#include "regression/code/layouts.h"
#include "regression/host/files.h"
#include "regression/host/plugin_host.h"

namespace tauext::gate {
namespace {

double median_of(const std::vector<WorkerResult>& all, double WorkerResult::*value) {
  std::vector<double> values;
  for (const WorkerResult& r : all) values.push_back(r.*value);
  return median(values);
}

bool over_budget(double ns, const TimeOptions& o) {
  return ns * 1e-9 > o.period / 10;
}

// L3 of kernels that nothing can be compared with
std::vector<KernelTime> beside_themselves(const TimeOptions& o,
                                          const std::vector<std::string>& names) {
  std::vector<KernelTime> kernels;
  if (names.empty()) return kernels;
  const WorkerOptions worker{.base = o.head, .head = o.head, .kernels = names};
  for (const WorkerResult& r : run_worker(worker)) {
    KernelTime k{.kernel = r.kernel, .base_ns = 0, .head_ns = r.head_ns};
    k.over_budget = over_budget(r.head_ns, o);
    kernels.push_back(k);
  }
  return kernels;
}

// a kernel and what its layouts said
struct Timed {
  KernelTime* kernel;
  std::vector<LayoutRatios> layouts;
};

void time_layout(const TimeOptions& o, const Layouts& layouts, int seed, std::vector<Timed>& open) {
  WorkerOptions worker{.injected = {o.limits.canary}};
  for (const Timed& t : open) worker.kernels.push_back(t.kernel->kernel);
  auto results = run_layout(layouts, seed, o.limits.processes, worker);
  for (Timed& t : open) {
    std::vector<WorkerResult>& mine = results[t.kernel->kernel];
    std::vector<double> canaries;
    for (const WorkerResult& r : mine) canaries.push_back(r.canaries.at(0));
    t.layouts.push_back({median_of(mine, &WorkerResult::head), median_of(mine, &WorkerResult::aa),
                         median(canaries)});
    auto& processes = t.kernel->processes;
    std::move(mine.begin(), mine.end(), std::back_inserter(processes));
  }
}

void judge_kernel(Timed& t, const TimeOptions& o, int kernels) {
  KernelTime& k = *t.kernel;
  k.verdict = judge(t.layouts, o.limits, kernels);
  k.base_ns = median_of(k.processes, &WorkerResult::base_ns);
  k.head_ns = median_of(k.processes, &WorkerResult::head_ns);
  k.over_budget = over_budget(k.head_ns, o);
}

void run_stages(const TimeOptions& o, const Layouts& layouts,
                const std::vector<KernelTime*>& kernels) {
  std::vector<Timed> open;
  for (KernelTime* k : kernels) open.push_back({k, {}});
  int done = 0;
  for (const int stage : o.limits.stages) {
    for (; done < stage; ++done) {
      if (o.progress) {
        o.progress(fmt::format("timing {} kernels: layout {} of {}", open.size(), done + 1, stage));
      }
      time_layout(o, layouts, done, open);
    }
    for (Timed& t : open) judge_kernel(t, o, static_cast<int>(kernels.size()));
    // the next stage is for those that are undecided
    std::erase_if(
        open, [](const Timed& t) { return t.kernel->verdict.verdict != Verdict::kInconclusive; });
    if (open.empty()) return;
  }
}

// once on each side
void run_lives(const TimeOptions& o, const std::vector<KernelTime*>& kernels) {
  LongRunOptions run{.base = o.base, .head = o.head};
  for (const KernelTime* k : kernels) run.kernels.push_back(k->kernel);
  if (o.progress) o.progress(fmt::format("longer runs of {} kernels", kernels.size()));
  for (LongRun& life : run_long(run)) {
    const auto it = std::find_if(kernels.begin(), kernels.end(),
                                 [&](const KernelTime* k) { return k->kernel == life.kernel; });
    if (it != kernels.end()) (*it)->life = std::move(life);
  }
}

// kernels that cannot differ, as they do the same from the same beginning
class Identity {
 public:
  Identity(const TimeOptions& o, const PluginCode& base, const PluginCode& head)
      : base_code_(base),
        head_code_(head),
        base_(folder_.copy(o.base, "base.so"), o.base),
        head_(folder_.copy(o.head, "head.so"), o.head),
        lives_(1, 1) {}

  bool same(const std::string& kernel) {
    const int b = base_.find(kernel), h = head_.find(kernel);
    const std::string code = reached(base_code_, base_, b);
    if (code.empty() || code != reached(head_code_, head_, h)) return false;
    const std::string bytes = state(base_, b);
    return !bytes.empty() && bytes == state(head_, h);
  }

 private:
  static std::string reached(const PluginCode& code, const Plugin& plugin, int kernel) {
    return code.reached(function_at(code.path(), plugin.address(kernel)));
  }
  std::string state(const Plugin& plugin, int kernel) {
    return Work(plugin, kernel, lives_.of(plugin, kernel)).state();
  }

  const PluginCode &base_code_, &head_code_;
  TemporaryFolder folder_;
  Plugin base_, head_;
  Lives lives_;
};

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

Verdict verdict_of(const KernelTime& k) {
  const bool complained = !k.life.kernel.empty() && !complaint(k.life).empty();
  const bool stalls = complained && k.life_accepted.empty();
  if (stalls) return Verdict::kFail;
  return complained && k.verdict.verdict == Verdict::kPass ? Verdict::kAccepted : k.verdict.verdict;
}

TimeReport compare_times(const TimeOptions& o) {
  KernelNames names = kernel_names(o.base, o.head, o.kernels);
  TimeReport report{.gone = names.gone, .alone = beside_themselves(o, names.added)};
  for (const std::string& name : names.both) report.kernels.push_back({.kernel = name});
  if (o.base.empty() || report.kernels.empty()) return report;
  const Layouts layouts(o.base, o.head);
  Identity identity(o, layouts.base(), layouts.head());
  std::vector<KernelTime*> different;
  for (KernelTime& k : report.kernels) {
    const bool timed = o.even_if_identical || o.counted_otherwise.contains(k.kernel);
    if (!timed && identity.same(k.kernel)) {
      k.verdict.verdict = Verdict::kIdentical;
    } else {
      different.push_back(&k);
    }
  }
  if (different.empty()) return report;
  run_lives(o, different);
  run_stages(o, layouts, different);
  return report;
}

}  // namespace tauext::gate

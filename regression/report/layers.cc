// SPDX-License-Identifier: Apache-2.0
#include "regression/report/layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "regression/accuracy/accuracy_layer.h"
#include "regression/host/files.h"
#include "regression/host/plugin_host.h"

namespace tauext::gate {
namespace {

// a base of another ABI is no base
void leave_out_other_abi(GateOptions& o) {
  if (o.base.empty()) return;
  try {
    const TemporaryFolder folder;
    Plugin(folder.copy(o.base, "base.so"), o.base);
  } catch (const OtherAbi& e) {
    o.no_base = e.what();
    o.base.clear();
  }
}

// what a layer's findings say together
struct Seen {
  bool harness = false, slower = false, less_accurate = false, update = false, unsure = false;
};

void see(const TimeReport& t, Seen& seen) {
  seen.update = seen.update || !t.gone.empty();
  for (const KernelTime& k : t.alone) seen.slower = seen.slower || k.over_budget;
  for (const KernelTime& k : t.kernels) {
    const Verdict verdict = verdict_of(k);
    const bool open = verdict == Verdict::kInconclusive;
    seen.harness = seen.harness || (open && k.verdict.harness_error);
    seen.slower = seen.slower || verdict == Verdict::kFail || k.over_budget;
    seen.unsure = seen.unsure || open;
  }
}

void see(const InstructionReport& r, Seen& seen) {
  for (const auto* changes : {&r.beside_base, &r.beside_committed}) {
    seen.slower = seen.slower || std::any_of(changes->begin(), changes->end(), too_many);
  }
  seen.unsure = seen.unsure || !r.other_key.empty();  // two compilers: nothing is comparable
  seen.update = seen.update || !r.no_baseline.empty() || !r.added.empty() || !r.gone.empty();
}

void see(const AccuracyReport& r, Seen& seen) {
  seen.harness = seen.harness || !r.not_repeated.empty();
  seen.less_accurate = seen.less_accurate || r.worse() > 0;
  seen.update = seen.update || !r.no_baseline.empty() ||
                std::any_of(r.changes.begin(), r.changes.end(),
                            [](const MetricChange& c) { return c.accepted.empty(); });
}

void see(const MemoryReport& r, Seen& seen) {
  seen.less_accurate = seen.less_accurate || r.worse_without_leave();
  seen.update = seen.update || r.without_reason();
}

}  // namespace

GateResult run_layers(const GateOptions& options) {
  GateOptions o = options;
  GateResult r{.base = o.base, .head = o.head, .bench = o.bench};
  if (o.accuracy && o.bench.empty()) {
    if (!o.time && !o.instructions) throw std::invalid_argument("accuracy wants a --bench PROGRAM");
    r.notes.emplace_back("no --bench: accuracy was not looked at");
  }
  if (o.time || o.instructions) leave_out_other_abi(o);
  // a count alone is beside the committed ones, unless somebody named a base
  if (o.base.empty() && (o.time || (o.instructions && !options.base.empty()))) {
    r.no_base = o.no_base.empty() ? "none was named: --base SO" : o.no_base;
  }
  if (o.instructions) {
    r.instructions = compare_instructions({.base = o.base,
                                           .head = o.head,
                                           .kernels = o.kernels,
                                           .baselines = o.baselines,
                                           .progress = o.progress});
  }
  if (o.time) {
    const Counts* const base =
        r.instructions && r.instructions->base ? &*r.instructions->base : nullptr;
    r.time =
        compare_times({.base = o.base,
                       .head = o.head,
                       .kernels = o.kernels,
                       .even_if_identical = o.even_if_identical,
                       .counted_otherwise = base ? counted_otherwise(*base, *r.instructions->head)
                                                 : std::set<std::string>(),
                       .limits = o.limits,
                       .period = o.period,
                       .progress = o.progress});
  }
  if (o.accuracy && !o.bench.empty()) {
    r.accuracy = score_and_compare(
        {.bench = o.bench, .entries = o.entries, .baselines = o.baselines, .progress = o.progress});
  }
  if (!o.base_committed.baselines.empty()) {
    r.memory = compare_committed(o.base_committed, {o.baselines, o.changelog});
  }
  return r;
}

ExitCode exit_code(const GateResult& r) {
  Seen seen{.unsure = !r.no_base.empty()};
  if (r.time) see(*r.time, seen);
  if (r.instructions) see(*r.instructions, seen);
  if (r.accuracy) see(*r.accuracy, seen);
  if (r.memory) see(*r.memory, seen);
  if (seen.harness) return kCouldNotRun;
  if (seen.slower) return kSlower;
  if (seen.less_accurate) return kLessAccurate;
  if (seen.update) return kUpdateNeeded;
  return seen.unsure ? kInconclusive : kGood;
}

}  // namespace tauext::gate

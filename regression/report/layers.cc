// SPDX-License-Identifier: Apache-2.0
#include "regression/report/layers.h"

#include <fmt/format.h>

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

}  // namespace tauext::gate

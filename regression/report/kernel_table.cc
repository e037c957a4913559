// SPDX-License-Identifier: Apache-2.0
#include "regression/report/kernel_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "mjcf/trace/table_writer.h"

namespace tauext::gate {
namespace {

// whether base and head were both counted, and could be compared
bool counted(const GateResult& r, const std::string& kernel) {
  return r.instructions && r.instructions->compared(kernel);
}

std::vector<std::string> cells_of(const GateResult& r, const KernelTime& k) {
  const TimeVerdict& v = k.verdict;
  const CountChange* count = change_of(r, k.kernel);
  const std::string instructions = count ? fmt::format("{:+.2f}", 100 * count->change())
                                   : counted(r, k.kernel) ? "same"
                                                          : "";
  if (v.verdict == Verdict::kIdentical) {
    return {k.kernel, "", "", "", "", "", instructions, name_of(v.verdict)};
  }
  return {k.kernel,
          fmt::format("{:.1f}", k.base_ns),
          fmt::format("{:.1f}", k.head_ns),
          fmt::format("{:+.2f}", 100 * (v.ratio - 1)),
          fmt::format("{:+.2f} to {:+.2f}", 100 * (v.low - 1), 100 * (v.high - 1)),
          fmt::format("{:.2f}", 100 * v.layout_sd),
          instructions,
          name_of(verdict_of(k))};
}

}  // namespace

const CountChange* change_of(const GateResult& r, const std::string& kernel) {
  if (!r.instructions) return nullptr;
  const auto& changes = r.instructions->beside_base;
  const auto it = std::find_if(changes.begin(), changes.end(),
                               [&](const CountChange& c) { return c.kernel == kernel; });
  return it == changes.end() ? nullptr : &*it;
}

KernelTable kernel_table(const GateResult& r) {
  TableWriter table({{"kernel", "", true},
                     {"base", "ns"},
                     {"head", "ns"},
                     {"change", "%"},
                     {"interval", "%"},
                     {"layouts' sd", "%"},
                     {"instructions", "%"},
                     {"verdict", fmt::format("limit {:+.0f} %", 100 * TimeLimits().surely), true}});
  for (const KernelTime& k : r.time->kernels) table.add(cells_of(r, k));
  std::istringstream lines(table.format());
  std::string titles, units;
  std::getline(lines, titles);
  std::getline(lines, units);
  KernelTable out{titles + "\n" + units + "\n", {}};
  for (std::string line; std::getline(lines, line);) out.rows.push_back(line);
  return out;
}

std::string life_table(const GateResult& r) {
  TableWriter table({{"kernel", "", true},
                     {"mean", "ns"},
                     {"was", "ns"},
                     {"slowest of 1000", "ns"},
                     {"was", "ns"},
                     {"worst", "us"},
                     {"was", "us"}});
  bool any = false;
  for (const KernelTime& k : r.time->kernels) {
    if (k.life.kernel.empty()) continue;
    any = true;
    const LifeTimes &head = k.life.head, &base = k.life.base;
    table.add({k.kernel, fmt::format("{:.1f}", head.mean_ns), fmt::format("{:.1f}", base.mean_ns),
               fmt::format("{:.1f}", head.rare_ns), fmt::format("{:.1f}", base.rare_ns),
               fmt::format("{:.1f}", 1e-3 * head.worst_ns),
               fmt::format("{:.1f}", 1e-3 * base.worst_ns)});
  }
  if (!any) return "";
  return fmt::format(
             "A longer run, in steps of {}: their mean, the slowest block of 1000, and the slowest "
             "of all\n",
             kStepsOfABlock) +
         table.format();
}

std::string why(const GateResult& r, const KernelTime& time) {
  const CountChange* count = change_of(r, time.kernel);
  const bool slower = time.verdict.verdict == Verdict::kFail;
  const bool more = count && too_many(*count);
  if (slower && more && count->change() >= (time.verdict.low - 1) / 3) {
    return fmt::format("more work: {:+.1f} % instructions", 100 * count->change());
  }
  if (slower && more) {
    return fmt::format(
        "more work, but {:+.1f} % instructions do not explain it: longer waits, too (divides, "
        "chains "
        "of dependent steps, memory)",
        100 * count->change());
  }
  if (slower && !counted(r, time.kernel)) {
    return "whether by more work or by waiting: tauext-gate count tells";
  }
  if (slower && count && count->change() < -kCountNote) {
    return fmt::format(
        "less work ({:+.1f} % instructions), but slower: longer waits (divides, chains "
        "of dependent steps, memory)",
        100 * count->change());
  }
  if (slower) {
    return "the same work, but slower: longer waits (divides, chains of dependent steps, memory) "
           "or where the code lies";
  }
  if (more && time.verdict.verdict == Verdict::kPass) return "more instructions at no cost in time";
  return "";
}

}  // namespace tauext::gate

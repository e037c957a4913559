// SPDX-License-Identifier: Apache-2.0
#include "regression/history/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "regression/accuracy/accuracy_layer.h"
#include "regression/counts/instructions.h"
#include "regression/host/child.h"
#include "regression/time/time_layer.h"

namespace tauext::gate {
namespace {

void refuse_what_is_no_record(const Record& r, const std::vector<Record>& history) {
  const std::pair<const char*, const std::string&> names[] = {
      {"--commit", r.commit}, {"--date", r.date}, {"--reference", r.reference}};
  for (const auto& [flag, value] : names) {
    if (value.empty()) throw std::invalid_argument(fmt::format("{} is empty", flag));
  }
  for (const Record& known : history) {
    if (known.commit == r.commit) {
      throw std::invalid_argument(fmt::format("--commit {}: is on record already", r.commit));
    }
  }
}

std::map<std::string, KernelRecord> kernels_of(const MeasureOptions& o, std::string& machine) {
  if (o.progress) o.progress("counting instructions");
  const Counts base = count_instructions(o.base, o.kernels);
  const Counts head = count_instructions(o.head, o.kernels);
  const TimeReport times = compare_times({.base = o.base,
                                          .head = o.head,
                                          .kernels = o.kernels,
                                          .counted_otherwise = counted_otherwise(base, head),
                                          .progress = o.progress});
  machine = fmt::format("{}, {}", processor(), head.key.at("compiler"));
  std::map<std::string, KernelRecord> kernels;
  for (const KernelTime& k : times.kernels) {
    KernelRecord& r = kernels[k.kernel];
    const double after = static_cast<double>(head.kernels.at(k.kernel));
    r.instructions = after / kCountedSteps;
    r.instructions_ratio = after / static_cast<double>(base.kernels.at(k.kernel));
    const TimeVerdict& v = k.verdict;
    if (v.harness_error) throw std::runtime_error(fmt::format("{}: {}", k.kernel, v.why));
    if (v.verdict == Verdict::kIdentical) continue;
    r.ratio = v.ratio;
    r.low = v.low;
    r.high = v.high;
    r.surely = v.verdict == Verdict::kInconclusive ? 0 : v.surely;
    r.ns = k.head_ns;
  }
  return kernels;
}

// over the seeds that have a value; NaN where most have none
double mean_of_most(std::vector<double> values) {
  const std::size_t all = values.size();
  std::erase_if(values, [](double v) { return std::isnan(v); });
  if (2 * values.size() <= all) return kNever;
  return std::accumulate(values.begin(), values.end(), 0.) / static_cast<double>(values.size());
}

// what is not as it was
void compare_metrics(const MeasureOptions& o, const std::vector<Record>& history, Record& r) {
  if (o.bench.empty()) return;
  if (o.progress) o.progress("scoring every entry");
  const Golden golden = parse_golden(run_bench(o.bench, o.entries), "what " + o.bench + " wrote");
  std::map<std::string, double> before = metrics_after(history, history.size());
  for (const auto& [key, line] : golden.lines) {
    const std::string name = key.first + " " + key.second;
    const double mean = mean_of_most(line.values);
    const auto it = before.find(name);
    const bool same =
        it != before.end() && (it->second == mean || (std::isnan(it->second) && std::isnan(mean)));
    if (!same) r.metrics[name] = mean;
    before.erase(name);
  }
  for (const auto& [name, value] : before) r.gone.push_back(name);
}

}  // namespace

Record measure(const MeasureOptions& o, const std::vector<Record>& history) {
  refuse_what_is_no_record(o.record, history);
  Record r = o.record;
  r.kernels = kernels_of(o, r.machine);
  compare_metrics(o, history, r);
  r.accepted = read_acceptances(accepted_path(o.baselines));
  return r;
}

}  // namespace tauext::gate

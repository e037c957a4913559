// SPDX-License-Identifier: Apache-2.0
#include "regression/report/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include "regression/report/kernel_table.h"

namespace tauext::gate {
namespace {

constexpr const char* kBaselines = "baselines beside base's";

std::vector<Finding> time_findings(const GateResult& r) {
  std::vector<Finding> all;
  if (!r.time) return all;
  std::vector<std::string> rows = kernel_table(r).rows;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const KernelTime& k = r.time->kernels[i];
    Finding f{kTimeLayer, k.kernel, verdict_of(k), std::move(rows[i]), {}};
    f.harness_error = k.verdict.harness_error && f.verdict == Verdict::kInconclusive;
    if (!k.verdict.why.empty()) f.more.push_back(k.verdict.why);
    if (!k.life.kernel.empty()) {
      if (std::string stall = complaint(k.life); !stall.empty()) f.more.push_back(std::move(stall));
      if (!k.life_accepted.empty()) f.more.push_back(k.life_accepted);
    }
    if (k.over_budget) {
      f.verdict = Verdict::kFail;
      f.more.emplace_back("a step takes more than a tenth of the control period");
    }
    if (std::string reason = why(r, k); !reason.empty()) f.more.push_back(std::move(reason));
    if (f.verdict == Verdict::kFail) {
      const CountChange* count = change_of(r, k.kernel);
      if (count) f.more.insert(f.more.end(), count->gained.begin(), count->gained.end());
      f.more.push_back(fmt::format("again: tauext-gate time --base {} --head {} --kernels '{}'",
                                   r.base, r.head, exactly(k.kernel)));
    }
    all.push_back(std::move(f));
  }
  for (const KernelTime& k : r.time->alone)
    if (k.over_budget)
      all.push_back({kTimeLayer,
                     k.kernel,
                     Verdict::kFail,
                     fmt::format("{}: new, and a step takes {:.1f} ns, more than a tenth of the "
                                 "control period",
                                 k.kernel, k.head_ns),
                     {}});
  for (const std::string& k : r.time->gone)
    all.push_back(
        {kTimeLayer, k, Verdict::kNoBaseline, k + " is gone from head: update needed", {}});
  return all;
}

std::vector<Finding> count_findings(const std::vector<CountChange>& changes, const char* layer) {
  const auto a_step = [](std::uint64_t n) { return static_cast<double>(n) / kCountedSteps; };
  std::vector<Finding> all;
  for (const CountChange& c : changes) {
    const Verdict v = !c.accepted.empty()                 ? Verdict::kAccepted
                      : too_many(c)                       ? Verdict::kFail
                      : std::abs(c.change()) > kCountNote ? Verdict::kNote
                                                          : Verdict::kPass;
    Finding f{
        layer, c.kernel, v,
        fmt::format("{:<34} {:.1f} -> {:.1f} instructions a step, {:+.2f} % (limit +{:.0f} %)  {}",
                    c.kernel, a_step(c.before), a_step(c.after), 100 * c.change(),
                    100 * kCountLimit, name_of(v)),
        c.gained};
    if (!c.accepted.empty()) f.more.push_back(c.accepted);
    all.push_back(std::move(f));
  }
  return all;
}

std::vector<Finding> instruction_findings(const InstructionReport& r) {
  constexpr const char *kBase = "instructions beside base",
                       *kCommitted = "instructions beside the committed";
  std::vector<Finding> all;
  if (!r.other_key.empty()) {
    all.push_back(
        {kBase, "key", Verdict::kInconclusive,
         "base and head cannot be compared, neither their times nor their instructions: " +
             r.other_key});
  }
  for (const auto& [layer, changes] :
       {std::pair(kBase, &r.beside_base), std::pair(kCommitted, &r.beside_committed)}) {
    for (Finding& f : count_findings(*changes, layer)) all.push_back(std::move(f));
  }
  const auto note = [&](const std::string& subject, const std::string& text) {
    all.push_back({kCommitted, subject, Verdict::kNoBaseline, text});
  };
  if (!r.no_baseline.empty()) note("key", r.no_baseline);
  for (const std::string& k : r.added)
    note(k, k + " is not in the committed counts: update needed");
  for (const std::string& k : r.gone) {
    note(k, k + " is gone and still in the committed counts: update needed");
  }
  return all;
}

Verdict verdict_of(Change c) {
  return c == Change::kWorse ? Verdict::kFail : Verdict::kNoBaseline;
}

const char* words_for(Change c) {
  const std::map<Change, const char*> words = {{Change::kWorse, "LESS ACCURATE"},
                                               {Change::kBetter, "better: update needed"},
                                               {Change::kChanged, "changed: update needed"},
                                               {Change::kNew, "new: update needed"},
                                               {Change::kGone, "gone: update needed"}};
  return words.at(c);
}

// how sure that is, and where to look
std::string worst_of(const MetricChange& c) {
  const std::string off = c.standard_errors < 1000
                              ? fmt::format("{:.1f} standard errors off", c.standard_errors)
                              : "1000 standard errors off or more";
  const std::string at = c.largest_error_at.empty()
                             ? ""
                             : ", whose largest error is at t = " + c.largest_error_at + " s";
  return fmt::format("{}; worst: {}{}", off, c.worst_seed, at);
}

// @param command whether the entry's command has not been shown yet
Finding metric_finding(const MetricChange& c, const std::string& bench, bool command) {
  const double percent = 100 * (c.after / c.before - 1);
  Finding f{kAccuracyLayer,
            c.entry + " " + c.metric,
            verdict_of(c.change),
            fmt::format("{} {}  {} -> {}{}  {}", c.entry, c.metric, said(c.before), said(c.after),
                        std::isfinite(percent) ? fmt::format(" ({:+.3g} %)", percent) : "",
                        words_for(c.change)),
            {}};
  if (!c.note.empty()) f.more.push_back(c.note);
  if (!c.accepted.empty()) {
    f.verdict = Verdict::kAccepted;
    f.more.push_back(c.accepted);
    return f;
  }
  if (c.change != Change::kWorse) return f;
  f.more.push_back(worst_of(c));
  if (command) f.more.push_back("again: " + score_command(bench, c.entry, c.worst_seed));
  return f;
}

std::vector<Finding> accuracy_findings(const GateResult& r) {
  std::vector<Finding> all;
  if (!r.accuracy) return all;
  for (const std::string& line : r.accuracy->not_repeated) {
    all.push_back(
        {kAccuracyLayer, "repeat", Verdict::kFail, "not the same twice: " + line, {}, true});
  }
  if (!r.accuracy->no_baseline.empty()) {
    all.push_back({kAccuracyLayer, "baseline", Verdict::kNoBaseline, r.accuracy->no_baseline, {}});
  }
  std::set<std::string> shown;
  for (const MetricChange& c : r.accuracy->changes) {
    const bool first = c.change == Change::kWorse && shown.insert(c.entry).second;
    all.push_back(metric_finding(c, r.bench, first));
  }
  return all;
}

std::vector<Finding> memory_findings(const MemoryReport& r) {
  std::vector<Finding> all;
  for (const Moved& m : r.moved) {
    const Verdict v = m.worse && r.worse_without_leave() ? Verdict::kFail
                      : r.without_reason()               ? Verdict::kNoBaseline
                                                         : Verdict::kNote;
    const char* const words = v == Verdict::kFail         ? "WORSE, and nobody accepted it"
                              : v == Verdict::kNoBaseline ? "moved without a reason"
                              : m.worse                   ? "worse, accepted"
                                                          : "moved";
    all.push_back({kBaselines, m.what, v, fmt::format("{}: {}  {}", m.what, m.how, words), {}});
  }
  return all;
}

// the kernel that changed most, with its interval
void add_compared(const TimeReport& t, std::vector<std::string>& lines) {
  const auto with = [&](Verdict v) {
    return std::count_if(t.kernels.begin(), t.kernels.end(),
                         [&](const KernelTime& k) { return verdict_of(k) == v; });
  };
  const auto identical = with(Verdict::kIdentical);
  if (identical > 0) {
    lines.push_back(fmt::format(
        "time          {} kernels identical: the same code and data, in all that they reach",
        identical));
  }
  if (identical == static_cast<std::ptrdiff_t>(t.kernels.size())) return;
  const auto by_ratio = [](const KernelTime& a, const KernelTime& b) {
    return std::pair(a.verdict.layouts > 0, a.verdict.ratio) <
           std::pair(b.verdict.layouts > 0, b.verdict.ratio);
  };
  const KernelTime& most = *std::max_element(t.kernels.begin(), t.kernels.end(), by_ratio);
  lines.push_back(fmt::format(
      "time          {} kernels, {} ok; the most: {} {:+.2f} % ({:+.2f} to {:+.2f}), limit {:+.0f} "
      "%",
      static_cast<std::ptrdiff_t>(t.kernels.size()) - identical, with(Verdict::kPass), most.kernel,
      100 * (most.verdict.ratio - 1), 100 * (most.verdict.low - 1), 100 * (most.verdict.high - 1),
      100 * TimeLimits().surely));
}

// the slowest of those that nothing can be compared with; it comes last
void add_alone(std::vector<KernelTime> kernels, std::vector<std::string>& lines) {
  std::sort(kernels.begin(), kernels.end(),
            [](const KernelTime& a, const KernelTime& b) { return a.head_ns < b.head_ns; });
  const KernelTime& slowest = kernels.back();
  lines.push_back(fmt::format(
      "time          {} kernels with nothing to compare with; the slowest: {}, {:.1f} ns a step",
      kernels.size(), slowest.kernel, slowest.head_ns));
}

void add_summary(const TimeReport& t, std::vector<std::string>& lines) {
  if (!t.kernels.empty()) add_compared(t, lines);
  if (!t.alone.empty()) add_alone(t.alone, lines);
}

void add_summary(const InstructionReport& r, std::vector<std::string>& lines) {
  const auto add = [&](const char* name, const std::vector<CountChange>& changes) {
    lines.push_back(
        fmt::format("instructions  {} kernels beside {}: {} differ, {} by more than +{:.0f} %",
                    r.kernels, name, changes.size(),
                    std::count_if(changes.begin(), changes.end(), too_many), 100 * kCountLimit));
  };
  if (r.base && r.other_key.empty()) add("base", r.beside_base);
  if (!r.only_base.empty())
    lines.push_back("instructions  " + r.only_base);
  else if (r.no_baseline.empty())
    add("the committed", r.beside_committed);
}

}  // namespace

std::vector<Finding> findings(const GateResult& r) {
  std::vector<Finding> all;
  const auto add = [&](const std::vector<Finding>& more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  if (!r.no_base.empty()) add({{"base", "base", Verdict::kInconclusive, no_base_text(r), {}}});
  add(time_findings(r));
  if (r.instructions) add(instruction_findings(*r.instructions));
  add(accuracy_findings(r));
  if (r.memory) add(memory_findings(*r.memory));
  return all;
}

ExitCode exit_code(const GateResult& r) {
  const std::vector<Finding> all = findings(r);
  const auto any = [&](auto&& is) { return std::any_of(all.begin(), all.end(), is); };
  const auto has = [&](Verdict v) { return any([v](const Finding& f) { return f.verdict == v; }); };
  const auto fails = [&](bool accuracy) {
    return any([accuracy](const Finding& f) {
      const bool of_metrics = f.layer == kAccuracyLayer || f.layer == kBaselines;
      return f.verdict == Verdict::kFail && of_metrics == accuracy;
    });
  };
  if (any([](const Finding& f) { return f.harness_error; })) return kCouldNotRun;
  if (fails(false)) return kSlower;
  if (fails(true)) return kLessAccurate;
  if (has(Verdict::kNoBaseline)) return kUpdateNeeded;
  return has(Verdict::kInconclusive) ? kInconclusive : kGood;
}

std::string no_base_text(const GateResult& r) {
  return "no base, so neither times nor instructions were compared with what was before: " +
         r.no_base;
}

std::vector<std::string> summary(const GateResult& r) {
  std::vector<std::string> lines = r.notes;
  if (r.time) add_summary(*r.time, lines);
  if (r.instructions) add_summary(*r.instructions, lines);
  if (r.accuracy && r.accuracy->no_baseline.empty()) {
    lines.push_back(fmt::format(
        "accuracy      {} metrics: {} changed, {} of them surely worse by more than {:.1f} %",
        r.accuracy->lines, r.accuracy->changes.size(), r.accuracy->worse(), 100 * kWorseBy));
  }
  if (r.memory) {
    lines.push_back(fmt::format("baselines     {} lines beside base's: {} moved, {} of them worse",
                                r.memory->lines, r.memory->moved.size(), r.memory->worse()));
    for (const std::string& reason : r.memory->reasons) lines.push_back("  because: " + reason);
  }
  return lines;
}

std::string exactly(const std::string& name) {
  std::string out = "^";
  for (const char c : name)
    out += c == '+' || c == '.' ? fmt::format("[{}]", c) : std::string(1, c);
  return out + "$";
}

std::string score_command(const std::string& bench, const std::string& entry,
                          const std::string& seed) {
  return fmt::format("{} --golden - --seeds {} --benchmark_filter='{}'", bench,
                     seed.substr(seed.rfind(' ') + 1), exactly(entry));
}

}  // namespace tauext::gate

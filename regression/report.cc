// SPDX-License-Identifier: Apache-2.0
#include "regression/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

namespace tauext::gate {
namespace {

// one thing that was looked at
struct Finding {
  std::string layer, subject;
  Verdict verdict = Verdict::kPass;
  std::string text;               // one line
  std::vector<std::string> more;  // reasons, and the command
};

std::string escaped_regex(const std::string& name) {
  std::string out = "^";
  for (const char c : name) out += c == '+' ? std::string("[+]") : std::string(1, c);
  return out + "$";
}

std::string value(double x) {
  return std::isnan(x) ? "never" : fmt::format("{:.6g}", x);
}

const CountChange* change_of(const InstructionReport* r, const std::string& kernel) {
  if (!r) return nullptr;
  const auto it = std::find_if(r->beside_base.begin(), r->beside_base.end(),
                               [&](const CountChange& c) { return c.kernel == kernel; });
  return it == r->beside_base.end() ? nullptr : &*it;
}

std::string kernel_line(const KernelTime& k, const CountChange* count, const InstructionReport* r) {
  const TimeVerdict& v = k.verdict;
  std::string line = fmt::format("{:<34}", k.kernel);
  if (v.verdict == Verdict::kIdentical) {
    line += fmt::format(" {:>9} {:>9} {:>8} {:>17}", "", "", "", "");
  } else {
    line += fmt::format(" {:9.1f} {:9.1f} {:+7.2f} % {:>17}", k.base_ns, k.head_ns,
                        100 * (v.median - 1),
                        fmt::format("{:+.2f} to {:+.2f}", 100 * (v.low - 1), 100 * (v.high - 1)));
  }
  std::string instructions;
  if (count) {
    instructions = fmt::format("{:+.2f} %", 100 * count->change());
  } else if (r && r->base && r->base->kernels.contains(k.kernel)) {
    instructions = "same";
  }
  return line + fmt::format(" {:>12}  {}", instructions, name_of(v.verdict));
}

std::string kernel_header() {
  return fmt::format("{:<34} {:>9} {:>9} {:>9} {:>17} {:>12}  {}\n",
                     "kernel (ns a step, limit +2 %)", "base", "head", "change", "interval %",
                     "instructions", "verdict");
}

std::vector<Finding> time_findings(const GateResult& r) {
  std::vector<Finding> all;
  if (!r.time) return all;
  const InstructionReport* counts = r.instructions ? &*r.instructions : nullptr;
  for (const KernelTime& k : r.time->kernels) {
    const CountChange* count = change_of(counts, k.kernel);
    Finding f{"time", k.kernel, k.verdict.verdict, kernel_line(k, count, counts), {}};
    if (!k.verdict.why.empty()) f.more.push_back(k.verdict.why);
    if (k.over_budget) {
      f.verdict = Verdict::kFail;
      f.more.push_back("a step takes more than a tenth of the control period");
    }
    if (const std::string reason = why(k, count); !reason.empty()) f.more.push_back(reason);
    if (f.verdict == Verdict::kFail) {
      if (count) f.more.insert(f.more.end(), count->gained.begin(), count->gained.end());
      f.more.push_back(
          fmt::format("again: tauext-gate time --base BASE.so --head HEAD.so --kernels '{}'",
                      escaped_regex(k.kernel)));
    }
    all.push_back(std::move(f));
  }
  return all;
}

std::vector<Finding> count_findings(const std::vector<CountChange>& changes, const char* layer) {
  std::vector<Finding> all;
  for (const CountChange& c : changes) {
    const Verdict v = too_many(c)                         ? Verdict::kFail
                      : std::abs(c.change()) > kCountNote ? Verdict::kNote
                                                          : Verdict::kPass;
    Finding f{layer, c.kernel, v,
              fmt::format(
                  "{:<34} {:.1f} -> {:.1f} instructions a step, {:+.2f} % (limit +{:.0f} %)  {}",
                  c.kernel, static_cast<double>(c.before) / 1e3, static_cast<double>(c.after) / 1e3,
                  100 * c.change(), 100 * kCountLimit, name_of(v)),
              c.gained};
    all.push_back(std::move(f));
  }
  return all;
}

Verdict verdict_of(Change c) {
  return c == Change::kWorse ? Verdict::kFail : Verdict::kNoBaseline;
}

// @param command whether the entry's command has not been shown yet
Finding metric_finding(const MetricChange& c, const std::string& bench, bool command) {
  const std::map<Change, const char*> what = {{Change::kWorse, "LESS ACCURATE"},
                                              {Change::kBetter, "better: update needed"},
                                              {Change::kChanged, "changed: update needed"},
                                              {Change::kNew, "new: update needed"},
                                              {Change::kGone, "gone: update needed"}};
  const double percent = 100 * (c.after / c.before - 1);
  Finding f{"accuracy",
            c.entry + " " + c.metric,
            verdict_of(c.change),
            fmt::format("{} {}  {} -> {}{}  {}", c.entry, c.metric, value(c.before), value(c.after),
                        std::isfinite(percent) ? fmt::format(" ({:+.3g} %)", percent) : "",
                        what.at(c.change)),
            {}};
  if (!c.note.empty()) f.more.push_back(c.note);
  if (c.change != Change::kWorse) return f;
  std::string line = c.standard_errors < 1000
                         ? fmt::format("{:.1f} standard errors off", c.standard_errors)
                         : "1000 standard errors off or more";
  line += "; worst: " + c.worst_seed;
  if (!c.largest_error_at.empty()) {
    line += ", whose largest error is at t = " + c.largest_error_at + " s";
  }
  f.more.push_back(line);
  if (command) {
    const std::string seed = c.worst_seed.substr(c.worst_seed.rfind(' ') + 1);
    f.more.push_back(fmt::format("again: {} --golden - --seeds {} --benchmark_filter='{}'", bench,
                                 seed, escaped_regex(c.entry)));
  }
  return f;
}

std::vector<Finding> accuracy_findings(const GateResult& r) {
  std::vector<Finding> all;
  for (const std::string& line : r.not_repeated) {
    all.push_back({"accuracy", "repeat", Verdict::kFail, "not the same twice: " + line, {}});
  }
  if (!r.accuracy) return all;
  if (!r.accuracy->no_baseline.empty()) {
    all.push_back({"accuracy", "baseline", Verdict::kNoBaseline, r.accuracy->no_baseline, {}});
  }
  std::set<std::string> shown;
  for (const MetricChange& c : r.accuracy->changes) {
    const bool first = c.change == Change::kWorse && shown.insert(c.entry).second;
    all.push_back(metric_finding(c, r.bench, first));
  }
  return all;
}

std::vector<Finding> findings(const GateResult& r) {
  std::vector<Finding> all = time_findings(r);
  const auto add = [&](const std::vector<Finding>& more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  if (r.instructions) {
    const InstructionReport& i = *r.instructions;
    add(count_findings(i.beside_base, "instructions beside base"));
    add(count_findings(i.beside_committed, "instructions beside the committed"));
    const auto note = [&](const std::string& subject, const std::string& text) {
      all.push_back({"instructions beside the committed", subject, Verdict::kNoBaseline, text, {}});
    };
    if (!i.no_baseline.empty()) note("key", i.no_baseline);
    for (const std::string& k : i.added)
      note(k, k + " is not in the committed counts: update needed");
    for (const std::string& k : i.gone)
      note(k, k + " is gone and still in the committed counts: update needed");
  }
  add(accuracy_findings(r));
  return all;
}

bool well(const Finding& f) {
  return f.verdict == Verdict::kPass || f.verdict == Verdict::kIdentical;
}

// a line for each layer
std::vector<std::string> summary(const GateResult& r) {
  std::vector<std::string> lines = r.notes;
  if (r.time) {
    const auto& kernels = r.time->kernels;
    if (r.time->identical) {
      lines.push_back(fmt::format(
          "time          identical: {} kernels, the same code to the last byte", kernels.size()));
    }
    if (!kernels.empty() && kernels[0].verdict.verdict != Verdict::kIdentical) {
      const auto by_median = [](const KernelTime& a, const KernelTime& b) {
        return a.verdict.median < b.verdict.median;
      };
      const KernelTime& most = *std::max_element(kernels.begin(), kernels.end(), by_median);
      lines.push_back(fmt::format(
          "time          {} kernels, {} ok; the most: {} {:+.2f} % ({:+.2f} to {:+.2f}), limit +2 "
          "%",
          kernels.size(),
          std::count_if(kernels.begin(), kernels.end(),
                        [](const KernelTime& k) { return k.verdict.verdict == Verdict::kPass; }),
          most.kernel, 100 * (most.verdict.median - 1), 100 * (most.verdict.low - 1),
          100 * (most.verdict.high - 1)));
    }
    for (const std::string& k : r.time->added)
      lines.push_back("time          new, nothing to compare: " + k);
    for (const std::string& k : r.time->gone) lines.push_back("time          gone from head: " + k);
  }
  const auto counts = [&](const char* name, const std::vector<CountChange>& changes, int kernels) {
    lines.push_back(
        fmt::format("instructions  {} kernels beside {}: {} differ, {} by more than +{:.0f} %",
                    kernels, name, changes.size(),
                    std::count_if(changes.begin(), changes.end(), too_many), 100 * kCountLimit));
  };
  if (r.instructions) {
    if (r.instructions->base) counts("base", r.instructions->beside_base, r.instructions->kernels);
    if (r.instructions->no_baseline.empty()) {
      counts("the committed", r.instructions->beside_committed, r.instructions->kernels);
    }
  }
  if (r.accuracy && r.accuracy->no_baseline.empty()) {
    lines.push_back(
        fmt::format("accuracy      {} metrics: {} changed, {} of them worse by more than 0.5 %",
                    r.accuracy->lines, r.accuracy->changes.size(), r.accuracy->worse()));
  }
  return lines;
}

std::string xml(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

}  // namespace

std::string why(const KernelTime& time, const CountChange* count) {
  const bool slower = time.verdict.verdict == Verdict::kFail;
  const bool more = count && too_many(*count);
  if (slower && more)
    return fmt::format("more work: {:+.1f} % instructions", 100 * count->change());
  if (slower) {
    return "the same work, but slower: longer waits (divides, chains of dependent steps, memory) "
           "or where "
           "the code lies";
  }
  if (more && time.verdict.verdict == Verdict::kPass) return "more instructions at no cost in time";
  return "";
}

std::string advice(GateCode code) {
  switch (code) {
    case kPassed:
      return "passed";
    case kSlower:
      return "SLOWER (exit 1)";
    case kLessAccurate:
      return "LESS ACCURATE (exit 2)";
    case kUpdateNeeded:
      return "update needed (exit 3): if it is meant, ci/gate --update 'the reason'";
    case kInconclusive:
      return "INCONCLUSIVE (exit 4): this machine is too noisy now; run it again";
    case kUsage:
      return "usage (exit 64)";
    case kHarnessError:
      return "HARNESS ERROR (exit 70): no verdict of this run counts";
  }
  return "";
}

std::string format_terminal(const GateResult& r, bool all) {
  constexpr std::size_t kMost = 12;  // of each layer; the rest is in the other reports
  std::string out;
  std::string layer;
  std::map<std::string, std::size_t> shown, left;
  for (const Finding& f : findings(r)) {
    if (!all && (well(f) || f.verdict == Verdict::kNote)) continue;
    if (!all && ++shown[f.layer] > kMost) {
      ++left[f.layer];
      continue;
    }
    if (f.layer != layer) {
      layer = f.layer;
      out += layer == "time" ? kernel_header() : layer + "\n";
    }
    out += f.text + "\n";
    for (const std::string& line : f.more) out += "    " + line + "\n";
  }
  for (const auto& [name, n] : left) {
    out += fmt::format("... and {} more of {}: --all, --markdown or --junit\n", n, name);
  }
  if (!out.empty()) out += "\n";
  for (const std::string& line : summary(r)) out += line + "\n";
  return out + advice(exit_code(r)) + "\n";
}

std::string format_junit(const GateResult& r) {
  std::map<std::string, std::vector<Finding>> layers;
  for (Finding& f : findings(r)) layers[f.layer].push_back(std::move(f));
  std::string out =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"tauext-gate\">\n";
  for (const auto& [layer, list] : layers) {
    const auto count = [&](auto pred) { return std::count_if(list.begin(), list.end(), pred); };
    const auto skipped = [](const Finding& f) { return f.verdict == Verdict::kInconclusive; };
    out += fmt::format("  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" skipped=\"{}\">\n",
                       xml(layer), list.size(), count([](const Finding& f) {
                         return f.verdict == Verdict::kFail || f.verdict == Verdict::kNoBaseline;
                       }),
                       count(skipped));
    for (const Finding& f : list) {
      out += fmt::format("    <testcase classname=\"{}\" name=\"{}\">", xml(layer), xml(f.subject));
      const std::string message = xml(fmt::format("{}\n{}", f.text, fmt::join(f.more, "\n")));
      if (skipped(f)) {
        out +=
            fmt::format("<skipped message=\"inconclusive\"/><system-out>{}</system-out>", message);
      } else if (f.verdict == Verdict::kFail || f.verdict == Verdict::kNoBaseline) {
        out += fmt::format("<failure message=\"{}\">{}</failure>", name_of(f.verdict), message);
      } else {
        out += fmt::format("<system-out>{}</system-out>", message);
      }
      out += "</testcase>\n";
    }
    out += "  </testsuite>\n";
  }
  return out + "</testsuites>\n";
}

std::string format_markdown(const GateResult& r) {
  std::string out = fmt::format("## tauext-gate: {}\n\n", advice(exit_code(r)));
  for (const std::string& line : summary(r)) out += "- " + line + "\n";
  std::string layer;
  for (const Finding& f : findings(r)) {
    if (well(f)) continue;
    if (f.layer != layer) {
      layer = f.layer;
      out += fmt::format("\n### {}\n", layer);
    }
    out += fmt::format("```\n{}\n", f.text);
    for (const std::string& line : f.more) out += "    " + line + "\n";
    out += "```\n";
  }
  if (!r.time || r.time->kernels.empty() ||
      r.time->kernels[0].verdict.verdict == Verdict::kIdentical) {
    return out;
  }
  out += "\n<details><summary>every kernel</summary>\n\n```\n" + kernel_header();
  for (const Finding& f : time_findings(r)) out += f.text + "\n";
  return out + "```\n</details>\n";
}

std::string format_benchmark(const GateResult& r, bool head) {
  if (!r.time || r.time->kernels.empty() || r.time->kernels[0].processes.empty()) {
    throw std::invalid_argument("nothing was timed: no Google Benchmark JSON");
  }
  nlohmann::json benchmarks = nlohmann::json::array();
  for (const KernelTime& k : r.time->kernels) {
    for (std::size_t i = 0; i < k.processes.size(); ++i) {
      const double ns = head ? k.processes[i].head_ns : k.processes[i].base_ns;
      benchmarks.push_back({{"name", k.kernel},
                            {"run_name", k.kernel},
                            {"run_type", "iteration"},
                            {"repetitions", k.processes.size()},
                            {"repetition_index", i},
                            {"threads", 1},
                            {"iterations", 1},
                            {"real_time", ns},
                            {"cpu_time", ns},
                            {"time_unit", "ns"}});
    }
  }
  const nlohmann::json context = {{"executable", head ? "head" : "base"},
                                  {"library_build_type", "release"}};
  return nlohmann::json{{"context", context}, {"benchmarks", benchmarks}}.dump(1) + "\n";
}

}  // namespace tauext::gate

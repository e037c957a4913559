// SPDX-License-Identifier: Apache-2.0
#include "regression/report/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "regression/report/findings.h"
#include "regression/report/kernel_table.h"

namespace tauext::gate {
namespace {

bool well(const Finding& f) {
  return f.verdict == Verdict::kPass || f.verdict == Verdict::kIdentical;
}

bool failed(const Finding& f) {
  return f.harness_error || f.verdict == Verdict::kFail || f.verdict == Verdict::kNoBaseline;
}

bool skipped(const Finding& f) {
  return f.verdict == Verdict::kInconclusive && !f.harness_error;
}

std::string xml(const std::string& text) {
  const std::map<char, const char*> escaped = {
      {'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}};
  std::string out;
  for (const char c : text) {
    const auto it = escaped.find(c);
    out += it == escaped.end() ? std::string(1, c) : it->second;
  }
  return out;
}

std::string junit_case(const Finding& f) {
  const std::string message = xml(fmt::format("{}\n{}", f.text, fmt::join(f.more, "\n")));
  std::string out =
      fmt::format("    <testcase classname=\"{}\" name=\"{}\">", xml(f.layer), xml(f.subject));
  if (skipped(f)) {
    out += fmt::format("<skipped message=\"inconclusive\"/><system-out>{}</system-out>", message);
  } else if (failed(f)) {
    out += fmt::format("<failure message=\"{}\">{}</failure>", name_of(f.verdict), message);
  } else {
    out += fmt::format("<system-out>{}</system-out>", message);
  }
  return out + "</testcase>\n";
}

// one line of what follows from the exit code
std::string advice(const GateResult& r) {
  const ExitCode code = exit_code(r);
  switch (code) {
    case kGood:
      return "passed";
    case kSlower:
    case kLessAccurate:
      return fmt::format(
          "{} (exit {}): if it is meant, call ci/gate or tauext-gate-commits with --accept REASON",
          code == kSlower ? "SLOWER" : "LESS ACCURATE", int{code});
    case kCouldNotRun:
      return fmt::format("HARNESS ERROR (exit {}): no verdict of this run counts", int{code});
    case kUpdateNeeded:
      return fmt::format(
          "update needed (exit {}): if it is meant, call ci/gate or "
          "tauext-gate-commits with --update 'the reason'",
          int{code});
    case kInconclusive:
      return fmt::format("INCONCLUSIVE (exit {}): {}", int{code},
                         r.no_base.empty() ? "if it is for noise, run it again" : no_base_text(r));
  }
  return "";
}

}  // namespace

bool timed(const GateResult& r) {
  return r.time && std::any_of(r.time->kernels.begin(), r.time->kernels.end(),
                               [](const KernelTime& k) { return !k.processes.empty(); });
}

std::string format_terminal(const GateResult& r, bool all) {
  constexpr std::size_t kMost = 12;  // of each layer; the rest is in the other reports
  std::string out;
  std::string layer;
  std::map<std::string, std::size_t> shown, left;
  for (const Finding& f : findings(r)) {
    if (!all && well(f)) continue;
    if (!all && ++shown[f.layer] > kMost) {
      ++left[f.layer];
      continue;
    }
    if (f.layer != layer) {
      layer = f.layer;
      out += layer == "time" ? kernel_table(r).header : layer + "\n";
    }
    out += f.text + "\n";
    for (const std::string& line : f.more) out += "    " + line + "\n";
  }
  for (const auto& [name, n] : left) {
    out += fmt::format("... and {} more of {}: --all, --markdown or --junit\n", n, name);
  }
  if (all && r.time) out += life_table(r);
  if (!out.empty()) out += "\n";
  for (const std::string& line : summary(r)) out += line + "\n";
  return out + advice(r) + "\n";
}

std::string format_junit(const GateResult& r) {
  std::map<std::string, std::vector<Finding>> layers;
  for (Finding& f : findings(r)) layers[f.layer].push_back(std::move(f));
  std::string out =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"tauext-gate\">\n";
  for (const auto& [layer, list] : layers) {
    out += fmt::format("  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" skipped=\"{}\">\n",
                       xml(layer), list.size(), std::count_if(list.begin(), list.end(), failed),
                       std::count_if(list.begin(), list.end(), skipped));
    for (const Finding& f : list) out += junit_case(f);
    out += "  </testsuite>\n";
  }
  return out + "</testsuites>\n";
}

std::string format_markdown(const GateResult& r) {
  std::string out = fmt::format("## tauext-gate: {}\n\n", advice(r));
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
  if (!timed(r)) return out;
  out += "\n<details><summary>every kernel</summary>\n\n```\n" + kernel_table(r).header;
  for (const Finding& f : findings(r)) {
    if (f.layer == "time") out += f.text + "\n";
  }
  return out + "\n" + life_table(r) + "```\n</details>\n";
}

std::string format_benchmark(const GateResult& r, bool head) {
  if (!timed(r)) {
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

// SPDX-License-Identifier: Apache-2.0
#include "regression/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "regression/findings.h"
#include "regression/report.h"

namespace tauext::gate {
namespace {

std::string functions_of(const Counts& head, const Counts* base, const std::string& kernel) {
  std::vector<std::pair<std::uint64_t, std::string>> sorted;
  for (const auto& [function, n] : head.functions.at(kernel)) sorted.emplace_back(n, function);
  std::sort(sorted.rbegin(), sorted.rend());
  std::string out =
      fmt::format("{:>10} {:>10}  {}\n", "instr/step", base ? "base" : "", "function");
  for (const auto& [n, function] : sorted) {
    std::string before;
    if (base) {
      const auto& functions = base->functions.at(kernel);
      const auto it = functions.find(function);
      before = it == functions.end() ? "-"
                                     : fmt::format("{:.1f}", static_cast<double>(it->second) / 1e3);
    }
    out += fmt::format("{:10.1f} {:>10}  {}\n", static_cast<double>(n) / 1e3, before,
                       short_name(function));
  }
  return out;
}

std::string explain_kernel(GateOptions o, const std::string& kernel) {
  o.kernels = exactly(kernel);
  o.accuracy = false;
  o.even_if_identical = true;
  const GateResult r = run_layers(o);
  const auto& counts = *r.instructions;
  const bool both = counts.base && counts.base->kernels.contains(kernel);
  return format_terminal(r, true) + "\n" +
         functions_of(*counts.head, both ? &*counts.base : nullptr, kernel);
}

std::string text_of(double x) {
  return std::isnan(x) ? "never" : fmt::format("{:.9g}", x);
}

std::string explain_entry(const GateOptions& o, const std::string& entry) {
  const Golden head = run_bench(o.bench, exactly(entry), "");
  Golden baseline;
  if (std::filesystem::exists(golden_path(o.baselines)))
    baseline = read_golden(golden_path(o.baselines));
  std::string out = fmt::format("{}, sensors {}\n", entry, head.header.at("sensors"));
  for (const auto& [key, line] : head.lines) {
    const auto before = baseline.lines.find(key);
    out += fmt::format("{:<18}", key.second);
    for (std::size_t i = 0; i < line.values.size(); ++i)
      out += fmt::format(" {:>15}", text_of(line.values[i]));
    out += '\n';
    if (before == baseline.lines.end() || before->second.values.size() != line.values.size())
      continue;
    const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    if (std::equal(line.values.begin(), line.values.end(), before->second.values.begin(), same))
      continue;
    out += fmt::format("{:<18}", "  committed");
    for (const double v : before->second.values) out += fmt::format(" {:>15}", text_of(v));
    out += '\n';
  }
  const auto first = entry.find('/'), second = entry.find('/', first + 1);
  const std::string robot = entry.substr(0, first);
  const std::string estimator = entry.substr(second + 1);
  const auto plus = estimator.find('+');
  std::string sensors = head.header.at("sensors");
  std::replace(sensors.begin(), sensors.end(), ' ', ',');
  return out +
         fmt::format(
             "\nThe run of a seed, and its estimates:\n"
             "  tauext-record --robot {0} --scenario {1} --sensors {2} --seed 1 --out log.csv\n"
             "  tauext-replay log.csv --robot {0} --estimator {3}{4} --out est.csv\n",
             robot, entry.substr(first + 1, second - first - 1), sensors, estimator.substr(0, plus),
             plus == std::string::npos ? "" : " --detector " + estimator.substr(plus + 1));
}

}  // namespace

std::string explain(const GateOptions& o, const std::string& subject) {
  const auto slashes = std::count(subject.begin(), subject.end(), '/');
  if (slashes == 1) return explain_kernel(o, subject);
  if (slashes == 2) return explain_entry(o, subject);
  throw std::invalid_argument(
      fmt::format("'{}' is neither <robot>/<kernel> nor <robot>/<scenario>/<estimator>", subject));
}

}  // namespace tauext::gate

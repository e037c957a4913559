// SPDX-License-Identifier: Apache-2.0
#include "regression/report/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "mjcf/trace/table_writer.h"
#include "regression/accuracy/accuracy_layer.h"
#include "regression/report/findings.h"
#include "regression/report/report.h"

namespace tauext::gate {
namespace {

std::string of_a_step(std::uint64_t instructions) {
  return fmt::format("{:.1f}", a_step(static_cast<std::int64_t>(instructions)));
}

std::string functions_of(const Counts& head, const Counts* base, const std::string& kernel) {
  std::vector<std::pair<std::uint64_t, std::string>> sorted;
  for (const auto& [function, n] : head.functions.at(kernel)) sorted.emplace_back(n, function);
  std::sort(sorted.rbegin(), sorted.rend());
  TableWriter table({{"head", "instr/step"}, {"base", "instr/step"}, {"function", "", true}});
  for (const auto& [n, function] : sorted) {
    std::string before = "-";
    if (base) {
      const auto& functions = base->functions.at(kernel);
      const auto it = functions.find(function);
      if (it != functions.end()) before = of_a_step(it->second);
    }
    table.add({of_a_step(n), before, short_name(function)});
  }
  return table.format();
}

// a line of a file, if it is here
std::string source_line(const std::string& file, int number) {
  std::ifstream in(file);
  std::string line;
  for (int i = 0; i < number; ++i) {
    if (!std::getline(in, line)) return "";
  }
  return line.substr(std::min(line.find_first_not_of(" \t"), line.size()), 80);
}

// where the most instructions are, and where they are others than base's
std::string lines_of_source(const Counts& head, const Counts* base, const std::string& kernel) {
  constexpr std::size_t kMost = 15;
  const LineCounts& lines = head.lines.at(kernel);
  if (lines.empty()) return "\nnot compiled with lines (-g1): nobody knows which\n";
  std::vector<std::pair<std::uint64_t, std::pair<std::string, int>>> sorted;
  for (const auto& [place, n] : lines) sorted.emplace_back(n, place);
  std::sort(sorted.rbegin(), sorted.rend());
  sorted.resize(std::min(sorted.size(), kMost));
  TableWriter table({{"head", "instr/step"}, {"line", "", true}, {"", "", true}});
  for (const auto& [n, place] : sorted) {
    table.add({of_a_step(n), fmt::format("{}:{}", place.first, place.second),
               source_line(place.first, place.second)});
  }
  std::string text = "\nThe lines that execute most\n" + table.format();
  if (!base) return text;
  std::vector<LineChange> changes = changed_lines(base->lines.at(kernel), lines);
  std::erase_if(changes, [](const LineChange& c) { return std::abs(c.by) < kCountedSteps / 20; });
  if (changes.empty()) return text;
  changes.resize(std::min(changes.size(), kMost));
  TableWriter changed({{"change", "instr/step"}, {"line", "", true}, {"", "", true}});
  for (const LineChange& c : changes) {
    changed.add({fmt::format("{:+.1f}", a_step(c.by)), fmt::format("{}:{}", c.file, c.line),
                 source_line(c.file, c.line)});
  }
  return text + "\nWhere that is another number than base's\n" + changed.format();
}

std::string explain_kernel(GateOptions o, const std::string& kernel) {
  o.kernels = exactly(kernel);
  o.accuracy = false;
  o.even_if_identical = true;
  const GateResult r = run_layers(o);
  const auto& counts = *r.instructions;
  const std::string said = format_terminal(r, true) + "\n";
  if (!counts.head->kernels.contains(kernel)) {
    return said + kernel + " is gone from head: base alone has it\n";
  }
  const bool both = counts.base && counts.base->kernels.contains(kernel);
  const Counts* const base = both ? &*counts.base : nullptr;
  return said + functions_of(*counts.head, base, kernel) +
         lines_of_source(*counts.head, base, kernel);
}

// every metric, seed by seed, and below it what was committed, if that is another
std::string metrics_of(const Golden& head, const Golden& committed) {
  std::vector<TableWriter::Column> columns = {{"metric", "", true}};
  for (const std::string& seed : head.seeds) columns.push_back({seed});
  TableWriter table(columns);
  const auto add = [&](const std::string& name, const std::vector<double>& values) {
    std::vector<std::string> cells = {name};
    for (const double v : values)
      cells.push_back(std::isnan(v) ? "never" : fmt::format("{:.9g}", v));
    table.add(std::move(cells));
  };
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  for (const auto& [key, line] : head.lines) {
    add(key.second, line.values);
    const auto before = committed.lines.find(key);
    if (before == committed.lines.end()) continue;
    const std::vector<double>& was = before->second.values;
    if (was.size() != line.values.size()) continue;
    if (!std::equal(was.begin(), was.end(), line.values.begin(), same)) add("  committed", was);
  }
  return table.format();
}

std::string explain_entry(const GateOptions& o, const std::string& entry) {
  const Golden head =
      parse_golden(run_bench(o.bench, exactly(entry)), "what " + o.bench + " wrote");
  const std::string path = golden_path(o.baselines);
  const Golden committed = std::filesystem::exists(path) ? read_golden(path) : Golden{};
  const std::string& first = head.seeds.front();
  return fmt::format("{}, sensors {}\n{}\nThe metrics of one seed:\n  {}\n", entry,
                     head.header.at("sensors"), metrics_of(head, committed),
                     score_command(o.bench, entry, first.substr(first.rfind(' ') + 1)));
}

}  // namespace

std::string explain(const GateOptions& o, const std::string& subject) {
  const auto slashes = std::count(subject.begin(), subject.end(), '/');
  if (slashes == 1) return explain_kernel(o, subject);
  if (slashes >= 2) return explain_entry(o, subject);
  throw std::invalid_argument(
      fmt::format("'{}' is neither <robot>/<kernel> nor <robot>/<scenario>/<estimator>", subject));
}

}  // namespace tauext::gate

// SPDX-License-Identifier: Apache-2.0
#include "bench/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tauext {
namespace {

struct Column {
  const char* key;
  const char* title;
  const char* unit;
  int digits;                  // after the point
  bool less_is_better = true;  // else nobody is best: a bandwidth is a choice
};

constexpr Column kColumns[] = {
    {"rmse_Nm", "rmse", "N m", 3},
    {"max_Nm", "max", "N m", 2},
    {"noise_Nm", "noise", "N m", 3},
    {"rise_s", "rise", "s", 3},
    {"settling_s", "settling", "s", 3},
    {"overshoot_percent", "overshoot", "%", 1},
    {"final_Nm", "final", "N m", 3},
    {"lag_s", "lag", "s", 3},
    {"bandwidth_rad_s", "bandwidth", "rad/s", 1, false},
    {"delay_s", "delay", "s", 3},
    {"false_alarms", "false", "alarms", 0},
    {"overtravel_rad", "overtravel", "rad", 4},
    {"peak_N", "peak", "N", 0},
    {"peak_unstopped_N", "unstopped", "N", 0},
    {"cpu_ns", "step", "ns", 1},
    {"allocs", "allocs", "1/step", 0},
};

// what is printed decides who is best: two values that read the same are both best
double rounded(double value, int digits) {
  const double scale = std::pow(10, digits);
  return std::round(value * scale) / scale;
}

bool competes(const Row& r) {
  return !is_baseline(r.entry.estimator) && r.score.error.empty();
}

// the smallest value that a competitor of the row's group reached, if two of them differ
std::optional<double> best(const std::vector<Row>& rows, const Row& row, const Column& c) {
  if (!c.less_is_better) return std::nullopt;
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const Row& r : rows) {
    const auto value = r.score.get(c.key);
    const bool rival = r.entry.group() == row.entry.group() &&
                       r.entry.detector.empty() == row.entry.detector.empty();
    if (!rival || !competes(r) || !value) continue;
    if (std::isnan(*value)) {
      most = std::numeric_limits<double>::infinity();
      continue;
    }
    least = std::min(least, rounded(*value, c.digits));
    most = std::max(most, rounded(*value, c.digits));
  }
  return least < most ? std::optional(least) : std::nullopt;
}

std::string cell(const std::vector<Row>& rows, const Row& row, const Column& c) {
  const auto value = row.score.get(c.key);
  if (!value) return "-";
  if (std::isnan(*value)) return "never";
  const auto least = best(rows, row, c);
  const bool mark = competes(row) && least && rounded(*value, c.digits) == *least;
  return fmt::format("{:.{}f}{}", *value, c.digits, mark ? "*" : "");
}

}  // namespace

std::string format_table(const std::vector<Row>& rows) {
  // cells first, widths after them; the last place of a column is for the mark
  std::string head = "robot/scenario/estimator", units;
  std::vector<std::string> lines;
  for (const Row& r : rows) lines.push_back(r.entry.name());
  const auto pad = [&] {
    std::size_t width = std::max(head.size(), units.size());
    for (const std::string& l : lines) width = std::max(width, l.size());
    head.resize(width, ' ');
    units.resize(width, ' ');
    for (std::string& l : lines) l.resize(width, ' ');
  };
  pad();
  for (const Column& c : kColumns) {
    const auto has = [&](const Row& r) { return r.score.error.empty() && r.score.get(c.key); };
    if (std::none_of(rows.begin(), rows.end(), has)) continue;
    std::vector<std::string> cells;
    std::size_t width = std::max(std::string(c.title).size(), std::string(c.unit).size());
    for (const Row& r : rows) {
      cells.push_back(r.score.error.empty() ? cell(rows, r, c) : "");
      const bool marked = cells.back().ends_with('*');
      if (!marked) cells.back() += ' ';
      width = std::max(width, cells.back().size() - 1);
    }
    head += fmt::format("  {:>{}} ", c.title, width);
    units += fmt::format("  {:>{}} ", c.unit, width);
    for (std::size_t i = 0; i < rows.size(); ++i)
      lines[i] += fmt::format(" {:>{}}", cells[i], width + 2);
  }
  std::string out, group;
  const auto add = [&](std::string line) {
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  };
  add(head);
  add(units);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& r = rows[i];
    if (r.entry.group() != group && !group.empty()) out += "\n";
    group = r.entry.group();
    add(r.score.error.empty() ? lines[i] : r.entry.name() + "  FAILED: " + r.score.error);
  }
  return out;
}

std::string table_legend() {
  return "Worst joint of each row; * best of its group (zero, truth, delayed_truth do not "
         "compete).\n"
         "noise: what sensor noise adds to the estimate. rise: 10-90 %. settling: to within 2 %.\n"
         "final: error over the last second. lag: delay behind a moving truth. delay: from first "
         "contact\nto the mark, which stops the motor where it can; overtravel: how far the arm "
         "moves "
         "on; peak: largest\nforce of the contact, and what it is unstopped. step: CPU time.\n";
}

}  // namespace tauext

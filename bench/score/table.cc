// SPDX-License-Identifier: Apache-2.0
#include "bench/score/table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "bench/roster/baselines.h"

namespace tauext {
namespace {

// what is printed decides who is best: two values that read the same are both best
double rounded(double value, int digits) {
  const double scale = std::pow(10, digits);
  return std::round(value * scale) / scale;
}

// more where an arm's torques are smaller than a wall robot's 1200 N m
int digits_of(const Row& r, const MetricRow& m) {
  if (!m.unit.starts_with("N") || !r.entry.has_robot()) return m.digits;
  const double smaller = 5 / r.entry.robot().small_torque().maxCoeff();
  return m.digits + std::clamp(static_cast<int>(std::lround(std::log10(smaller))), 0, 6);
}

bool competes(const Row& r, const MetricRow& m) {
  const bool untouched = m.is(MetricRow::kZeroIsNoMerit) && r.score.get(m.metric) == 0;
  return !is_baseline(r.entry.estimator()) && r.score.error.empty() && !untouched;
}

bool rivals(const Row& a, const Row& b) {
  return a.entry.group() == b.entry.group() &&
         a.entry.detector().empty() == b.entry.detector().empty();
}

// the best value that a competitor of the row reached, if two of them differ
std::optional<double> best(const std::vector<Row>& rows, const Row& row, const MetricRow& m) {
  if (!m.is(MetricRow::kStar) || m.better == Better::kNeither) return std::nullopt;
  std::vector<double> values;
  bool never = false;
  for (const Row& r : rows) {
    const auto value = r.score.get(m.metric);
    if (!value || !rivals(r, row) || !competes(r, m)) continue;
    never = never || std::isnan(*value);
    if (!std::isnan(*value)) values.push_back(rounded(*value, digits_of(r, m)));
  }
  if (values.empty()) return std::nullopt;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  if (*least == *most && !never) return std::nullopt;
  return m.better == Better::kLess ? *least : *most;
}

std::string cell(const std::vector<Row>& rows, const Row& row, const MetricRow& m) {
  const auto value = row.score.get(m.metric);
  if (!value || !row.score.error.empty()) return "-";
  if (std::isnan(*value)) return "never";
  const int digits = digits_of(row, m);
  const bool mark = competes(row, m) && rounded(*value, digits) == best(rows, row, m);
  return fmt::format("{:.{}f}", *value, digits) + (mark ? std::string(1, TableWriter::kMark) : "");
}

bool failed(const Row& r) {
  return !r.score.error.empty();
}

// of the table's metrics, and of these, those that some row has
std::vector<const MetricRow*> columns_of(const std::vector<Row>& rows,
                                         const std::vector<Metric>& also) {
  std::vector<const MetricRow*> columns;
  for (const MetricRow& m : kMetrics) {
    const auto has = [&](const Row& r) { return !failed(r) && r.score.get(m.metric); };
    const bool wanted =
        m.is(MetricRow::kTable) || std::count(also.begin(), also.end(), m.metric) > 0;
    if (wanted && std::any_of(rows.begin(), rows.end(), has)) columns.push_back(&m);
  }
  return columns;
}

// read by programs, which know columns by keys
bool by_keys(TableFormat format) {
  return format == TableFormat::kCsv || format == TableFormat::kJson;
}

TableWriter::Column column_of(const MetricRow& m, TableFormat format) {
  if (by_keys(format)) return {std::string(m.key)};
  return {std::string(m.title), std::string(m.unit)};
}

const char* text_of(Better b) {
  switch (b) {
    case Better::kLess:
      return "less";
    case Better::kMore:
      return "more";
    case Better::kNeither:
      return "neither";
  }
  return "";
}

const char* text_of(WorstJoint j) {
  switch (j) {
    case WorstJoint::kNone:
      return "";
    case WorstJoint::kLargest:
      return "largest";
    case WorstJoint::kSmallest:
      return "smallest";
  }
  return "";
}

// what a log tells without a truth, of all joints
std::string joints_of_log(const Row& r) {
  std::vector<std::string> said;
  for (const Metric metric : {Metric::kFloor, Metric::kDrift}) {
    const MetricRow& row = row_of(metric);
    std::vector<std::string> values;
    for (const std::optional<double>& v : r.score.joints(metric))
      values.push_back(v ? fmt::format("{:.{}f}", *v, digits_of(r, row)) : "-");
    if (values.size() > 1)
      said.push_back(fmt::format("{} {} {}", row.title, fmt::join(values, " "), row.unit));
  }
  return said.empty() ? "" : fmt::format("  by joint: {}", fmt::join(said, "; "));
}

}  // namespace

std::string format_table(const std::vector<Row>& rows, TableFormat format,
                         const std::vector<Metric>& also) {
  const std::vector<const MetricRow*> metrics = columns_of(rows, also);
  std::vector<TableWriter::Column> columns = {
      {.title = by_keys(format) ? "entry" : "robot/scenario/estimator", .left = true}};
  for (const MetricRow* m : metrics) columns.push_back(column_of(*m, format));
  // text tells a failure across the columns
  const bool tells = format != TableFormat::kText && std::any_of(rows.begin(), rows.end(), failed);
  if (tells) columns.push_back({.title = "error", .left = true});
  TableWriter table(std::move(columns));
  std::string group;
  for (const Row& r : rows) {
    if (!group.empty() && r.entry.group() != group) table.add_gap();
    group = r.entry.group();
    if (failed(r) && !tells) {
      table.add_note(r.entry.name() + "  FAILED: " + r.score.error);
      continue;
    }
    std::vector<std::string> cells = {r.entry.name()};
    for (const MetricRow* m : metrics) cells.push_back(cell(rows, r, *m));
    if (tells) cells.push_back(r.score.error);
    table.add(std::move(cells));
    const std::string said = r.score.counts.sentence();
    if (format != TableFormat::kText) continue;
    if (!said.empty()) table.add_note("  " + said);
    if (const std::string joints = joints_of_log(r); !joints.empty()) table.add_note(joints);
  }
  return table.format(format);
}

std::string table_legend(const std::vector<Row>& rows, const std::vector<Metric>& also) {
  std::string out =
      "Each row shows its worst joint. * is the best of a group; zero, truth and delayed_truth do "
      "not compete.\n";
  if (std::any_of(rows.begin(), rows.end(),
                  [](const Row& r) { return r.entry.has_robot() && r.entry.robot().slides(); }))
    out += "Where a joint slides, N m is N and rad is m.\n";
  const std::vector<const MetricRow*> columns = columns_of(rows, also);
  for (const MetricRow* m : columns) {
    const auto same = [&](const MetricRow* other) { return other->title == m->title; };
    const bool one = std::count_if(columns.begin(), columns.end(), same) == 1;
    const std::string title = one ? std::string(m->title) : fmt::format("{} {}", m->title, m->unit);
    out += fmt::format("{:<10}  {}\n", title, m->meaning);
  }
  const auto some = [&](auto&& has) { return std::any_of(rows.begin(), rows.end(), has); };
  const auto lacks = [&](bool asked) {
    return some([&](const Row& r) {
      return !failed(r) && std::any_of(columns.begin(), columns.end(), [&](const MetricRow* m) {
        const auto value = r.score.get(m->metric);
        return asked ? value && std::isnan(*value) : !value;
      });
    });
  };
  if (lacks(true)) out += "never       It never came to that.\n";
  if (lacks(false)) out += "-           This run has no such value.\n";
  if (some([](const Row& r) { return r.score.counts.left_out() > 0; }))
    out +=
        "left out    Samples without an estimate, by reason and by the joint that was to blame; "
        "before the first of them, and after a gap, an estimator starts again.\n";
  return out;
}

std::string percent(double part, double of) {
  return of == 0 ? "-" : fmt::format("{:.1f}", 100 * part / of);
}

std::string milliseconds(double s, int digits) {
  return std::isnan(s) ? "-" : fmt::format("{:.{}f}", 1e3 * s, digits);
}

std::string list_of_metrics(TableFormat format) {
  TableWriter table({{.title = "key", .left = true},
                     {.title = "column", .left = true},
                     {.title = "unit", .left = true},
                     {.title = "better", .left = true},
                     {.title = "worst joint", .left = true},
                     {.title = "gated", .left = true},
                     {.title = "what it says", .left = true}});
  for (const MetricRow& m : kMetrics) {
    table.add({fmt::format("`{}`", m.key), std::string(m.is(MetricRow::kTable) ? m.title : ""),
               std::string(m.unit), text_of(m.better), text_of(m.joints),
               m.is(MetricRow::kGate) ? "yes" : "no", std::string(m.meaning)});
  }
  return table.format(format);
}

}  // namespace tauext

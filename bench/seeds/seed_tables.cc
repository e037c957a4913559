// SPDX-License-Identifier: Apache-2.0
#include "bench/seeds/seed_tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "bench/seeds/seed_figures.h"

namespace tauext {
namespace {

bool is_shown(const MetricRow& m, const std::vector<SeededRow>& rows) {
  if (m.metric == Metric::kCpu || m.metric == Metric::kAllocs) return false;
  if (!m.is(MetricRow::kTable) && m.metric != Metric::kRecall) return false;
  return std::any_of(rows.begin(), rows.end(), [&](const SeededRow& r) {
    const SeedFigure f = figure_of(r, m.metric);
    return f.values + f.never > 0;
  });
}

// two digits of the interval's half width, and no fewer than the metric has
std::string text_of(const SeedFigure& f, const MetricRow& m, bool signed_value) {
  if (f.values + f.never == 0) return "-";
  if (f.never > 0)
    return f.values == 0 ? "never" : fmt::format("never {}/{}", f.never, f.never + f.values);
  const bool lopsided = m.metric == Metric::kFalseAlarms || m.metric == Metric::kRecall;
  if (lopsided && !signed_value)
    return fmt::format("{:.2f}[{:.2f},{:.2f}]", f.mean, f.interval.low, f.interval.high);
  const double half = (f.interval.high - f.interval.low) / 2;
  int digits = m.digits;
  if (half > 0 && std::isfinite(half))
    digits = std::max(digits, std::min(1 - static_cast<int>(std::floor(std::log10(half))), 6));
  const std::string mean = signed_value ? fmt::format("{:+.{}f}", f.mean, digits)
                                        : fmt::format("{:.{}f}", f.mean, digits);
  return std::isfinite(half) ? fmt::format("{}+-{:.{}f}", mean, half, digits) : mean;
}

bool differs(const SeedFigure& f) {
  return f.never == 0 && f.values > 1 && (f.interval.low > 0 || f.interval.high < 0);
}

// the row of the group's `against`; nullptr: there is none, or it is that row
const SeededRow* rival_of(const SeededRow& row, const std::vector<SeededRow>& rows,
                          const std::string& against) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const SeededRow& r) {
    const bool pair = r.entry.estimator() + "+" + r.entry.detector() == against;
    return r.entry.group() == row.entry.group() &&
           (pair || (r.entry.estimator() == against && r.entry.detector() == row.entry.detector()));
  });
  return found == rows.end() || &*found == &row ? nullptr : &*found;
}

// apart by blanks
std::string by_seed(const SeededRow& row, Metric metric) {
  std::vector<std::string> values;
  for (const Score& s : row.scores) {
    const std::optional<double> x = s.get(metric);
    values.push_back(!s.error.empty() || !x ? "failed"
                     : std::isfinite(*x)    ? fmt::format("{:.6g}", *x)
                                            : "never");
  }
  return fmt::format("{}", fmt::join(values, " "));
}

std::string for_programs(const std::vector<SeededRow>& rows, const std::string& against,
                         TableFormat format) {
  std::vector<TableWriter::Column> columns;
  for (const char* title :
       {"entry", "metric", "unit", "values", "never", "failed", "mean", "low", "high", "against",
        "difference", "difference_low", "difference_high", "by_seed"})
    columns.push_back({title});
  TableWriter table(std::move(columns));
  const auto number = [](double x) {
    return std::isfinite(x) ? fmt::format("{:.9g}", x) : std::string();
  };
  for (const SeededRow& r : rows) {
    const auto failed = std::count_if(r.scores.begin(), r.scores.end(),
                                      [](const Score& s) { return !s.error.empty(); });
    const SeededRow* const rival = rival_of(r, rows, against);
    for (const MetricRow& m : kMetrics) {
      const SeedFigure f = figure_of(r, m.metric);
      if (!is_shown(m, {r})) continue;
      std::vector<std::string> cells = {r.entry.name(),
                                        std::string(m.key),
                                        std::string(m.unit),
                                        fmt::format("{}", f.values),
                                        fmt::format("{}", f.never),
                                        fmt::format("{}", failed)};
      for (const double x : {f.mean, f.interval.low, f.interval.high})
        cells.push_back(f.values > 0 && f.never == 0 ? number(x) : "");
      const SeedFigure d = rival == nullptr ? SeedFigure() : difference_of(r, *rival, m.metric);
      const bool known = d.values > 0 && d.never == 0;
      cells.push_back(known ? rival->entry.name() : "");
      for (const double x : {d.mean, d.interval.low, d.interval.high})
        cells.push_back(known ? number(x) : "");
      cells.push_back(by_seed(r, m.metric));
      table.add(std::move(cells));
    }
  }
  return table.format(format);
}

// means, or differences if `against` is a name
std::string for_people(const std::vector<SeededRow>& rows, const std::string* against,
                       TableFormat format) {
  std::vector<const MetricRow*> metrics;
  for (const MetricRow& m : kMetrics) {
    if (is_shown(m, rows)) metrics.push_back(&m);
  }
  std::vector<TableWriter::Column> columns = {
      {.title = against == nullptr ? "robot/scenario/estimator" : "minus " + *against,
       .left = true}};
  for (const MetricRow* m : metrics)
    columns.push_back({std::string(m->title), std::string(m->unit)});
  TableWriter table(std::move(columns));
  std::string group;
  for (const SeededRow& r : rows) {
    const SeededRow* const rival = against == nullptr ? nullptr : rival_of(r, rows, *against);
    if (against != nullptr && rival == nullptr) continue;
    if (!group.empty() && r.entry.group() != group) table.add_gap();
    group = r.entry.group();
    std::vector<std::string> cells = {r.entry.name()};
    for (const MetricRow* m : metrics) {
      const SeedFigure f =
          rival == nullptr ? figure_of(r, m->metric) : difference_of(r, *rival, m->metric);
      cells.push_back(text_of(f, *m, rival != nullptr) +
                      (rival != nullptr && differs(f) ? std::string(1, TableWriter::kMark) : ""));
    }
    table.add(std::move(cells));
    for (const Score& s : r.scores) {
      if (s.error.empty()) continue;
      table.add_note("  FAILED at a seed, which does not count: " + s.error);
      break;
    }
  }
  return table.empty() ? "" : table.format(format);
}

}  // namespace

std::string format_seeds(const std::vector<SeededRow>& rows, const std::string& against,
                         TableFormat format) {
  if (format == TableFormat::kCsv || format == TableFormat::kJson)
    return for_programs(rows, against, format);
  std::string out = for_people(rows, nullptr, format);
  const std::string differences = for_people(rows, &against, format);
  if (!differences.empty()) out += "\n" + differences;
  if (format != TableFormat::kText) return out;
  out += R"(
Means over the seeds +- half of their 95 % interval (Student's t), or with its ends: of recall
Wilson's over all collisions, of false alarms Garwood's. never k/n: at k of n seeds.
)";
  const auto of_one = [](const SeededRow& r) { return r.scores.size() < 2; };
  if (std::all_of(rows.begin(), rows.end(), of_one))
    out += "A mean of one seed has no interval; of several it has.\n";
  if (!differences.empty())
    out += "Below them differences at the same seed; * where the interval of one is beside 0.\n";
  for (const MetricRow& m : kMetrics) {
    if (is_shown(m, rows)) out += fmt::format("{:<10}  {}\n", m.title, m.meaning);
  }
  return out;
}

}  // namespace tauext

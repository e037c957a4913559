// SPDX-License-Identifier: Apache-2.0
#include "bench/seeds/seed_tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

namespace tauext {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// [1] of Student's t with n degrees of freedom, what lies within +-sqrt(n) tan(angle): Abramowitz
// and Stegun, 26.7.3 and 4
double inside(double angle, int n) {
  const double c = std::cos(angle), s = std::sin(angle);
  double sum = 0, term = n % 2 == 0 ? 1 : c;
  for (int k = n % 2 == 0 ? 2 : 3; k <= n; k += 2) {
    sum += term;
    term *= c * c * (k - 1) / k;
  }
  return n % 2 == 0 ? s * sum : (angle + s * sum) * 2 / std::numbers::pi;
}

// values of those that have one, and how often there was none
std::vector<double> values_of(const std::vector<Score>& scores, Metric m, int& never) {
  std::vector<double> values;
  for (const Score& s : scores) {
    const auto value = s.get(m);
    if (!value || !s.error.empty()) continue;
    if (std::isnan(*value))
      ++never;
    else
      values.push_back(*value);
  }
  return values;
}

}  // namespace

double student_t(int degrees) {
  double low = 0, high = std::numbers::pi / 2;  // of atan(t / sqrt(n))
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (inside(middle, degrees) < 0.95 ? low : high) = middle;
  }
  return std::sqrt(degrees) * std::tan(low);
}

SeedFigure figure_of(const std::vector<double>& values) {
  SeedFigure f;
  f.values = static_cast<int>(values.size());
  if (values.empty()) return f;
  const auto n = static_cast<double>(values.size());
  for (const double v : values) f.mean += v / n;
  double squares = 0;
  for (const double v : values) squares += (v - f.mean) * (v - f.mean);
  const double half =
      f.values < 2 ? kInfinity : student_t(f.values - 1) * std::sqrt(squares / (n - 1) / n);
  f.interval = {f.mean - half, f.mean + half};
  return f;
}

SeedFigure figure_of(const SeededRow& row, Metric metric) {
  int never = 0;
  SeedFigure f = figure_of(values_of(row.scores, metric, never));
  f.never = never;
  double count = 0;  // of what the metric counts, over all seeds
  int collisions = 0;
  for (const Score& s : row.scores) {
    if (!s.error.empty()) continue;
    collisions += s.collisions;
    count += s.get(metric).value_or(0) * (metric == Metric::kRecall ? s.collisions : 1);
  }
  const int whole = static_cast<int>(std::lround(count));
  if (metric == Metric::kRecall && collisions > 0) {
    f.mean = count / collisions;
    f.interval = metrics::share_interval(whole, collisions);
  }
  if (metric == Metric::kFalseAlarms && f.values > 0) {
    const metrics::Interval all = metrics::count_interval(whole);
    f.interval = {all.low / f.values, all.high / f.values};
  }
  return f;
}

SeedFigure difference_of(const SeededRow& row, const SeededRow& against, Metric metric) {
  std::vector<double> differences;
  int never = 0;
  for (std::size_t i = 0; i < std::min(row.scores.size(), against.scores.size()); ++i) {
    const auto a = row.scores[i].get(metric), b = against.scores[i].get(metric);
    if (!a || !b || !row.scores[i].error.empty() || !against.scores[i].error.empty()) continue;
    if (std::isfinite(*a - *b))
      differences.push_back(*a - *b);
    else
      ++never;
  }
  SeedFigure f = figure_of(differences);
  f.never = never;
  return f;
}

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

// SPDX-License-Identifier: Apache-2.0
#include "bench/study/detection/study_counts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "bench/score/detection_metrics.h"
#include "bench/study/study_runs.h"

namespace tauext::study {
namespace {

using Mark = Answers::Mark;

bool belongs_to(double mark, const Touch& touch) {
  return mark >= touch.begin && mark <= touch.end() + metrics::kGrace;
}

double rounded(double x) {
  return std::round(x * 1e5) / 1e5;
}

int count_detected(const std::vector<double>& marks, const std::vector<Touch>& touches) {
  return static_cast<int>(std::count_if(touches.begin(), touches.end(), [&](const Touch& touch) {
    return std::any_of(marks.begin(), marks.end(), [&](double m) { return belongs_to(m, touch); });
  }));
}

void count_blows(const Answers& answers, const std::vector<Touch>& touches, Cell& cell) {
  const std::vector<Mark>& marks = answers.marks;
  int belonging = 0;
  for (const Touch& touch : touches) {
    const auto mine = [&](const Mark& m) { return belongs_to(m.t, touch); };
    const auto first = std::find_if(marks.begin(), marks.end(), mine);
    belonging += static_cast<int>(std::count_if(marks.begin(), marks.end(), mine));
    if (first != marks.end()) cell.delays.push_back(rounded(first->t - touch.begin));
  }
  cell.blows += static_cast<int>(touches.size());
  cell.detected = static_cast<int>(cell.delays.size());
  cell.stray += static_cast<int>(marks.size()) - belonging;
  for (std::size_t i = 0; i < kLevels.size(); ++i)
    cell.detected_at[i] += count_detected(answers.rises[i], touches);
}

void count_alarms(const Answers& answers, Cell& cell) {
  for (const Mark& m : answers.marks) {
    ++cell.alarms;
    cell.collision_alarms += m.contact == Contact::kCollision;
  }
  cell.quiet_samples += answers.samples;
  cell.alarmed_samples += answers.alarmed;
  for (std::size_t i = 0; i < kLevels.size(); ++i)
    cell.alarms_at[i] += static_cast<int>(answers.rises[i].size());
}

void count_brisk(const Answers& answers, const std::vector<Touch>& touches, Cell& cell) {
  const std::vector<Mark>& marks = answers.marks;
  for (const Touch& touch : touches) {
    ++cell.brisk;
    cell.brisk_flagged += std::any_of(marks.begin(), marks.end(),
                                      [&](const Mark& m) { return belongs_to(m.t, touch); });
  }
}

void count_clampings(const Answers& answers, const std::vector<Touch>& touches, Cell& cell) {
  const std::vector<Mark>& marks = answers.marks;
  for (const Touch& touch : touches) {
    // caught in time: before it lets go
    const auto within = [&](const Mark& m) {
      return m.t >= touch.begin && m.t < touch.end() - touch.fall;
    };
    ++cell.clampings;
    cell.clampings_flagged += std::any_of(marks.begin(), marks.end(), within);
    cell.clampings_named += std::any_of(marks.begin(), marks.end(), [&](const Mark& m) {
      return within(m) && m.contact == Contact::kClamping;
    });
  }
}

}  // namespace

void count(TouchKind kind, const Answers& answers, const std::vector<Touch>& touches, Cell& cell) {
  switch (kind) {
    case TouchKind::kBlow:
      return count_blows(answers, touches, cell);
    case TouchKind::kSlowPush:
      return count_alarms(answers, cell);
    case TouchKind::kBriskPush:
      return count_brisk(answers, touches, cell);
    case TouchKind::kClamp:
      return count_clampings(answers, touches, cell);
  }
}

std::optional<std::size_t> Cell::level_with(double alarms_per_hour) const {
  std::optional<std::size_t> lowest;
  if (quiet_samples == 0) return lowest;
  for (std::size_t l = kLevels.size(); l-- > 0;) {
    if (alarms_at[l] > alarms_per_hour * hours()) break;
    lowest = l;
  }
  return lowest;
}

double RegionCount::exceeded() const {
  const auto over =
      std::count_if(until_found.begin(), until_found.end(), [](double share) { return share > 1; });
  return touches == 0 ? 0 : static_cast<double>(over) / touches;
}

void count_regions(const RegionClass& of, const Answers& answers,
                   const std::vector<RegionTouch>& touches, const std::vector<double>& force,
                   const std::vector<double>& moved, RegionCount& to) {
  const auto sample = [&](double t) {
    return std::min(static_cast<std::size_t>(std::lround(std::max(t, 0.) * 1e3)), force.size());
  };
  for (std::size_t i = 0; i < touches.size(); ++i) {
    const double begin = touches[i].begin;
    const std::size_t from = sample(begin);
    const std::size_t next = i + 1 < touches.size() ? sample(touches[i + 1].begin) : force.size();
    std::size_t end = next;  // of the contact
    while (end > from && force[end - 1] == 0) --end;
    const double last = static_cast<double>(end) * 1e-3 + metrics::kGrace;
    const auto largest = [&](std::size_t until) {
      double most = 0;
      for (std::size_t k = from; k < until; ++k) most = std::max(most, force[k]);
      return rounded(most / of.limit());
    };
    const auto within = [&](double t) { return t >= begin && t <= last; };
    const auto mark = std::find_if(answers.marks.begin(), answers.marks.end(),
                                   [&](const Mark& m) { return within(m.t); });
    for (std::size_t l = 0; l < kLevels.size(); ++l)
      to.found_at[l] += std::any_of(answers.rises[l].begin(), answers.rises[l].end(), within);
    ++to.touches;
    to.peaks.push_back(largest(end));
    const bool found = mark != answers.marks.end();
    to.until_found.push_back(found ? largest(std::min(sample(mark->t) + 1, end)) : largest(end));
    if (!found) continue;
    ++to.found;
    to.delays.push_back(rounded(mark->t - begin));
    if (!moved.empty())
      to.moved.push_back(rounded(moved[std::min(sample(mark->t), moved.size() - 1)]));
  }
}

void add(const Cell& run, Cell& sum) {
  sum.regions.resize(std::max(sum.regions.size(), run.regions.size()));
  for (std::size_t i = 0; i < run.regions.size(); ++i) {
    const RegionCount& r = run.regions[i];
    RegionCount& s = sum.regions[i];
    s.touches += r.touches;
    s.found += r.found;
    for (std::size_t l = 0; l < kLevels.size(); ++l) s.found_at[l] += r.found_at[l];
    s.delays.insert(s.delays.end(), r.delays.begin(), r.delays.end());
    s.moved.insert(s.moved.end(), r.moved.begin(), r.moved.end());
    s.peaks.insert(s.peaks.end(), r.peaks.begin(), r.peaks.end());
    s.until_found.insert(s.until_found.end(), r.until_found.begin(), r.until_found.end());
  }
  for (const auto& [name, count] : kCellCounts) sum.*count += run.*count;
  sum.delays.insert(sum.delays.end(), run.delays.begin(), run.delays.end());
  sum.quiet_samples += run.quiet_samples;
  sum.alarmed_samples += run.alarmed_samples;
  for (std::size_t i = 0; i < kLevels.size(); ++i) {
    sum.detected_at[i] += run.detected_at[i];
    sum.alarms_at[i] += run.alarms_at[i];
  }
}

void sort_values(Cell& sum) {
  std::sort(sum.delays.begin(), sum.delays.end());
  for (RegionCount& r : sum.regions) {
    for (auto* values : {&r.delays, &r.moved, &r.peaks, &r.until_found})
      std::sort(values->begin(), values->end());
  }
}

}  // namespace tauext::study

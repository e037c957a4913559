// SPDX-License-Identifier: Apache-2.0
#include "bench/study/study_counts.h"

#include <algorithm>

#include "bench/score/detection_metrics.h"
#include "bench/study/study_runs.h"

namespace tauext::study {
namespace {

constexpr double kRefractory = 0.2;  // [s] between two crossings of a level

// times [s] at which the score rises through each level
std::array<std::vector<double>, kLevels.size()> crossings(const Trace& t,
                                                          const std::vector<Detection>& d) {
  std::array<std::vector<double>, kLevels.size()> at;
  std::size_t below = kLevels.size();  // the first level above the score; nothing rises at first
  for (std::size_t k = 0; k < d.size(); ++k) {
    std::size_t now = 0;
    while (now < kLevels.size() && d[k].score >= kLevels[now]) ++now;
    for (; below < now; ++below) {
      const bool late = at[below].empty() || t.t[k] - at[below].back() >= kRefractory;
      if (late && t.t[k] >= kScoreFrom) at[below].push_back(t.t[k]);
    }
    below = now;
  }
  return at;
}

bool belongs_to(double mark, const Touch& touch) {
  return mark >= touch.begin && mark <= touch.end() + metrics::kGrace;
}

int count_detected(const std::vector<double>& marks, const std::vector<Touch>& touches) {
  return static_cast<int>(std::count_if(touches.begin(), touches.end(), [&](const Touch& touch) {
    return std::any_of(marks.begin(), marks.end(), [&](double m) { return belongs_to(m, touch); });
  }));
}

struct Mark {
  double t;
  Contact contact;
};

std::vector<Mark> marks_of(const Trace& t, const std::vector<Detection>& d) {
  std::vector<Mark> marks;
  for (std::size_t k = 0; k < d.size(); ++k) {
    if (d[k].mark && t.t[k] >= kScoreFrom) marks.push_back({t.t[k], d[k].contact});
  }
  return marks;
}

void count_blows(const Trace& t, const std::vector<Detection>& d, const std::vector<Touch>& touches,
                 Cell& cell) {
  const std::vector<Mark> marks = marks_of(t, d);
  int belonging = 0;
  for (const Touch& touch : touches) {
    const auto mine = [&](const Mark& m) { return belongs_to(m.t, touch); };
    const auto first = std::find_if(marks.begin(), marks.end(), mine);
    belonging += static_cast<int>(std::count_if(marks.begin(), marks.end(), mine));
    if (first != marks.end()) cell.delays.push_back(first->t - touch.begin);
  }
  cell.blows += static_cast<int>(touches.size());
  cell.detected = static_cast<int>(cell.delays.size());
  cell.stray += static_cast<int>(marks.size()) - belonging;
  const auto at = crossings(t, d);
  for (std::size_t i = 0; i < at.size(); ++i) cell.detected_at[i] += count_detected(at[i], touches);
}

void count_alarms(const Trace& t, const std::vector<Detection>& d, Cell& cell) {
  for (const Mark& m : marks_of(t, d)) {
    ++cell.alarms;
    cell.collision_alarms += m.contact == Contact::kCollision;
  }
  for (std::size_t k = 0; k < d.size(); ++k) {
    if (t.t[k] < kScoreFrom) continue;
    ++cell.quiet_samples;
    cell.alarmed_samples += d[k].score >= 1;
  }
  const auto at = crossings(t, d);
  for (std::size_t i = 0; i < at.size(); ++i) cell.alarms_at[i] += static_cast<int>(at[i].size());
}

void count_brisk(const Trace& t, const std::vector<Detection>& d, const std::vector<Touch>& touches,
                 Cell& cell) {
  const std::vector<Mark> marks = marks_of(t, d);
  for (const Touch& touch : touches) {
    ++cell.brisk;
    cell.brisk_flagged += std::any_of(marks.begin(), marks.end(),
                                      [&](const Mark& m) { return belongs_to(m.t, touch); });
  }
}

void count_clampings(const Trace& t, const std::vector<Detection>& d,
                     const std::vector<Touch>& touches, Cell& cell) {
  const std::vector<Mark> marks = marks_of(t, d);
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

void count(TouchKind kind, const Trace& t, const std::vector<Detection>& d,
           const std::vector<Touch>& touches, Cell& cell) {
  switch (kind) {
    case TouchKind::kBlow:
      return count_blows(t, d, touches, cell);
    case TouchKind::kSlowPush:
      return count_alarms(t, d, cell);
    case TouchKind::kBriskPush:
      return count_brisk(t, d, touches, cell);
    case TouchKind::kClamp:
      return count_clampings(t, d, touches, cell);
  }
}

void add(const Cell& run, Cell& sum) {
  sum.runs += run.runs;
  sum.failed_runs += run.failed_runs;
  sum.blows += run.blows;
  sum.detected += run.detected;
  sum.stray += run.stray;
  sum.delays.insert(sum.delays.end(), run.delays.begin(), run.delays.end());
  sum.quiet_samples += run.quiet_samples;
  sum.alarmed_samples += run.alarmed_samples;
  sum.alarms += run.alarms;
  sum.collision_alarms += run.collision_alarms;
  sum.brisk += run.brisk;
  sum.brisk_flagged += run.brisk_flagged;
  sum.clampings += run.clampings;
  sum.clampings_flagged += run.clampings_flagged;
  sum.clampings_named += run.clampings_named;
  for (std::size_t i = 0; i < kLevels.size(); ++i) {
    sum.detected_at[i] += run.detected_at[i];
    sum.alarms_at[i] += run.alarms_at[i];
  }
}

}  // namespace tauext::study
